"""Faces in a photograph, each by 468 points with their depth.

Sources: Bazarevsky et al., BlazeFace, 2019 (boxes and six points of a face, over anchors of two grids); Kartynnik et
al., Real-time facial surface geometry from monocular video on mobile GPUs, 2019 (points of a face in a square picture,
and whether it is one).
"""

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Float64

from tangible_core.runtime import plain_opencv

from .fitting import Colours
from .runtimes import run
from .store import KnownNetwork

FINDER_PX, POINTS_PX = 128, 192  # sides of the squares that the networks see
GRIDS = ((16, 2), (8, 6))  # of the finder's anchors: side, anchors at each place
SCORE, PRESENCE = 0.77, 0.5
"""Least sureness of the finder, and of the network of points that it sees a face. On 40 photographs of BSDS500, faces
have scores from 0.81 on, and all else up to 0.73."""
LOWEST_SCORE = 0.5  # from which the finder's boxes are looked at, as published
MARGIN = 1.5  # side of the square around a face over that of the finder's box
# Sizes of squares that are looked at: the whole picture, a half and a quarter of it, so that a face may be small.
LEVELS = 3
OVERLAP = 0.5  # share of a square that the next one covers too
SAME = 0.3  # intersection over union of two boxes from which they are of one face


class Found(NamedTuple):
    """A face as the finder sees it, in pixels of the picture."""

    score: float
    box: Float64[np.ndarray, "4"]  # left, top, right, bottom
    eyes: Float64[np.ndarray, "2 2"]  # column and row of both


def find_faces(
    picture: Colours, finder: KnownNetwork, points: KnownNetwork, min_score: float = SCORE
) -> Float32[np.ndarray, "n 468 3"]:
    """Return the points of each face, the surest first: column, row and nearness, pixels of the picture."""
    every = (face for origin, side in _squares(picture.shape[:2]) for face in _look(picture, origin, side, finder))
    boxes = [face for face in every if face.score > min_score]
    meshes: list[Float32[np.ndarray, "468 3"]] = []
    claims: list[Float64[np.ndarray, 4]] = []
    for face in sorted(boxes, key=lambda each: -each.score):
        if any(_overlap(face.box, other) > SAME for other in claims):
            continue
        mesh = _mesh(picture, face, points)
        if mesh is None:
            continue
        claims.append(face.box)
        meshes.append(mesh)
    return np.stack(meshes) if meshes else np.zeros((0, 468, 3), np.float32)


def _squares(shape: tuple[int, ...]) -> Iterator[tuple[tuple[float, float], float]]:
    """Yield squares as (column, row) of their corner and their side: one around the picture, then smaller ones."""
    rows, columns = shape
    whole = float(max(shape))
    yield ((columns - whole) / 2, (rows - whole) / 2), whole
    for level in range(1, LEVELS):
        side = min(whole / 2**level, float(min(shape)))
        if side < FINDER_PX / 2:
            return
        steps = [max(1, int(np.ceil((length - side) / (side * (1 - OVERLAP)))) + 1) for length in (columns, rows)]
        for top in np.linspace(0, max(rows - side, 0), steps[1]):
            for left in np.linspace(0, max(columns - side, 0), steps[0]):
                yield (float(left), float(top)), side


def _look(picture: Colours, origin: tuple[float, float], side: float, finder: KnownNetwork) -> list[Found]:
    scale = side / FINDER_PX
    view = _crop(picture, np.array([[scale, 0, origin[0]], [0, scale, origin[1]]]), FINDER_PX, scale)
    regressors, scores = run(finder.path, "opencv", {"": _tensor(2 * view - 1)}, ["regressors", "classificators"])
    sure = 1 / (1 + np.exp(-np.clip(scores.reshape(-1), -50, 50).astype(np.float64)))
    faces: list[Found] = []
    for index in np.flatnonzero(sure > LOWEST_SCORE):
        values = regressors.reshape(-1, 16)[index].astype(np.float64) / FINDER_PX
        centre, size = values[:2] + ANCHORS[index], values[2:4]
        eyes = values[4:8].reshape(2, 2) + ANCHORS[index]
        box = np.concatenate([centre - size / 2, centre + size / 2]) * side + [*origin, *origin]
        faces.append(Found(float(sure[index]), box, eyes * side + origin))
    return faces


