"""Text in lines of braille that are no wider than there is room."""

from ..errors import BrailleError, check_positive, quoted
from .cells import Cells
from .cells import width_m as width_of_m
from .translation import translate

_HYPHEN = "-"


def wrapped(text: str, language: str, width_m: float) -> list[Cells]:
    """Lines of cells, each at most so wide: they break at spaces, and a word that is wider breaks behind a hyphen.

    Raises: BrailleError as `translate`, and where not even one letter has room.

    >>> [len(line) for line in wrapped("a cab is here", "en", 0.05)]
    [8, 4]
    """
    check_positive("width_m", width_m)
    lines, line = list[Cells](), ""
    for word in text.split():
        if _fits(longer := f"{line} {word}".strip(), language, width_m):
            line = longer
            continue
        lines += [translate(line, language)] if line else []
        *starts, line = _broken(word, language, width_m)
        lines += [translate(start, language) for start in starts]
    return [*lines, translate(line, language)] if line else lines


def _fits(text: str, language: str, width_m: float) -> bool:
    return width_of_m(translate(text, language)) <= width_m


def _broken(word: str, language: str, width_m: float) -> list[str]:
    """A word as pieces that have room, all but the last with a hyphen."""
    pieces = list[str]()
    while not _fits(word, language, width_m):
        count = next((n for n in range(len(word) - 1, 0, -1) if _fits(word[:n] + _HYPHEN, language, width_m)), 0)
        if not count:
            raise BrailleError(
                f"{quoted(word)} in braille is wider than {1000 * width_m:.4g} mm, and so is its first letter; "
                "make the place wider"
            )
        pieces.append(word[:count] + _HYPHEN)
        word = word[count:]
    return [*pieces, word]
