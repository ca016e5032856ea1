"""Where panels stand on a sheet: rows of one height, each filling the width."""

from collections.abc import Sequence
from itertools import accumulate, pairwise
from math import log
from typing import NamedTuple

ROW_IN = 2.5
"""Height of a row that is neither cramped nor wasteful, inches."""
TALLEST_IN = 4.5
"""A panel alone on its sheet grows no taller."""


class Cell(NamedTuple):
    """What a panel asks for: width over height of its axes, and room round them in inches.

    A cell narrower than its text, `least_in`, gets more room on the right.
    """

    aspect: float
    left_in: float
    right_in: float
    bottom_in: float
    top_in: float
    least_in: float = 0.0


class Box(NamedTuple):
    """Place of a panel's axes: inches from the sheet's left and upper edge, to the axes' left upper corner."""

    left_in: float
    top_in: float
    width_in: float
    height_in: float


def arrange(cells: Sequence[Cell], width_in: float) -> tuple[list[Box], float, float]:
    """Boxes for cells in reading order, and the width and height of the sheet that they fill.

    Of all ways to break the cells into rows, the one whose rows are nearest to ROW_IN in height is taken.
    """
    rows = _rows(cells, width_in)
    boxes: list[Box] = []
    top_in = 0.0
    for row in rows:
        height_in = min(_height(row, width_in), TALLEST_IN)
        top_in += max(cell.top_in for cell in row)
        boxes += _row_boxes(row, top_in, height_in)
        top_in += height_in + max(cell.bottom_in for cell in row)
    used_in = max(_width(row, min(_height(row, width_in), TALLEST_IN)) for row in rows)
    return boxes, used_in, top_in


def _rows(cells: Sequence[Cell], width_in: float) -> list[Sequence[Cell]]:
    """The best rows of all cells are those of the first so many and one row more; of equally good ones the fewest."""
    best: list[tuple[float, int, tuple[int, ...]]] = [(0.0, 0, ())]
    for end in range(1, len(cells) + 1):
        best.append(min(_with_row(best[start], start, cells[start:end], width_in) for start in range(end)))
    return [cells[a:b] for a, b in pairwise((*best[-1][2], len(cells)))]


def _with_row(
    before: tuple[float, int, tuple[int, ...]], start: int, row: Sequence[Cell], width_in: float
) -> tuple[float, int, tuple[int, ...]]:
    """How far from ROW_IN all rows are with this one more, how many they are, and where each begins."""
    far, count, starts = before
    return far + len(row) * log(_height(row, width_in) / ROW_IN) ** 2, count + 1, (*starts, start)


def _cell_width(cell: Cell, height_in: float) -> float:
    return max(cell.left_in + cell.aspect * height_in + cell.right_in, cell.least_in)


def _width(row: Sequence[Cell], height_in: float) -> float:
    return sum(_cell_width(cell, height_in) for cell in row)


def _height(row: Sequence[Cell], width_in: float) -> float:
    """Height of axes at which the row is width_in wide, by bisection; small where it never fits."""
    low, high = 0.01, 2 * width_in / min(cell.aspect for cell in row)
    for _ in range(40):
        middle = (low + high) / 2
        low, high = (middle, high) if _width(row, middle) <= width_in else (low, middle)
    return low


def _row_boxes(row: Sequence[Cell], top_in: float, height_in: float) -> list[Box]:
    ends = accumulate((_cell_width(cell, height_in) for cell in row), initial=0.0)
    return [
        Box(end + cell.left_in, top_in, cell.aspect * height_in, height_in)
        for end, cell in zip(ends, row, strict=False)
    ]
