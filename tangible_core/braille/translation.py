"""Text as uncontracted braille, by liblouis where it is installed and else by tables of our own."""

import logging
import unicodedata

from ..errors import BrailleError, quoted
from ..plugins.notes import note
from .cells import Cells
from .latin import CODES, translated
from .louis import TABLES, louis, not_written

log = logging.getLogger(__name__)

LANGUAGES = tuple(CODES)
"""Those whose braille is written; any other is written by the English code."""
_LEFT_OUT = "\u00ad\u200b\u2060\ufeff"
"""Characters that say where a line may break, and have no form of their own."""


def translate(text: str, language: str = "en") -> Cells:
    """Cells of one line of text: bit i for dot i + 1. The first cell of `()` is none: an empty text has no cells.

    language: a tag such as `de-AT`; English, German and French have codes of their own, all else is written by the
    English one: see `written_by`.
    Raises: BrailleError for a character that has no braille there, with its place and the cure.

    >>> translate("a cab") == (1, 0, 9, 1, 3)
    True
    """
    spoken, text = _language_of(language), _plain(text)
    library = louis()
    if isinstance(library, str):
        return translated(text, spoken)
    try:
        return library.translate(text, spoken)
    except OSError as error:
        note(log, f"braille by a table of our own: {error}", logging.WARNING)
        return translated(text, spoken)


def written_by(language: str = "en") -> str:
    """Who translates: liblouis with its version and table, or a table of our own, and why.

    What writes braille into a file says it once, by `note`.
    """
    library, spoken = louis(), _language_of(language)
    other = "" if language.lower().startswith(spoken) else f", for want of one for {quoted(language)}"
    if isinstance(library, str):
        return f"{CODES[spoken].title}{other} ({library})"
    return f"liblouis {library.version}, {TABLES[spoken]}{other}"


def _language_of(tag: str) -> str:
    spoken = tag.partition("-")[0].lower()
    if spoken in CODES:
        return spoken
    return "en"


def _plain(text: str) -> str:
    """Composed letters and plain spaces. Raises: BrailleError for what is no character of a line."""
    composed = unicodedata.normalize("NFC", text)
    plain = "".join(" " if each.isspace() else each for each in composed if each not in _LEFT_OUT)
    for place, each in enumerate(plain, 1):
        if unicodedata.category(each) in ("Cc", "Cs", "Co", "Cn"):
            raise BrailleError(not_written(each, place, plain, "any braille"))
    return plain
