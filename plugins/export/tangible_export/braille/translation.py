"""Text as lines of braille, by liblouis where it is installed and otherwise by our own tables."""

import logging
import re
import unicodedata
from typing import Literal

from tangible_core.data import Quantities
from tangible_core.errors import BrailleError, check_positive, quoted
from tangible_core.plugins import note

from .cells import Cells
from .cells import width_m as width_of_m
from .latin import LANGUAGES, read_code, translate_by_table
from .louis import CONTRACTED, TABLES, louis, missing_character

log: logging.Logger = logging.getLogger(__name__)

# A typographic apostrophe between letters: it is not a closing quotation mark.
_APOSTROPHE = re.compile("(?<=\\w)\u2019(?=\\w)")
# Straight quotation marks that open: the English code tells opening from closing ones.
_OPENING = re.compile(r'(?<![^\s(\[])"(?=\S)')
# German quotation marks, made straight: the mark that closes in German opens in English.
_GERMAN_QUOTES = re.compile("[„\u201c\u201d]")
_FRENCH_SPACE = re.compile("(«) +| +([:;!?»])")  # spaces that print has and braille has not
_HYPHEN = "-"
# The end of a language tag, for private use as BCP 47 allows it, by which texts are contracted.
_GRADE_2 = "-x-grade2"
# The characters of a text that is never contracted: the letters of a key stand for themselves.
_SHORT = 2
_BREAK = re.compile("[^\\S\u00a0\u202f]+(?!%)")


class BrailleChoice(Quantities):
    """The braille of a file."""

    grade: Literal[1, 2] = 1
    """1 is uncontracted, a letter a cell; 2 contracted, as books are printed, in English, German and French by
    liblouis."""

    @staticmethod
    def in_force(option: "bool | BrailleChoice") -> "BrailleChoice":
        """Return the choice that an option stands for, which may only say whether there is braille."""
        return option if isinstance(option, BrailleChoice) else BrailleChoice()


def in_grade(language: str, grade: int) -> str:
    """Return the tag for texts in a grade. Raises: BrailleError where there is no contracted braille."""
    if grade == 1:
        return language
    cure = "or write `braille: {grade: 1}`"
    if (own := language.partition("-")[0].lower()) not in CONTRACTED:
        raise BrailleError(f"there is no contracted braille for {quoted(language)}; there is for en, de and fr, {cure}")
    library = louis()
    if isinstance(library, str):
        raise BrailleError(
            f"contracted braille needs liblouis, and {library}; install it (apt install liblouis20, brew install "
            f"liblouis), {cure}"
        )
    try:
        library.translate("abc", own, grade)
    except OSError as error:
        raise BrailleError(f"{error}; install all of its tables (apt install liblouis-data), {cure}") from error
    return f"{language}{_GRADE_2}"


def translate(text: str, language: str = "en") -> Cells:
    """Translate one line of text into cells, numbers whose bit i is dot i + 1; an empty text has no cells.

    language: a tag such as `de-AT`; English, German and French have their own codes, any other language is written by
    the English code: see `written_by`.
    Raises: BrailleError for a character that has no braille there, with its place and the cure.

    >>> translate("a cab") == (1, 0, 9, 1, 3)
    True
    """
    code_language = _base_language(language)
    text = _plain(text, code_language)
    library = louis()
    if isinstance(library, str):
        return translate_by_table(text, code_language)
    try:
        return library.translate(text, code_language, 2 if language.endswith(_GRADE_2) and len(text) > _SHORT else 1)
    except OSError as error:
        note(log, f"braille by our own table: {error}", logging.WARNING)
        return translate_by_table(text, code_language)


def written_by(language: str = "en") -> str:
    """Name the translator: liblouis with its version and table, or our own table, with the reason."""
    library, code_language = louis(), _base_language(language)
    is_own = language.partition("-")[0].lower() == code_language
    other = "" if is_own else f", for want of one for {quoted(language)}"
    if isinstance(library, str):
        return f"{read_code(code_language).title}{other} ({library})"
    tables = CONTRACTED if language.endswith(_GRADE_2) else TABLES
    return f"liblouis {library.version}, {tables[code_language]}{other}"


def _base_language(tag: str) -> str:
    language = tag.partition("-")[0].lower()
    return language if language in LANGUAGES else "en"


def _plain(text: str, language: str) -> str:
    """Return composed letters and plain spaces. Raises: BrailleError for control and unassigned characters."""
    text_nfc = unicodedata.normalize("NFC", text)
    plain = "".join(" " if character.isspace() else character for character in visible(text_nfc))
    plain = _APOSTROPHE.sub("'", plain)
    if language == "en":
        plain = _OPENING.sub("\u201c", plain).replace('"', "\u201d")
    elif language == "de":
        plain = _GERMAN_QUOTES.sub('"', plain)
    elif language == "fr":
        plain = _FRENCH_SPACE.sub(lambda match: match[1] or match[2], plain)
    for place, character in enumerate(plain, 1):
        if unicodedata.category(character) in ("Cc", "Cs", "Co", "Cn"):
            raise BrailleError(missing_character(character, place, plain, "any braille"))
    return plain


def visible(text: str) -> str:
    """Return a text without its invisible characters, such as those that allow a line break or turn its direction."""
    return "".join(character for character in text if unicodedata.category(character) != "Cf")


def title_in_braille(title: str, language: str) -> str:
    """Return a title that braille can write; "" after a note if a character of it has no braille."""
    try:
        translate(title, language)
    except BrailleError as error:
        note(log, f"the title is left out: {error}, in `title:`", logging.WARNING)
        return ""
    return visible(title)


def wrapped(text: str, language: str, width_m: float, indent: int = 0) -> list[Cells]:
    """Return lines of cells, none wider than `width_m`: they break at spaces, and longer words after a hyphen.

    Lines do not break at non-breaking spaces. indent: empty cells before every line but the first.
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
            lines.append(_indent(line, language, indent if lines else 0))
        while (count := _fitting_characters(word, language, width_m, indent if lines else 0)) < len(word):
            lines.append(_indent(word[:count] + _HYPHEN, language, indent if lines else 0))
            word = word[count:]
        line = word
    return [*lines, _indent(line, language, indent if lines else 0)] if line else lines


def _indent(text: str, language: str, indent: int) -> Cells:
    return (0,) * indent + translate(text, language)


def _fits(text: str, language: str, width_m: float, indent: int) -> bool:
    return width_of_m(_indent(text, language, indent)) <= width_m


def _fitting_characters(word: str, language: str, width_m: float, indent: int) -> int:
    """Return how many characters of a word fit on a line, with a hyphen after them if the word goes on."""
    if _fits(word, language, width_m, indent):
        return len(word)
    for count in range(len(word) - 1, 0, -1):
        if _fits(word[:count] + _HYPHEN, language, width_m, indent):
            return count
    raise BrailleError(
        f"{quoted(word)}: not even its first letter and a hyphen have room in {1000 * width_m:.4g} mm of braille; "
        "make the place wider"
    )
