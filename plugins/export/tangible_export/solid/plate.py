"""The plate: the picture as a block, and around it a flat rim with the title in braille and a corner mark."""

from collections.abc import Iterator, Sequence
from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from tangible_core.data import Relief

from ..braille import DOT_DIAMETER_M, LINE_PITCH_M, Cells, dots
from ..braille import height_m as braille_height_m
from .block import Block, block
from .braille_band import braille_band
from .patches import Patch, flat, joined, rectangle, strip, wall
from .triangles import Triangles

LEAST_RIM_M = 0.004
"""What braille and the corner mark need around them."""
ABOVE_BRAILLE_M = 0.005
"""From the picture to its title: so far apart, raised things are felt as two (Round Table, Guidelines for producing
accessible 3D prints)."""
LARGEST_MARK_M, MARK_HEIGHT_M = 0.006, 0.001
FLAT_SHARE = 0.2
"""Of the rim, between the picture and the row of the corner mark."""


@dataclass(frozen=True)
class Layout:
    """Where everything lies on the plate: x from the left, y from the front edge, which is below the picture."""

    picture_m: tuple[float, float]
    """Width and length."""
    rim_m: float
    lines: tuple[Cells, ...] = ()
    """The title, below the picture, from its left edge on."""
    corner_mark: bool = False

    @property
    def below_m(self) -> float:
        """Length of the rim before the picture."""
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
        """Of the dots of the title."""
        first_m = self.below_m - ABOVE_BRAILLE_M - DOT_DIAMETER_M / 2
        left_m = self.rim_m + DOT_DIAMETER_M / 2
        of_lines = [dots(cells, (left_m, number * LINE_PITCH_M)) for number, cells in enumerate(self.lines)]
        down = np.concatenate(of_lines) if of_lines else np.empty((0, 2))
        return np.stack([down[:, 0], first_m - down[:, 1]], axis=1)


def plate(relief: Relief, triangles: Triangles, layout: Layout) -> Patch:
    """The whole upper side. Without a rim, that is the picture alone."""
    raised = block(relief, triangles, (layout.rim_m, layout.below_m))
    if not layout.rim_m:
        return raised.top
    return joined([raised.top, wall(raised.ring_m), *_rim(layout, raised)])


def _rim(layout: Layout, raised: Block) -> Iterator[Patch]:
    """The band of braille, the row of the mark, and what is flat between these and the picture."""
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
    """Flat strips from the foot of the block to four edges, counter-clockwise from the front one."""
    foot = raised.ring_m * (1, 1, 0)
    foot = np.concatenate([foot, foot[:1]])
    ends = (*raised.corners, len(foot) - 1)
    for start, end, edge in zip(ends[:-1], ends[1:], edges, strict=True):
        yield strip(foot[start : end + 1], edge)


def _mark_row(width_m: float, length_m: float, side_m: float) -> Iterator[Patch]:
    """At the back edge: nothing, and in the right corner a triangle whose right angle points to that corner."""
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
