"""Text in lines of braille that are no wider than there is room."""

import re

from tangible_core.errors import BrailleError, check_positive, quoted

from .cells import Cells
from .cells import width_m as width_of_m
from .translation import translate

_HYPHEN = "-"
_BREAK = re.compile("[^\\S\u00a0\u202f]+(?!%)")
"""Spaces, but for those that print keeps on one line, and before a per cent sign."""


def wrapped(text: str, language: str, width_m: float, indent: int = 0) -> list[Cells]:
    """Lines of cells, each at most so wide: they break at spaces, and a word that is wider breaks behind a hyphen.

    Spaces that print keeps on a line are kept here too. indent: empty cells before every line but the first.
    Raises: BrailleError as `translate`, and where not even one letter has room.

    >>> [len(line) for line in wrapped("a cab is here", "en", 0.05)]
    [8, 4]
    """
    check_positive("width_m", width_m)
    lines, line = list[Cells](), ""
    for word in filter(None, _BREAK.split(text)):
        if _fits(longer := f"{line} {word}".strip(), language, width_m, indent if lines else 0):
            line = longer
            continue
        if line:
            lines.append(_indented(line, language, indent if lines else 0))
        while (count := _beginning(word, language, width_m, indent if lines else 0)) < len(word):
            lines.append(_indented(word[:count] + _HYPHEN, language, indent if lines else 0))
            word = word[count:]
        line = word
    return [*lines, _indented(line, language, indent if lines else 0)] if line else lines


def _indented(text: str, language: str, indent: int) -> Cells:
    return (0,) * indent + translate(text, language)


def _fits(text: str, language: str, width_m: float, indent: int) -> bool:
    return width_of_m(_indented(text, language, indent)) <= width_m


def _beginning(word: str, language: str, width_m: float, indent: int) -> int:
    """How many characters of a word have room, with a hyphen behind them where that is not all of it."""
    if _fits(word, language, width_m, indent):
        return len(word)
    for count in range(len(word) - 1, 0, -1):
        if _fits(word[:count] + _HYPHEN, language, width_m, indent):
            return count
    raise BrailleError(
        f"{quoted(word)}: not even its first letter and a hyphen have room in {1000 * width_m:.4g} mm of braille; "
        "make the place wider"
    )
