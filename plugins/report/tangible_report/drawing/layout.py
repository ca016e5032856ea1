"""Where panels stand on a sheet: rows of one height, each filling the width."""

from collections.abc import Sequence
from itertools import accumulate, pairwise
from math import log
from typing import NamedTuple

ROW_IN = 2.5
"""Height of a row that is neither cramped nor wasteful, inches."""
WIDEST_GAP_IN = 3.0
"""Between panels of a row that is too high to be wider."""
TALLEST_IN = 4.5
"""A panel alone on its sheet grows no taller."""


class Cell(NamedTuple):
    """What a panel asks for: width over height of its axes, and room round them in inches.

    A cell narrower than its text, `least_in`, gets more room on the right. One with a `least_aspect` may be that much
    narrower beside narrow ones, which then are higher.
    """

    aspect: float
    left_in: float
    right_in: float
    bottom_in: float
    top_in: float
    least_in: float = 0.0
    least_aspect: float = 0.0

    @property
    def wanted_in(self) -> float:
        """The height at which it is as large as a square is in a row of ROW_IN: what is narrow is to be higher."""
        return min(ROW_IN / min(self.aspect, 1.0) ** 0.5, TALLEST_IN)

    def at(self, height_in: float, wider_in: float = 0.0) -> "Cell":
        """As it is in a row of this height that leaves so much: as wide as it likes to be, or as there is room for."""
        if not self.least_aspect:
            return self
        return self._replace(aspect=min(self.aspect, self.least_aspect + wider_in / height_in), least_aspect=0.0)


class Box(NamedTuple):
    """Place of a panel's axes: inches from the sheet's left and upper edge, to the axes' left upper corner."""

    left_in: float
    top_in: float
    width_in: float
    height_in: float


def arrange(cells: Sequence[Cell], width_in: float) -> tuple[list[Box], float, float]:
    """Boxes for cells in reading order, and the width and height of the sheet that they fill.

    Of all ways to break the cells into rows, the one is taken whose rows are nearest to the heights that cells want.
    """
    rows = [_stretched(row, width_in) for row in _rows(cells, width_in)]
    used_in = max(_width(row, height_in) for row, height_in in rows)
    boxes: list[Box] = []
    top_in = 0.0
    for row, height_in in rows:
        top_in += max(cell.top_in for cell in row)
        boxes += _row_boxes(row, top_in, height_in, used_in)
        top_in += height_in + max(cell.bottom_in for cell in row)
    return boxes, used_in, top_in


def _stretched(row: Sequence[Cell], width_in: float) -> tuple[Sequence[Cell], float]:
    """The row with its cells as wide as they can be, and its height."""
    height_in = min(_height(row, width_in), TALLEST_IN)
    if not _yields(row):
        return [cell._replace(least_aspect=0.0) for cell in row], height_in
    narrow = [cell.at(height_in) for cell in row]
    free_in = width_in - _width(narrow, height_in)
    return [cell.at(height_in, free_in) for cell in row], height_in


def _rows(cells: Sequence[Cell], width_in: float) -> list[Sequence[Cell]]:
    """The best rows of all cells are those of the first so many and one row more; of equally good ones the fewest."""
    best: list[tuple[float, int, tuple[int, ...]]] = [(0.0, 0, ())]
    for end in range(1, len(cells) + 1):
        best.append(min(_with_row(best[start], start, cells[start:end], width_in) for start in range(end)))
    return [cells[a:b] for a, b in pairwise((*best[-1][2], len(cells)))]


def _with_row(
    before: tuple[float, int, tuple[int, ...]], start: int, row: Sequence[Cell], width_in: float
) -> tuple[float, int, tuple[int, ...]]:
    """How far from what is wanted all rows are with this one more, how many they are, and where each begins."""
    far, count, starts = before
    height_in = _height(row, width_in)
    return far + sum(log(height_in / cell.wanted_in) ** 2 for cell in row), count + 1, (*starts, start)


def _cell_width(cell: Cell, height_in: float) -> float:
    return max(cell.left_in + cell.aspect * height_in + cell.right_in, cell.least_in)


def _width(row: Sequence[Cell], height_in: float) -> float:
    return sum(_cell_width(cell, height_in) for cell in row)


def _yields(row: Sequence[Cell]) -> bool:
    """Whether one of its cells may be narrower, and another wants that."""
    return any(cell.least_aspect for cell in row) and any(cell.wanted_in > ROW_IN for cell in row)


def _height(row: Sequence[Cell], width_in: float) -> float:
    """Height of axes at which the row is width_in wide, by bisection; small where it never fits.

    Beside what may be narrower no cell is higher than it wants to be.
    """
    if _yields(row):
        return min(_height([cell.at(1.0) for cell in row], width_in), max(cell.wanted_in for cell in row))
    low, high = 0.01, 2 * width_in / min(cell.aspect for cell in row)
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if _width(row, middle) <= width_in else (low, middle)
    return low


def _row_boxes(row: Sequence[Cell], top_in: float, height_in: float, used_in: float) -> list[Box]:
    """A row that is too high to be wider is spread out."""
    gap_in = min((used_in - _width(row, height_in)) / max(len(row) - 1, 1), WIDEST_GAP_IN)
    ends = accumulate((_cell_width(cell, height_in) + gap_in for cell in row), initial=0.0)
    return [
        Box(end + cell.left_in, top_in, cell.aspect * height_in, height_in)
        for end, cell in zip(ends, row, strict=False)
    ]
