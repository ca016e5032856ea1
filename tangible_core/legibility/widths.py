"""How wide parts are, in metres: the disc that each holds, and where it is narrower than a finger can part.

Borders are seen as the middles of the sides of pixels between two parts, on a grid of half pixels: so a strip of n
pixels is n pixels wide, be n even or odd. The rim of the picture is a border too.
"""

from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int, Int32, UInt8

from ..runtime.opencv import plain_opencv
from .cells import nearest

ROUND_OFF = 1e-6
SLACK_M = 0.2e-3
"""By so much, and at least a cell, discs reach further than they are: stairs of pixels are no place of their own."""


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
    depth: Float32[np.ndarray, "r c"]
    """Half cells to the nearest border, on the grid of half cells."""


class Place(NamedTuple):
    """A place that is too narrow."""

    piece: int
    width_m: float
    """Its width, where that is greatest."""
    size: int
    """Its cells."""
    at: tuple[int, int]
    """Row and column of a cell in it: one where it is widest."""


class Rims(NamedTuple):
    """Which sides of a map are a rim, which is a border; a map that is cut out of another goes on there."""

    top: bool = True
    bottom: bool = True
    left: bool = True
    right: bool = True

    def open_sides(self) -> list[Any]:
        """Where the map goes on, as an index."""
        sides = (np.s_[0], np.s_[-1], np.s_[:, 0], np.s_[:, -1])
        return [side for side, rim in zip(sides, self, strict=True) if not rim]


WHOLE = Rims()


def measure(
    labels: Int32[np.ndarray, "h w"], pitch_m: float, gap_m: float, rims: Rims = WHOLE, *, quick: bool = False
) -> Widths:
    """Widths of the parts, of which each place that is narrower than gap_m is one.

    A place is what no disc of that diameter reaches within its piece. Of these, two are let be: what is within an
    eighth of gap_m of such a disc, and the tip of a corner, which hangs together with the rest of its piece on one side
    alone and is no longer than gap_m, as those of corners down to 39 degrees are.
    quick: widths are right to 2 %.
    """
    import cv2

    sides = _Sides.of(labels)
    pieces = sides.components(np.ones(labels.shape, np.bool_)) - 1
    count = int(pieces.max()) + 1
    of = np.zeros(count, np.int64)
    of[pieces.reshape(-1)] = labels.reshape(-1)
    depth = sides.depth(rims, cv2.DIST_MASK_5 if quick else cv2.DIST_MASK_PRECISE)
    disc_m = pitch_m * _most(depth, pieces, count).astype(np.float64)
    left = ~_reached(sides, pieces, depth, gap_m / 2 / pitch_m, pitch_m)
    narrow, places = _places(sides, pieces, left, depth, disc_m, pitch_m, gap_m, rims)
    size = np.bincount(pieces.reshape(-1), minlength=count)
    return Widths(pieces, of, size, disc_m, narrow, places, depth)


def connected(labels: Int32[np.ndarray, "h w"]) -> Int32[np.ndarray, "h w"]:
    """The connected piece of each cell, from 0 on."""
    return _Sides.of(labels).components(np.ones(labels.shape, np.bool_)) - 1


def around(wide: Widths, pitch_m: float, gap_m: float) -> Bool[np.ndarray, "h w"]:
    """The narrow places with all that hangs together with them and no disc of a larger gap reaches."""
    sides = _Sides.of(wide.pieces)
    hardly = ~_reached(sides, wide.pieces, wide.depth, gap_m / 2 / pitch_m, pitch_m)
    components = sides.components(hardly | wide.narrow)
    there = np.zeros(int(components.max()) + 1, np.bool_)
    there[components[wide.narrow]] = True
    there[0] = False
    return there[components]


