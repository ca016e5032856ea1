"""The plate: the picture as a block, and around it a flat rim with the title in braille and a corner mark."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass
from functools import cache
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64, Int64

from tangible_core.data import Relief

from ..braille import DOT_DIAMETER_M, DOT_HEIGHT_M, LINE_PITCH_M, Cells, dots
from ..braille import height_m as braille_height_m
from .closed import Patch, flat, join_patches, rectangle, strip, wall
from .triangles import Triangles

MIN_RIM_M = 0.004
ABOVE_BRAILLE_M = 0.005
"""Distance from the picture to its title: at this distance, raised shapes are felt as two (Round Table, Guidelines for
producing accessible 3D prints)."""
LARGEST_MARK_M, MARK_HEIGHT_M = 0.006, 0.001
FLAT_SHARE = 0.2
SIDES, RINGS = 12, 3  # a dot is within 0.03 mm of a spherical cap. The sides are a multiple of four


@dataclass(frozen=True)
class Layout:
    """The layout of the plate: x from the left, y from the front edge, which is below the picture."""

    picture_m: tuple[float, float]
    rim_m: float
    lines: tuple[Cells, ...] = ()
    corner_mark: bool = False

    @property
    def below_m(self) -> float:
        """Length of the rim in front of the picture."""
        return self.rim_m + (ABOVE_BRAILLE_M + braille_height_m(len(self.lines)) if self.lines else 0.0)

    @property
    def size_m(self) -> tuple[float, float]:
        """Width and length of the plate."""
        width_m, length_m = self.picture_m
        return width_m + 2 * self.rim_m, self.below_m + length_m + self.rim_m

    @property
    def mark_m(self) -> float:
        """Side of the square of the corner mark."""
        return min((1 - FLAT_SHARE) * self.rim_m, LARGEST_MARK_M) if self.corner_mark else 0.0

    def centres_m(self) -> Float64[np.ndarray, "n 2"]:
        """Return the centres of the title's dots."""
        first_m = self.below_m - ABOVE_BRAILLE_M - DOT_DIAMETER_M / 2
        left_m = self.rim_m + DOT_DIAMETER_M / 2
        of_lines = [dots(cells, (left_m, number * LINE_PITCH_M)) for number, cells in enumerate(self.lines)]
        down = np.concatenate(of_lines) if of_lines else np.empty((0, 2))
        return np.stack([down[:, 0], first_m - down[:, 1]], axis=1)


class Block(NamedTuple):
    """The picture's upper side, the ring of its edge from the lower left on, and the indices of the ring's corners."""

    top: Patch
    ring_m: Float64[np.ndarray, "r 3"]
    corners: tuple[int, int, int, int]


def plate(relief: Relief, triangles: Triangles, layout: Layout) -> Patch:
    """Return the whole upper side of the plate; without a rim, the picture alone."""
    raised = block(relief, triangles, (layout.rim_m, layout.below_m))
    if not layout.rim_m:
        return raised.top
    return join_patches([raised.top, wall(raised.ring_m), *_rim(layout, raised)])


def block(relief: Relief, triangles: Triangles, at_m: tuple[float, float]) -> Block:
    """Return the block of a relief, whose lower left corner is to lie at `at_m`."""
    rows, columns = relief.height_m.shape
    column, row = triangles.column, triangles.row
    across_m, down_m = relief.pitch_m
    inner = np.stack([at_m[0] + (column + 0.5) * across_m, at_m[1] + (row + 0.5) * down_m, triangles.height_m], axis=1)
    # Nodes are centres of cells: level triangles go on to the edge, so that heights and size are right.
    ring, corners = _ring(column, row, columns, rows)
    edge = inner[ring]
    for axis, (place, last) in enumerate(((column[ring], columns - 1), (row[ring], rows - 1))):
        edge[place == 0, axis] = at_m[axis]
        edge[place == last, axis] = at_m[axis] + relief.extent_m[axis]
    outer = len(inner) + np.arange(len(ring))
    after, outer_after = np.roll(ring, -1), np.roll(outer, -1)
    sides = [np.stack([after, ring, outer], axis=1), np.stack([after, outer, outer_after], axis=1)]
    top = Patch(np.concatenate([inner, edge]), np.concatenate([triangles.corners.astype(np.int64), *sides]))
    return Block(top, edge, corners)


def _ring(
    column: np.ndarray, row: np.ndarray, columns: int, rows: int
) -> tuple[Int64[np.ndarray, " r"], tuple[int, int, int, int]]:
    """Return the outermost nodes, counter-clockwise from the lower left, and the indices of the corners among them."""
    right, back = columns - 1, rows - 1
    way = np.select(
        [row == 0, column == right, row == back, column == 0],
        [column, right + row, 2 * right + back - column, 2 * (right + back) - row],
        -1,
    )
    outermost = np.flatnonzero(way >= 0)
    ring = outermost[np.argsort(way[outermost], kind="stable")]
    a, b, c, d = np.searchsorted(way[ring], [0, right, right + back, 2 * right + back]).tolist()
    return ring, (a, b, c, d)


