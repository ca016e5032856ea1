"""The place of a part in a picture, in words for thirds and halves."""

import numpy as np
from jaxtyping import Bool

from .languages import Language, Words

MOSTLY, NEARLY = 0.6, 0.8
"""Smallest share of a part in one third of the picture, or in one half, for that side to be named."""
NOWHERE = "- -"
"""Key of a part without a side."""


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
