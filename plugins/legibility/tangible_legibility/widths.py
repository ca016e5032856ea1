"""Widths of parts in metres: the largest disc in each piece, and the places that are too narrow for a finger."""

from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int, Int32, UInt8

from tangible_core.drawing import nearest
from tangible_core.runtime import cv2, plain_opencv

ROUND_OFF = 1e-6  # relative
# Distance, and at least a cell, by which discs reach further, so that stairs of pixels do not count as places.
SLACK_M = 0.2e-3


class Widths(NamedTuple):
    """The widths of a map of parts."""

    pieces: Int32[np.ndarray, "h w"]  # connected piece of each cell
    part: Int[np.ndarray, "n"]  # of each piece
    size: Int[np.ndarray, "n"]  # cells of each piece
    disc_m: Float64[np.ndarray, "n"]  # diameter of the largest disc within each piece
    narrow: Bool[np.ndarray, "h w"]  # cells of places that are too narrow
    places: "tuple[Place, ...]"  # that are too narrow
    depth: Float32[np.ndarray, "r c"]  # half cells to the nearest border


class Place(NamedTuple):
    """A place that is too narrow."""

    piece: int
    width_m: float  # the largest in the place
    size: int  # cells
    at: tuple[int, int]  # row and column of a cell where it is widest


class Rims(NamedTuple):
    """The sides of a map that are a rim, and so a border; a map cut out of a larger one continues on other sides."""

    top: bool = True
    bottom: bool = True
    left: bool = True
    right: bool = True

    def open_sides(self) -> list[Any]:
        """Return the sides on which the map continues, as indices."""
        sides = (np.s_[0], np.s_[-1], np.s_[:, 0], np.s_[:, -1])
        return [side for side, rim in zip(sides, self, strict=True) if not rim]


WHOLE = Rims()


def measure(
    labels: Int32[np.ndarray, "h w"], pitch_m: float, gap_m: float, rims: Rims = WHOLE, *, quick: bool = False
) -> Widths:
    """Measure the widths of the parts, and find the places that are narrower than gap_m. quick: to 2 %."""
    sides = _Sides.of(labels)
    pieces = sides.components(np.ones(labels.shape, np.bool_)) - 1
    count = int(pieces.max()) + 1
    part = np.zeros(count, np.int64)
    part[pieces.reshape(-1)] = labels.reshape(-1)
    depth = sides.depth(rims, cv2.DIST_MASK_5 if quick else cv2.DIST_MASK_PRECISE)
    disc_m = pitch_m * _deepest(depth, pieces, count).astype(np.float64)
    # Places within an eighth of gap_m of a disc, and tips of corners, which are short, do not count.
    left = ~_covered_by_discs(sides, pieces, depth, gap_m / 2 / pitch_m, pitch_m)
    narrow, places = _places(sides, pieces, left, depth, disc_m, pitch_m, gap_m, rims)
    size = np.bincount(pieces.reshape(-1), minlength=count)
    return Widths(pieces, part, size, disc_m, narrow, places, depth)


def connected_pieces(labels: Int32[np.ndarray, "h w"]) -> Int32[np.ndarray, "h w"]:
    """Return the connected piece of each cell, from 0 on."""
    return _Sides.of(labels).components(np.ones(labels.shape, np.bool_)) - 1


def surroundings(wide: Widths, pitch_m: float, gap_m: float) -> Bool[np.ndarray, "h w"]:
    """Find the narrow places and the cells connected with them that no disc of a larger gap reaches."""
    sides = _Sides.of(wide.pieces)
    left = ~_covered_by_discs(sides, wide.pieces, wide.depth, gap_m / 2 / pitch_m, pitch_m)
    components = sides.components(left | wide.narrow)
    narrow = np.zeros(int(components.max()) + 1, np.bool_)
    narrow[components[wide.narrow]] = True
    narrow[0] = False
    return narrow[components]


