"""The title of a page in braille, and lines of braille anywhere."""

import numpy as np

from ..braille import DOT_DIAMETER_M, LINE_PITCH_M, Cells, dots, wrapped
from .marks.svg import Braille
from .sheet import MARGIN_MM, Sheet

MOST_LINES = 4
"""Of the title of a key; what is longer ends there."""


def title_lines(title: str, language: str, sheet: Sheet) -> tuple[list[Cells], bool]:
    """Lines that have room over the picture, and whether these are all. Raises: BrailleError as `wrapped`."""
    lines = wrapped(title, language, sheet.title_width_mm / 1000)
    room = 1 + int((sheet.spare_mm / 1000 + 1e-9) / LINE_PITCH_M)
    return lines[:room], len(lines) <= room


def lines_at(text: str, lines: list[Cells], left_mm: float, top_mm: float) -> Braille:
    """Lines of braille whose dots begin at this left and upper edge."""
    edge_m = DOT_DIAMETER_M / 2
    at = [dots(line, (edge_m, edge_m + row * LINE_PITCH_M)) for row, line in enumerate(lines)]
    return Braille(text, 1000 * np.concatenate([*at, np.zeros((0, 2))]) + np.array([left_mm, top_mm]))


def title_at(title: str, lines: list[Cells]) -> Braille:
    """In the upper left corner of a sheet."""
    return lines_at(title, lines, MARGIN_MM, MARGIN_MM)