def _rim(layout: Layout, raised: Block) -> Iterator[Patch]:
    """Yield the band of braille, the row of the mark, and the flat strips between them and the picture."""
    width_m, length_m = layout.size_m
    front_m, back_m = 0.0, length_m - layout.mark_m
    before = flat([(0.0, 0.0), (width_m, 0.0)])
    if len(centres_m := layout.centres_m()):
        front_m = layout.below_m - ABOVE_BRAILLE_M / 2
        band, before = braille_band((width_m, front_m), centres_m)
        yield band
    behind = flat([(width_m, back_m), (0.0, back_m)])
    if layout.corner_mark:
        yield from _mark_row(width_m, length_m, layout.mark_m)
        behind = flat([(width_m, back_m), (width_m - layout.mark_m, back_m), (0.0, back_m)])
    yield from _around(
        raised, [before, flat([(width_m, front_m), (width_m, back_m)]), behind, flat([(0.0, back_m), (0.0, front_m)])]
    )


def _around(raised: Block, edges: Sequence[Float64[np.ndarray, "_ 3"]]) -> Iterator[Patch]:
    """Yield flat strips from the foot of the block to four edges, counter-clockwise from the front one."""
    foot = raised.ring_m * (1, 1, 0)
    foot = np.concatenate([foot, foot[:1]])
    ends = (*raised.corners, len(foot) - 1)
    for start, end, edge in zip(ends[:-1], ends[1:], edges, strict=True):
        yield strip(foot[start : end + 1], edge)


def _mark_row(width_m: float, length_m: float, side_m: float) -> Iterator[Patch]:
    """Yield the row at the back edge: flat, but for a triangle in the right corner, its right angle at that corner."""
    left_m, front_m, inset_m = width_m - side_m, length_m - side_m, side_m / 6
    yield rectangle(0.0, front_m, left_m, length_m)
    mark = flat(
        [
            (left_m + inset_m, length_m - inset_m),
            (width_m - inset_m, front_m + inset_m),
            (width_m - inset_m, length_m - inset_m),
        ],
        MARK_HEIGHT_M,
    )
    corners = flat([(left_m, front_m), (width_m, front_m), (width_m, length_m), (left_m, length_m)])
    yield Patch(mark, np.array([[0, 1, 2]]))
    yield wall(mark)
    around = [[3, 1, 0], [3, 4, 1], [4, 2, 1], [4, 5, 2], [5, 0, 2], [5, 6, 0], [6, 3, 0]]
    yield Patch(np.concatenate([mark * (1, 1, 0), corners]), np.array(around))


def braille_band(
    size_m: tuple[float, float], centres_m: Float64[np.ndarray, "n 2"]
) -> tuple[Patch, Float64[np.ndarray, "k 3"]]:
    """Return a flat band with a dot at each centre, divided midway between dots; and the points of its back edge."""
    steps_x, steps_y = (_borders(centres_m[:, axis], size_m[axis]) for axis in (0, 1))
    raised = {
        (int(np.searchsorted(steps_x, x)), int(np.searchsorted(steps_y, y))): (float(x), float(y)) for x, y in centres_m
    }
    patches = list[Patch]()
    for i in range(1, len(steps_x)):
        for j in range(1, len(steps_y)):
            box = float(steps_x[i - 1]), float(steps_y[j - 1]), float(steps_x[i]), float(steps_y[j])
            patches.append(_dot(box, raised[i, j]) if (i, j) in raised else rectangle(*box))
    return join_patches(patches), flat([(float(x), size_m[1]) for x in steps_x])


def _borders(places_m: Float64[np.ndarray, " n"], end_m: float) -> Float64[np.ndarray, " k"]:
    centres = np.unique(places_m.round(9))
    return np.concatenate([[0.0], (centres[1:] + centres[:-1]) / 2, [end_m]])


def _dot(box: tuple[float, float, float, float], centre_m: tuple[float, float]) -> Patch:
    left_m, front_m, right_m, back_m = box
    cap = Patch(_cap().points_m + np.array([*centre_m, 0.0]), _cap().triangles)
    foot = np.concatenate([cap.points_m[:SIDES], cap.points_m[:1]])
    corners = flat([(left_m, front_m), (right_m, front_m), (right_m, back_m), (left_m, back_m), (left_m, front_m)])
    quarter = SIDES // 4
    ground = (strip(foot[n * quarter : (n + 1) * quarter + 1], corners[n : n + 2]) for n in range(4))
    return join_patches([cap, *ground])


@cache
def _cap() -> Patch:
    """Return a spherical cap about the origin: rings from the ground up, each from the lower left on, and the top."""
    radius_m = DOT_DIAMETER_M / 2
    ball_m = (radius_m**2 + DOT_HEIGHT_M**2) / (2 * DOT_HEIGHT_M)
    tilt = np.arcsin(radius_m / ball_m) * (1 - np.arange(RINGS) / RINGS)
    turn = np.radians(225) + 2 * np.pi * np.arange(SIDES) / SIDES
    across = ball_m * np.sin(tilt)[:, None]
    rise = ball_m * (np.cos(tilt) - np.cos(tilt[0]))
    rings = np.stack([across * np.cos(turn), across * np.sin(turn), np.repeat(rise[:, None], SIDES, axis=1)], axis=2)
    points = np.concatenate([rings.reshape(-1, 3), [[0.0, 0.0, DOT_HEIGHT_M]]])
    side, after = np.arange(SIDES), np.roll(np.arange(SIDES), -1)
    triangles = [
        np.stack([(RINGS - 1) * SIDES + side, (RINGS - 1) * SIDES + after, np.full(SIDES, len(points) - 1)], 1)
    ]
    for ring in range(RINGS - 1):
        low, high = ring * SIDES, (ring + 1) * SIDES
        triangles.append(np.stack([low + side, low + after, high + after], axis=1))
        triangles.append(np.stack([low + side, high + after, high + side], axis=1))
    return Patch(points, np.concatenate(triangles))
