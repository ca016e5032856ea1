"""How wide parts are, in metres: the disc that each holds, and where it is narrower than a finger can part.

Borders are seen as the middles of the sides of pixels between two parts, on a grid of half pixels: so a strip of n
pixels is n pixels wide, be n even or odd. The rim of the picture is a border too.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int, Int32, UInt8

from ..data import PartMap, SegmentMap
from ..parts import find_parts
from ..runtime.opencv import plain_opencv

ROUND_OFF = 1e-6


class Widths(NamedTuple):
    """What was measured of a map of parts."""

    pieces: Int32[np.ndarray, "h w"]
    """The connected piece of each cell."""
    part: Int[np.ndarray, "n"]
    """The part that each piece is of."""
    size: Int[np.ndarray, "n"]
    """Cells of each piece."""
    disc_m: Float64[np.ndarray, "n"]
    """Diameter of the largest disc within each piece."""
    narrow: Bool[np.ndarray, "h w"]
    """Cells of places that are too narrow."""
    places: "tuple[Place, ...]"
    """These places."""


class Place(NamedTuple):
    """A place that is too narrow."""

    piece: int
    width_m: float
    """Its width, where that is greatest."""
    size: int
    """Its cells."""
    at: tuple[int, int]
    """Row and column of a cell in it: one where it is widest."""


def measure(parts: PartMap, pitch_m: float, gap_m: float) -> Widths:
    """Widths of the parts, of which each place that is narrower than gap_m is one.

    A place is what no disc of that diameter reaches within its piece. Of these, the tip of a corner is let be: it hangs
    together with the rest on one side alone and is no longer than gap_m, as those of corners down to 39 degrees are.
    """
    found = find_parts(SegmentMap(parts.labels))
    pieces, of = found.labels, np.array(found.segments)
    depth = _depth(pieces)
    half_m = pitch_m / 2
    disc_m = 2 * half_m * _most(depth, pieces, of.size).astype(np.float64)
    size = np.bincount(pieces.reshape(-1), minlength=of.size)
    left = _unreached(depth, gap_m / 2 / half_m, pitch_m / half_m)
    places = _places(pieces, left, depth, disc_m, pitch_m, gap_m)
    narrow = np.zeros(pieces.shape, np.bool_)
    if places.kept.any():
        narrow = np.append(False, places.kept)[places.labels]
    return Widths(pieces, of, size, disc_m, narrow, places.said)


def _depth(pieces: Int32[np.ndarray, "h w"]) -> Float32[np.ndarray, "r c"]:
    """Half cells to the nearest border, at each point of the grid of half cells; cell (r, c) is at (2 r + 1, 2 c + 1).

    0 on a border.
    """
    import cv2

    rows, columns = pieces.shape
    inside = np.ones((2 * rows + 1, 2 * columns + 1), np.uint8)
    inside[[0, -1]] = 0
    inside[:, [0, -1]] = 0
    inside[1::2, 2:-1:2] = pieces[:, 1:] == pieces[:, :-1]
    inside[2:-1:2, 1::2] = pieces[1:] == pieces[:-1]
    with plain_opencv():
        return np.asarray(cv2.distanceTransform(inside, cv2.DIST_L2, cv2.DIST_MASK_PRECISE), np.float32)


def _most(depth: Float32[np.ndarray, "r c"], pieces: Int[np.ndarray, "h w"], count: int) -> Float32[np.ndarray, "n"]:
    """The greatest depth in each piece: at its cells, and between two of them."""
    most = np.zeros(count, np.float32)
    for down, right in ((1, 1), (1, 2), (2, 1), (2, 2)):
        here = depth[down:-1:2, right:-1:2]
        np.maximum.at(most, pieces[: here.shape[0], : here.shape[1]].reshape(-1), here.reshape(-1))
    return most


def _unreached(depth: Float32[np.ndarray, "r c"], radius: float, slack: float) -> Float32[np.ndarray, "h w"]:
    """How far each cell is beyond the discs of this radius that lie within pieces; 0 for what they reach. Half cells."""
    import cv2

    outside: UInt8[np.ndarray, "r c"] = (depth < radius * (1 - ROUND_OFF)).view(np.uint8)
    if outside.all():
        return np.full((depth.shape[0] // 2, depth.shape[1] // 2), np.float32(np.inf))
    with plain_opencv():
        far = np.asarray(cv2.distanceTransform(outside, cv2.DIST_L2, cv2.DIST_MASK_5), np.float32)[1::2, 1::2]
    beyond = far - np.float32(radius)
    beyond[beyond <= slack] = 0
    return beyond


class _Found(NamedTuple):
    labels: Int[np.ndarray, "h w"]
    """From 1 on, where a disc does not reach."""
    kept: Bool[np.ndarray, "m"]
    said: tuple[Place, ...]


def _places(
    pieces: Int32[np.ndarray, "h w"],
    left: Float32[np.ndarray, "h w"],
    depth: Float32[np.ndarray, "r c"],
    disc_m: Float64[np.ndarray, "n"],
    pitch_m: float,
    gap_m: float,
) -> _Found:
    from skimage.measure import label

    there = left > 0
    labels = np.asarray(label(np.where(there, pieces + 1, 0), connectivity=1, background=0))
    count = int(labels.max())
    flat = labels.reshape(-1)
    longest = np.zeros(count + 1, np.float32)
    np.maximum.at(longest, flat, left.reshape(-1))
    first = np.zeros(count + 1, np.int64)
    first[flat[::-1]] = np.arange(flat.size)[::-1]
    piece = pieces.reshape(-1)[first]
    kept = (longest * (pitch_m / 2) > gap_m) | (disc_m[piece] < gap_m * (1 - ROUND_OFF)) | _necks(labels, pieces, count)
    widest, cells = _most(depth, labels, count + 1), depth[1::2, 1::2].reshape(-1)
    deepest = np.zeros(count + 1, np.float32)
    np.maximum.at(deepest, flat, cells)
    middle = np.zeros(count + 1, np.int64)
    on = np.flatnonzero((flat > 0) & (cells == deepest[flat]))
    middle[flat[on]] = on
    size = np.bincount(flat, minlength=count + 1)
    rows, columns = np.divmod(middle, pieces.shape[1])
    said = tuple(
        Place(int(piece[n]), float(widest[n]) * pitch_m, int(size[n]), (int(rows[n]), int(columns[n])))
        for n in (np.flatnonzero(kept[1:]) + 1).tolist()
    )
    return _Found(labels, kept[1:], said)


def _necks(labels: Int[np.ndarray, "h w"], pieces: Int32[np.ndarray, "h w"], count: int) -> Bool[np.ndarray, "m"]:
    """Whether each of these places hangs together with the rest of its piece on more than one side."""
    from skimage.measure import label

    beside = np.zeros(labels.shape, labels.dtype)
    for one, other in (
        ((slice(None), slice(1, None)), (slice(None), slice(None, -1))),
        ((slice(1, None), slice(None)), (slice(None, -1), slice(None))),
    ):
        same = pieces[one] == pieces[other]
        for here, there in ((one, other), (other, one)):
            met = same & (labels[here] == 0) & (labels[there] > 0)
            beside[here][met] = labels[there][met]
    sides = np.asarray(label(beside, connectivity=2, background=0))
    met = np.unique(np.stack([sides[beside > 0], beside[beside > 0]]), axis=1)
    return np.bincount(met[1], minlength=count + 1) > 1
