"""The layout of a sheet: panels in rows of equal height, each row as wide as the sheet."""

from collections.abc import Sequence
from itertools import accumulate, pairwise
from math import log
from typing import NamedTuple

ROW_IN = 2.5  # the preferred height of a row, neither cramped nor wasteful, inches
# The widest gap between the panels of a row that does not fill the width, inches.
WIDEST_GAP_IN = 3.0
TALLEST_IN = 4.5  # the greatest height of a panel, inches


class Cell(NamedTuple):
    """The requested size of a panel: width over height of its axes, and the room around them in inches."""

    aspect: float
    left_in: float
    right_in: float
    bottom_in: float
    top_in: float
    least_in: float = 0.0

    @property
    def wanted_in(self) -> float:
        """The preferred height: narrow cells are higher, so that they are as large as a square in a row of ROW_IN."""
        return min(ROW_IN / min(self.aspect, 1.0) ** 0.5, TALLEST_IN)


class Box(NamedTuple):
    """The place of a panel's axes: their upper left corner in inches from the sheet's, and their size."""

    left_in: float
    top_in: float
    width_in: float
    height_in: float


def arrange(cells: Sequence[Cell], width_in: float) -> tuple[list[Box], float, float]:
    """Return boxes for cells in reading order, and the sheet's size; rows come nearest to the preferred heights."""
    rows = [(row, min(_height(row, width_in), TALLEST_IN)) for row in _break_into_rows(cells, width_in)]
    used_in = max(_width(row, height_in) for row, height_in in rows)
    boxes: list[Box] = []
    top_in = 0.0
    for row, height_in in rows:
        top_in += max(cell.top_in for cell in row)
        boxes += _row_boxes(row, top_in, height_in, used_in)
        top_in += height_in + max(cell.bottom_in for cell in row)
    return boxes, used_in, top_in


def _break_into_rows(cells: Sequence[Cell], width_in: float) -> list[Sequence[Cell]]:
    """Return the best rows, by dynamic programming over their ends; of equally good ones, the fewest rows."""
    best: list[tuple[float, int, tuple[int, ...]]] = [(0.0, 0, ())]
    for end in range(1, len(cells) + 1):
        best.append(min(_add_row(best[start], start, cells[start:end], width_in) for start in range(end)))
    return [cells[a:b] for a, b in pairwise((*best[-1][2], len(cells)))]


def _add_row(
    before: tuple[float, int, tuple[int, ...]], start: int, row: Sequence[Cell], width_in: float
) -> tuple[float, int, tuple[int, ...]]:
    """Return the cost of the rows before and this one, their number, and the first cell of each."""
    cost, count, starts = before
    height_in = _height(row, width_in)
    return cost + sum(log(height_in / cell.wanted_in) ** 2 for cell in row), count + 1, (*starts, start)


def _cell_width(cell: Cell, height_in: float) -> float:
    return max(cell.left_in + cell.aspect * height_in + cell.right_in, cell.least_in)


def _width(row: Sequence[Cell], height_in: float) -> float:
    return sum(_cell_width(cell, height_in) for cell in row)


def _height(row: Sequence[Cell], width_in: float) -> float:
    """Return the height of axes at which the row is width_in wide, by bisection; a small one if it never fits."""
    low, high = 0.01, 2 * width_in / min(cell.aspect for cell in row)
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if _width(row, middle) <= width_in else (low, middle)
    return low


def _row_boxes(row: Sequence[Cell], top_in: float, height_in: float, used_in: float) -> list[Box]:
    """Return the boxes of a row; gaps fill the width if the row would be too high to fill it."""
    gap_in = min((used_in - _width(row, height_in)) / max(len(row) - 1, 1), WIDEST_GAP_IN)
    ends = accumulate((_cell_width(cell, height_in) + gap_in for cell in row), initial=0.0)
    return [
        Box(end + cell.left_in, top_in, cell.aspect * height_in, height_in)
        for end, cell in zip(ends, row, strict=False)
    ]
