"""Where something lies in a picture: in thirds of it, or halves."""

import numpy as np
from jaxtyping import Bool

from .languages import Language, Words

MOSTLY, NEARLY = 0.6, 0.8
"""Share of a part that lies in one third of the picture, or in one half, for that side to be named."""
NOWHERE = "- -"
"""Key of a part that is on no side."""


def place_in_words(part: Bool[np.ndarray, "h w"], language: Language = "en") -> str:
    """Where most of a part of a picture lies; empty where that is on no side.

    >>> place_in_words(np.eye(6) > 0), place_in_words(np.tri(6, dtype=bool) & (np.arange(6) < 2))
    ('', 'on the left')
    """
    place = place_of(part)
    return "" if place == NOWHERE else Words(language)(place)


def place_of(part: np.ndarray) -> str:
    """Where most of a part lies: the key of its third of the picture from the top, and from the left."""
    return place_of_counts(part.sum(axis=1), part.sum(axis=0))


def place_of_counts(down: np.ndarray, across: np.ndarray) -> str:
    """`place_of` a part by how much of it lies in every row, and in every column."""
    return f"{_third(down)} {_third(across)}"


def _third(counts: np.ndarray) -> str:
    """The third that holds most of what is counted along one side, or the half: 0, 1, 2, or `-` for none."""
    if counts.size < 3:
        return "-"
    held = np.bincount(3 * np.arange(counts.size) // counts.size, weights=counts) / counts.sum()
    best = int(held.argmax())
    if held[best] >= MOSTLY:
        return str(best)
    half = counts.size // 2
    first, second = counts[:half].sum() / counts.sum(), counts[-half:].sum() / counts.sum()
    return "0" if first >= NEARLY else "2" if second >= NEARLY else "-"
