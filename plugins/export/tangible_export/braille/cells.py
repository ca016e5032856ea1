"""Cells of six dots as numbers, whose bit i says whether dot i + 1 is raised, and their dots in metres."""

from typing import TypeAlias

import numpy as np
from jaxtyping import Float64

from tangible_legibility.rules import CELL_PITCH_M, DOT_DIAMETER_M, DOT_PITCH_M, LINE_PITCH_M

Cells: TypeAlias = tuple[int, ...]

_UNICODE = 0x2800
# By the number of the cell: North American Braille Computer Code, which embossers print.
_ASCII = " A1B'K2L@CIF/MSP\"E3H9O6R^DJG>NTQ,*5<-U8V.%[$+X!&;:4\\0Z7(_?W]#Y)="


def dots(cells: Cells, at_m: tuple[float, float] = (0.0, 0.0)) -> Float64[np.ndarray, "n 2"]:
    """Return the centres of raised dots, metres to the right and down; dot 1 of the first cell is at `at_m`."""
    x_m, y_m = at_m
    centres = [
        (x_m + place * CELL_PITCH_M + (dot // 3) * DOT_PITCH_M, y_m + (dot % 3) * DOT_PITCH_M)
        for place, cell in enumerate(cells)
        for dot in range(6)
        if cell >> dot & 1
    ]
    return np.array(centres, np.float64).reshape(-1, 2)


def width_m(cells: Cells) -> float:
    """Return the width from the left edge of the first cell's dots to the right edge of the last cell's, or 0."""
    return (len(cells) - 1) * CELL_PITCH_M + DOT_PITCH_M + DOT_DIAMETER_M if cells else 0.0


def height_m(lines: int = 1) -> float:
    """Return the height from the upper edge of the first line's dots to the lower edge of the last line's, or 0."""
    return (lines - 1) * LINE_PITCH_M + 2 * DOT_PITCH_M + DOT_DIAMETER_M if lines else 0.0


def as_unicode(cells: Cells) -> str:
    """Return cells as the characters of Unicode's braille patterns."""
    return "".join(chr(_UNICODE + cell) for cell in cells)


def as_ascii(cells: Cells) -> str:
    """Return cells as the characters of embossers and of `.brf` files."""
    return "".join(_ASCII[cell] for cell in cells)
