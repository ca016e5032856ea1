"""Parts, places and lengths in words."""

from collections.abc import Sequence

import numpy as np

from ..parts.words.places import place_in_words

MOST_NAMED = 4
PLACES = 9
"""Rows and columns of the grid on which a place is found its words."""


def called(number: int, names: Sequence[str] = ()) -> str:
    """A part with its name, where it has one.

    >>> called(3), called(1, ["wall", "helmet"])
    ('part 3', 'part 1 (helmet)')
    """
    name = names[number] if number < len(names) else ""
    return f"part {number} ({name})" if name else f"part {number}"


def listed(texts: Sequence[str]) -> str:
    """In a sentence, the first of many.

    >>> listed(["a"]), listed(["a", "b", "c"]), listed(list("abcdef"))
    ('a', 'a, b and c', 'a, b, c, d and 2 more')
    """
    shown = [*texts[:MOST_NAMED], *([f"{len(texts) - MOST_NAMED} more"] if len(texts) > MOST_NAMED else [])]
    return " and ".join(filter(None, [", ".join(shown[:-1]), shown[-1]]))


def mm(length_m: float) -> str:
    """In millimetres, to a tenth below 100.

    >>> mm(0.0032), mm(0.00317), mm(0.297)
    ('3.2 mm', '3.2 mm', '297 mm')
    """
    value = 1e3 * length_m
    return f"{value:.0f} mm" if value >= 100 else f"{float(f'{value:.1f}'):g} mm"


def where(x: float, y: float) -> str:
    """A place that is given by shares of the picture: from the left and from the top.

    >>> where(0.1, 0.1), where(0.5, 0.9)
    ('at the upper left', 'at the bottom in the middle')
    """
    cells = np.zeros((PLACES, PLACES), np.bool_)
    cells[min(PLACES - 1, int(PLACES * y)), min(PLACES - 1, int(PLACES * x))] = True
    return place_in_words(cells)