class _Sides(NamedTuple):
    """Which sides of cells are no border."""

    upright: Bool[np.ndarray, "h w1"]
    """Between a cell and the one right of it."""
    level: Bool[np.ndarray, "h1 w"]
    """Between a cell and the one below it."""

    @classmethod
    def of(cls, labels: Int32[np.ndarray, "h w"]) -> "_Sides":
        return cls(labels[:, 1:] == labels[:, :-1], labels[1:] == labels[:-1])

    def _drawn(
        self, cells: Bool[np.ndarray, "h w"], upright: Bool[np.ndarray, "h w1"], level: Bool[np.ndarray, "h1 w"]
    ) -> UInt8[np.ndarray, "r c"]:
        """On the grid of half cells, on which cell (r, c) is at (2 r + 1, 2 c + 1)."""
        rows, columns = cells.shape
        found = np.zeros((2 * rows + 1, 2 * columns + 1), np.uint8)
        found[1::2, 1::2] = cells
        found[1::2, 2:-1:2] = upright
        found[2:-1:2, 1::2] = level
        return found

    def depth(self, rims: Rims, mask: int) -> Float32[np.ndarray, "r c"]:
        """Half cells to the nearest border, at each point of the grid of half cells; 0 on a border."""
        import cv2

        inside = self._drawn(np.ones((len(self.upright), self.level.shape[1]), np.bool_), self.upright, self.level)
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

    def grown(self, cells: Bool[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
        """With the cells beside them, but none over a border."""
        found = cells.copy()
        found[:, 1:] |= cells[:, :-1] & self.upright
        found[:, :-1] |= cells[:, 1:] & self.upright
        found[1:] |= cells[:-1] & self.level
        found[:-1] |= cells[1:] & self.level
        return found

    def components(self, cells: Bool[np.ndarray, "h w"]) -> Int32[np.ndarray, "h w"]:
        """The connected pieces of these cells, from 1 on; 0 elsewhere. No piece crosses a border."""
        import cv2

        upright, level = cells[:, 1:] & cells[:, :-1] & self.upright, cells[1:] & cells[:-1] & self.level
        _, found = cv2.connectedComponents(self._drawn(cells, upright, level), connectivity=4)
        return np.ascontiguousarray(found[1::2, 1::2])


def _most(depth: Float32[np.ndarray, "r c"], pieces: Int32[np.ndarray, "h w"], count: int) -> Float32[np.ndarray, "n"]:
    """The greatest depth in each piece: at its cells, and between two of them."""
    deepest = depth[1::2, 1::2].copy()
    for down, right in ((1, 2), (2, 1), (2, 2)):
        here = depth[down:-1:2, right:-1:2]
        at = deepest[: here.shape[0], : here.shape[1]]
        np.maximum(at, here, out=at)  # beside a border what lies between cells is no deeper than they are
    most = np.zeros(count, np.float32)
    np.maximum.at(most, pieces.reshape(-1), deepest.reshape(-1))
    return most


def _reached(
    sides: _Sides, pieces: Int32[np.ndarray, "h w"], depth: Float32[np.ndarray, "r c"], radius: float, pitch_m: float
) -> Bool[np.ndarray, "h w"]:
    """Cells that a disc of this radius, in cells, reaches within their piece, or all but reaches."""
    deep = depth >= 2 * radius * (1 - ROUND_OFF)
    middles = deep[1::2, 1::2] | deep[1::2, 2::2] | deep[2::2, 1::2] | deep[2::2, 2::2]
    if not middles.any():
        return middles
    far, at = nearest(middles)
    reached = (far <= radius + 1) & (pieces.reshape(-1)[at] == pieces)
    for _ in range(max(0, round(SLACK_M / pitch_m - 1))):
        reached = sides.grown(reached)
    return reached


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
    """Where it is too narrow, and the places of it."""
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
        wrong[labels[side]] = False  # how it goes on there is not seen
    deepest = depth[1::2, 1::2].reshape(-1)[on]
    width_m = _most(depth, labels, count).astype(np.float64) * pitch_m
    cell = np.zeros(count, np.int64)
    order = np.argsort(deepest, kind="stable")
    cell[at[order]] = on[order]
    size = np.bincount(at, minlength=count)
    found = tuple(
        Place(int(piece[n]), float(width_m[n]), int(size[n]), divmod(int(cell[n]), pieces.shape[1]))
        for n in np.flatnonzero(wrong).tolist()
    )
    return wrong[labels], found


def _ends(
    sides: _Sides, labels: Int32[np.ndarray, "h w"], count: int
) -> tuple[Int[np.ndarray, "m"], Float64[np.ndarray, "m 2"]]:
    """On how many sides each of these places hangs together with the rest of its piece; the middle of these sides."""
    import cv2

    beside = np.zeros(labels.shape, np.int32)
    right, left, below, above = np.s_[:, 1:], np.s_[:, :-1], np.s_[1:], np.s_[:-1]
    for one, other, same in ((right, left, sides.upright), (below, above, sides.level)):
        for here, there in ((one, other), (other, one)):
            met = same & (labels[here] == 0) & (labels[there] > 0)
            beside[here][met] = labels[there][met]
    on = np.flatnonzero(beside)
    of = beside.reshape(-1)[on]
    _, groups = cv2.connectedComponents((beside > 0).view(np.uint8), connectivity=8)
    met = np.unique(groups.reshape(-1)[on].astype(np.int64) * count + of) % count
    cells = np.maximum(np.bincount(of, minlength=count), 1)
    rows, columns = np.divmod(on, labels.shape[1])
    middle = np.stack([np.bincount(of, each, count) / cells for each in (rows, columns)], axis=1)
    return np.bincount(met, minlength=count), middle
