"""What the networks that are here see in one photograph: a figure, borders, and faces with 468 points each."""

import logging
from collections.abc import Collection, Iterator
from functools import lru_cache
from pathlib import Path
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Float64

from tangible_core.data import Figure, to_rgb
from tangible_core.errors import ConfigError
from tangible_core.plugins import note
from tangible_core.runtime import cv2, plain_opencv

from .card import Runtime, Task
from .fitting import Colours, fit_size, resize, restore_size, tensor
from .runtimes import run
from .store import KnownNetwork, networks_here

log: logging.Logger = logging.getLogger(__name__)
MAX_PX = {"figure": 102_400, "borders": 154_401, "faces": 4_000_000}
"""Largest number of pixels that a network sees: those of the pictures that it was trained with; more shows no more of
a figure, and borders of textures."""
SURE = 0.5  # least value of a figure's surest pixel
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


def look(picture: np.ndarray, tasks: Collection[Task] = ("figure", "borders", "faces")) -> Figure:
    """Return the figure, the borders and the faces of a picture, as far as there are networks for these tasks.

    picture: uint8, uint16 or float (h, w), (h, w, 3) or (h, w, 4).
    Raises: ConfigError for a network that cannot run.
    """
    colours = to_rgb(picture)
    borders = look_for_borders(colours, colours.shape[:2]) if "borders" in tasks else None
    figure = look_for_figure(colours) if "figure" in tasks else None
    return Figure(figure, borders, _faces(colours) if "faces" in tasks else None)


def look_for_borders(colours: Colours, shape: tuple[int, int]) -> Float32[np.ndarray, "r c"] | None:
    """Return how surely people would draw a border at each pixel of this size; None without a network."""
    borders = _map(colours, "borders")
    return None if borders is None else restore_map(borders, shape)


def look_for_figure(colours: Colours) -> Float32[np.ndarray, "h w"] | None:
    """Return how surely each pixel belongs to the figure; 0 in a picture without one, None without a network."""
    figure = _map(colours, "figure")
    if figure is None:
        return None
    return restore_map(figure if float(figure.max()) > SURE else np.zeros_like(figure), colours.shape[:2])


def restore_map(values: Float32[np.ndarray, "r c"], shape: tuple[int, int]) -> Float32[np.ndarray, "h w"]:
    """Return a map in another size, in 0..1."""
    return np.clip(resize(values, shape), 0, 1)


def _map(colours: Colours, task: Task) -> Float32[np.ndarray, "r c"] | None:
    networks = networks_here(task)
    if not networks:
        return None
    network = networks[0]
    card = network.card
    fit = fit_size(colours.shape[:2], card.input, MAX_PX[card.task])
    given = tensor(resize(colours, fit.resized), card.input, fit)
    model = network.path, card.runtime or "opencv", card.input.left, card.output.name
    output = _run_once(*model, network.path.stat().st_mtime_ns, given.tobytes(), given.shape)
    values = restore_size(output, fit, fit.resized, card.output.channel)
    if values is None:
        raise ConfigError(f"the network {network.name} returns no map; name another output in its card")
    note(log, f"{card.task}: seen by the network {network.name}")
    if not card.verified:
        note(log, f"the card of {card.title} was never tested with its network", logging.WARNING)
    return values


@lru_cache(maxsize=2)
def _run_once(
    path: Path, runtime: Runtime, left: str, output: str, changed_ns: int, given: bytes, shape: tuple[int, ...]
) -> np.ndarray:
    """Return a network's map: several stages ask for the borders of one picture."""
    return run(path, runtime, {left: np.frombuffer(given, np.float32).reshape(shape)}, [output])[0]


def _faces(colours: Colours) -> Float32[np.ndarray, "n 468 3"] | None:
    here = {network.name: network for network in networks_here("faces")}
    if not {"face-finder", "face-points"} <= here.keys():
        return None

    reduction = max(1.0, (colours.shape[0] * colours.shape[1] / MAX_PX["faces"]) ** 0.5)
    small = resize(colours, (round(colours.shape[0] / reduction), round(colours.shape[1] / reduction)))
    faces = find_faces(small, here["face-finder"], here["face-points"])
    if len(faces):
        note(log, f"{len(faces)} {'face' if len(faces) == 1 else 'faces'} found by the network face-points")
    return (faces * np.float32(colours.shape[1] / small.shape[1])).astype(np.float32)


class Found(NamedTuple):
    """A face as the finder sees it, in pixels of the picture."""

    score: float
    box: Float64[np.ndarray, "4"]  # left, top, right, bottom
    eyes: Float64[np.ndarray, "2 2"]  # column and row of both


def find_faces(
    picture: Colours, finder: KnownNetwork, points: KnownNetwork, min_score: float = SCORE
) -> Float32[np.ndarray, "n 468 3"]:
    """Return the points of each face, the surest first: column, row and nearness, pixels of the picture.

    Sources: Bazarevsky et al., BlazeFace, 2019 (boxes and six points of a face, over anchors of two grids); Kartynnik
    et al., Real-time facial surface geometry from monocular video on mobile GPUs, 2019 (points of a face in a square
    picture, and whether it is one).
    """
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