class _Sides(NamedTuple):
    """Masks of the sides of cells that are not a border."""

    # On half pixels, so that a strip of n pixels is n pixels wide, for even and odd n; the rim is a border too.

    upright: Bool[np.ndarray, "h w1"]  # between a cell and its right neighbour
    level: Bool[np.ndarray, "h1 w"]  # between a cell and its lower neighbour

    @classmethod
    def of(cls, labels: Int32[np.ndarray, "h w"]) -> "_Sides":
        return cls(labels[:, 1:] == labels[:, :-1], labels[1:] == labels[:-1])

    def _draw(
        self, cells: Bool[np.ndarray, "h w"], upright: Bool[np.ndarray, "h w1"], level: Bool[np.ndarray, "h1 w"]
    ) -> UInt8[np.ndarray, "r c"]:
        """Draw cells and sides on the grid of half cells, on which cell (r, c) is at (2 r + 1, 2 c + 1)."""
        rows, columns = cells.shape
        halves = np.zeros((2 * rows + 1, 2 * columns + 1), np.uint8)
        halves[1::2, 1::2] = cells
        halves[1::2, 2:-1:2] = upright
        halves[2:-1:2, 1::2] = level
        return halves

    def depth(self, rims: Rims, mask: int) -> Float32[np.ndarray, "r c"]:
        """Return half cells to the nearest border, at each point of the grid of half cells; 0 on a border."""
        inside = self._draw(np.ones((len(self.upright), self.level.shape[1]), np.bool_), self.upright, self.level)
        inside[2:-1:2, 2:-1:2] = 1
        inside[0, :], inside[-1, :] = not rims.top, not rims.bottom
        inside[:, 0] &= not rims.left
        inside[:, -1] &= not rims.right
        if not rims.left:
            inside[1:-1, 0] = 1
        if not rims.right:
            inside[1:-1, -1] = 1
        if not (inside == 0).any():
            return np.full(inside.shape, np.float32(np.inf))
        with plain_opencv():
            return np.asarray(cv2.distanceTransform(inside, cv2.DIST_L2, mask), np.float32)

    def dilate(self, cells: Bool[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
        """Add the neighbours of cells, but none across a border."""
        grown = cells.copy()
        grown[:, 1:] |= cells[:, :-1] & self.upright
        grown[:, :-1] |= cells[:, 1:] & self.upright
        grown[1:] |= cells[:-1] & self.level
        grown[:-1] |= cells[1:] & self.level
        return grown

    def components(self, cells: Bool[np.ndarray, "h w"]) -> Int32[np.ndarray, "h w"]:
        """Return the connected pieces of these cells, from 1 on; 0 elsewhere. No piece crosses a border."""
        upright, level = cells[:, 1:] & cells[:, :-1] & self.upright, cells[1:] & cells[:-1] & self.level
        _, components = cv2.connectedComponents(self._draw(cells, upright, level), connectivity=4)
        return np.ascontiguousarray(components[1::2, 1::2])


def _deepest(
    depth: Float32[np.ndarray, "r c"], pieces: Int32[np.ndarray, "h w"], count: int
) -> Float32[np.ndarray, "n"]:
    deepest = depth[1::2, 1::2].copy()
    for down, right in ((1, 2), (2, 1), (2, 2)):
        here = depth[down:-1:2, right:-1:2]
        at = deepest[: here.shape[0], : here.shape[1]]
        np.maximum(at, here, out=at)  # at a border points between cells are no deeper than the cells
    most = np.zeros(count, np.float32)
    np.maximum.at(most, pieces.reshape(-1), deepest.reshape(-1))
    return most


def _covered_by_discs(
    sides: _Sides, pieces: Int32[np.ndarray, "h w"], depth: Float32[np.ndarray, "r c"], radius: float, pitch_m: float
) -> Bool[np.ndarray, "h w"]:
    """Find the cells that a disc of this radius, in cells, covers within their piece, but for SLACK_M."""
    deep = depth >= 2 * radius * (1 - ROUND_OFF)
    middles = deep[1::2, 1::2] | deep[1::2, 2::2] | deep[2::2, 1::2] | deep[2::2, 2::2]
    if not middles.any():
        return middles
    far, at = nearest(middles)
    cover = (far <= radius + 1) & (pieces.reshape(-1)[at] == pieces)
    for _ in range(max(0, round(SLACK_M / pitch_m - 1))):
        cover = sides.dilate(cover)
    return cover


def _places(
    sides: _Sides,
    pieces: Int32[np.ndarray, "h w"],
    left: Bool[np.ndarray, "h w"],
    depth: Float32[np.ndarray, "r c"],
    disc_m: Float64[np.ndarray, "n"],
    pitch_m: float,
    gap_m: float,
    rims: Rims,
) -> tuple[Bool[np.ndarray, "h w"], tuple[Place, ...]]:
    if not left.any():
        return left, ()
    labels = sides.components(left)
    count = int(labels.max()) + 1
    on = np.flatnonzero(left)
    at = labels.reshape(-1)[on]
    piece = np.zeros(count, np.int64)
    piece[at] = pieces.reshape(-1)[on]
    ends, middle = _ends(sides, labels, count)
    far = np.hypot(on // pieces.shape[1] - middle[at, 0], on % pieces.shape[1] - middle[at, 1])
    longest_m = np.zeros(count)
    np.maximum.at(longest_m, at, far * pitch_m)
    wrong = (ends > 1) & (longest_m > gap_m / 8) | (ends > 0) & (longest_m > gap_m)
    wrong |= disc_m[piece] < gap_m * (1 - ROUND_OFF)
    wrong[0] = False
    for side in rims.open_sides():
        wrong[labels[side]] = False  # its continuation is outside of the map
    deepest = depth[1::2, 1::2].reshape(-1)[on]
    width_m = _deepest(depth, labels, count).astype(np.float64) * pitch_m
    cell = np.zeros(count, np.int64)
    order = np.argsort(deepest, kind="stable")
    cell[at[order]] = on[order]
    size = np.bincount(at, minlength=count)
    places = tuple(
        Place(int(piece[n]), float(width_m[n]), int(size[n]), divmod(int(cell[n]), pieces.shape[1]))
        for n in np.flatnonzero(wrong).tolist()
    )
    return wrong[labels], places


def _ends(
    sides: _Sides, labels: Int32[np.ndarray, "h w"], count: int
) -> tuple[Int[np.ndarray, "m"], Float64[np.ndarray, "m 2"]]:
    """Count the sides on which each place is connected to the rest of its piece; return their middle as well."""
    adjacent = np.zeros(labels.shape, np.int32)
    right, left, below, above = np.s_[:, 1:], np.s_[:, :-1], np.s_[1:], np.s_[:-1]
    for one, other, same in ((right, left, sides.upright), (below, above, sides.level)):
        for here, there in ((one, other), (other, one)):
            contacts = same & (labels[here] == 0) & (labels[there] > 0)
            adjacent[here][contacts] = labels[there][contacts]
    on = np.flatnonzero(adjacent)
    place = adjacent.reshape(-1)[on]
    _, groups = cv2.connectedComponents((adjacent > 0).view(np.uint8), connectivity=8)
    contacts = np.unique(groups.reshape(-1)[on].astype(np.int64) * count + place) % count
    cells = np.maximum(np.bincount(place, minlength=count), 1)
    rows, columns = np.divmod(on, labels.shape[1])
    middle = np.stack([np.bincount(place, side, count) / cells for side in (rows, columns)], axis=1)
    return np.bincount(contacts, minlength=count), middle
