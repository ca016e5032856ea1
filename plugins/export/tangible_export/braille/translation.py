"""Text as uncontracted braille, by liblouis where it is installed and else by tables of our own."""

import logging
import re
import unicodedata

from tangible_core.errors import BrailleError, quoted
from tangible_core.plugins.notes import note

from .cells import Cells
from .latin import CODES, translated
from .louis import TABLES, louis, not_written

log = logging.getLogger(__name__)

LANGUAGES = tuple(CODES)
"""Those whose braille is written; any other is written by the English code."""
_APOSTROPHE = re.compile("(?<=\\w)\u2019(?=\\w)")
"""As print has it between letters: no closing quotation mark."""
_OPENING = re.compile(r'(?<![^\s(\[])"(?=\S)')
"""Straight quotation marks that open: the English code tells them from those that close."""
_GERMAN_QUOTES = re.compile("[„\u201c\u201d]")
"""What closes in German opens in English; by where they stand, straight ones are either."""
_FRENCH_SPACE = re.compile("(«) +| +([:;!?»])")
"""Print sets a space there; braille has none."""
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
    spoken = _language_of(language)
    text = _plain(text, spoken)
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
    other = "" if language.partition("-")[0].lower() == spoken else f", for want of one for {quoted(language)}"
    if isinstance(library, str):
        return f"{CODES[spoken].title}{other} ({library})"
    return f"liblouis {library.version}, {TABLES[spoken]}{other}"


def _language_of(tag: str) -> str:
    spoken = tag.partition("-")[0].lower()
    return spoken if spoken in CODES else "en"


def _plain(text: str, language: str) -> str:
    """Composed letters and plain spaces. Raises: BrailleError for what is no character of a line."""
    composed = unicodedata.normalize("NFC", text)
    plain = "".join(" " if each.isspace() else each for each in composed if each not in _LEFT_OUT)
    plain = _APOSTROPHE.sub("'", plain)
    if language == "en":
        plain = _OPENING.sub("\u201c", plain).replace('"', "\u201d")
    elif language == "de":
        plain = _GERMAN_QUOTES.sub('"', plain)
    elif language == "fr":
        plain = _FRENCH_SPACE.sub(lambda found: found[1] or found[2], plain)
    for place, each in enumerate(plain, 1):
        if unicodedata.category(each) in ("Cc", "Cs", "Co", "Cn"):
            raise BrailleError(not_written(each, place, plain, "any braille"))
    return plain
