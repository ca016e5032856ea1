"""The place of a part in a picture, in words for thirds and halves; texts for parts and lengths."""

from collections.abc import Sequence

import numpy as np
from jaxtyping import Bool

from tangible_core.data import name_part

from .languages import Language, Words

MOSTLY, NEARLY = 0.6, 0.8
"""Smallest share of a part in one third of the picture, or in one half, for that side to be named."""
NOWHERE = "- -"  # a part without a side


def place_in_words(part: Bool[np.ndarray, "h w"], language: Language = "en") -> str:
    """Describe where most of a part lies; empty if it has no side.

    >>> place_in_words(np.eye(6) > 0), place_in_words(np.tri(6, dtype=bool) & (np.arange(6) < 2))
    ('', 'on the left')
    """
    place = place_of(part)
    return "" if place == NOWHERE else Words(language)(place)


def place_of(part: np.ndarray) -> str:
    """Return the key of the third of the picture, from the top and from the left, with most of a part."""
    return place_of_counts(part.sum(axis=1), part.sum(axis=0))


def place_of_counts(down: np.ndarray, across: np.ndarray) -> str:
    """Return the same key from the pixels of a part in every row, and in every column."""
    return f"{_third(down)} {_third(across)}"


def _third(counts: np.ndarray) -> str:
    """Return the third, or the half, of one side with most of the counts: 0, 1, 2, or `-` for none."""
    if counts.size < 3:
        return "-"
    shares = np.bincount(3 * np.arange(counts.size) // counts.size, weights=counts) / counts.sum()
    best = int(shares.argmax())
    if shares[best] >= MOSTLY:
        return str(best)
    half = counts.size // 2
    first, second = counts[:half].sum() / counts.sum(), counts[-half:].sum() / counts.sum()
    return "0" if first >= NEARLY else "2" if second >= NEARLY else "-"


MAX_NAMED = 4  # texts of a list that are written out
PLACES = 9  # rows and columns of the grid on which a place gets its words


def describe_part(number: int, names: Sequence[str] = ()) -> str:
    """Return a part's number and, if it has one, its name.

    >>> describe_part(3), describe_part(1, ["wall", "helmet"])
    ('part 4', 'part 2 (helmet)')
    """
    return name_part(number, names[number] if number < len(names) else "")


def join_texts(texts: Sequence[str]) -> str:
    """Join texts by commas and "and"; of many, the first ones and the number of the others.

    >>> join_texts(["a"]), join_texts(["a", "b", "c"]), join_texts(list("abcdef"))
    ('a', 'a, b and c', 'a, b, c, d and 2 more')
    """
    shown = [*texts[:MAX_NAMED], *([f"{len(texts) - MAX_NAMED} more"] if len(texts) > MAX_NAMED else [])]
    return " and ".join(filter(None, [", ".join(shown[:-1]), shown[-1]]))


def millimetres(length_m: float) -> str:
    """Format a length in millimetres, to a tenth below 100.

    >>> millimetres(0.0032), millimetres(0.00317), millimetres(0.297)
    ('3.2 mm', '3.2 mm', '297 mm')
    """
    value = 1e3 * length_m
    return f"{value:.0f} mm" if value >= 100 else f"{float(f'{value:.1f}'):g} mm"


def describe_place(x: float, y: float) -> str:
    """Describe a place that is given by shares of the picture, from the left and from the top.

    >>> describe_place(0.1, 0.1), describe_place(0.5, 0.9)
    ('at the upper left', 'at the bottom in the middle')
    """
    cells = np.zeros((PLACES, PLACES), np.bool_)
    cells[min(PLACES - 1, int(PLACES * y)), min(PLACES - 1, int(PLACES * x))] = True
    return place_in_words(cells)