def _mesh(picture: Colours, face: Found, points: KnownNetwork) -> Float32[np.ndarray, "468 3"] | None:
    across = face.eyes[1] - face.eyes[0]
    turn = np.arctan2(across[1], across[0])
    scale = MARGIN * float((face.box[2:] - face.box[:2]).max()) / POINTS_PX
    turning = scale * np.array([[np.cos(turn), -np.sin(turn)], [np.sin(turn), np.cos(turn)]])
    shift = (face.box[:2] + face.box[2:]) / 2 - turning @ [POINTS_PX / 2, POINTS_PX / 2]
    view = _crop(picture, np.column_stack([turning, shift]), POINTS_PX, scale)
    places, presence = run(points.path, "opencv", {"": _tensor(view)}, ["conv2d_20", "conv2d_30"])
    if 1 / (1 + np.exp(-float(presence.reshape(-1)[0]))) <= PRESENCE:
        return None
    own = places.reshape(468, 3).astype(np.float64)
    flat = own[:, :2] @ turning.T + shift
    return np.column_stack([flat, -scale * own[:, 2]]).astype(np.float32)


def _crop(picture: Colours, matrix: np.ndarray, side: int, scale: float) -> Colours:
    """Return a square of the picture, black outside of it. matrix: from the square's pixels to the picture's."""
    import cv2

    corners = matrix @ np.array([[0, side, 0, side], [0, 0, side, side], [1, 1, 1, 1]])
    margin = int(np.ceil(2 * scale)) + 2  # of the blur, which OpenCV cuts off at four standard deviations
    low = np.maximum(np.floor(corners.min(axis=1)).astype(int) - margin, 0)
    high = np.maximum(np.ceil(corners.max(axis=1)).astype(int) + margin, 0)
    picture = picture[low[1] : high[1], low[0] : high[0]]  # the rest of a large picture is not blurred
    if not picture.size:
        return np.zeros((side, side, 3), np.float32)
    matrix = matrix - np.array([[0, 0, low[0]], [0, 0, low[1]]])
    with plain_opencv():
        if scale > 1:  # averaging first: no pixel of a large picture is left out
            picture = cv2.GaussianBlur(picture, (0, 0), scale / 2)
        return cv2.warpAffine(
            picture, matrix, (side, side), flags=cv2.WARP_INVERSE_MAP | cv2.INTER_LINEAR, borderMode=cv2.BORDER_CONSTANT
        )


def _tensor(square: Colours) -> Float32[np.ndarray, "1 3 s s"]:
    return np.ascontiguousarray(square.transpose(2, 0, 1)[None], np.float32)


def _overlap(one: Float64[np.ndarray, "4"], other: Float64[np.ndarray, "4"]) -> float:
    """Return the area that two boxes share, over the area that they cover."""
    sides = np.clip(np.minimum(one[2:], other[2:]) - np.maximum(one[:2], other[:2]), 0, None)
    areas = [float(np.prod(box[2:] - box[:2])) for box in (one, other)]
    intersection = float(np.prod(sides))
    return intersection / max(sum(areas) - intersection, 1e-9)


def _anchors() -> Float64[np.ndarray, "896 2"]:
    """Return the anchors' centres, column and row, in shares of the square."""
    places: list[np.ndarray] = []
    for count, per_place in GRIDS:
        row, column = np.mgrid[:count, :count]
        centres = np.stack([column + 0.5, row + 0.5], -1).reshape(-1, 2) / count
        places.append(np.repeat(centres, per_place, axis=0))
    return np.concatenate(places)


ANCHORS = _anchors()
