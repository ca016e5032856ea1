"""Uncontracted braille of Latin letters by the tables `codes/LANGUAGE.toml`, where liblouis is not installed."""

import re
import tomllib
import unicodedata
from collections.abc import Mapping
from dataclasses import dataclass, field
from functools import cache
from importlib.resources import files
from itertools import groupby
from typing import Any

from tangible_core.errors import BrailleError

from .cells import Cells
from .louis import missing_character

LANGUAGES = ("en", "de", "fr")


def _cells(text: str) -> Cells:
    """Read the numbers of the raised dots, a cell a word; 0 for an empty one."""
    return tuple(sum(1 << int(dot) - 1 for dot in cell if dot != "0") for cell in text.split())


_PLAIN = "1 12 14 145 15 124 1245 125 24 245 13 123 134 1345 135 1234 12345 1235 234 2345 136 1236 2456 1346 13456 1356"
LETTERS = dict(zip("abcdefghijklmnopqrstuvwxyz", _cells(_PLAIN), strict=True))
"""Plain letters, which are the same in every Latin braille."""


@dataclass(frozen=True)
class Code:
    """The braille of one language."""

    title: str
    signs: Mapping[str, Cells]
    quotes: tuple[Cells, Cells]
    quoting: str  # characters that open or close a quotation according to their place
    number: Cells
    digits: Cells
    within_number: str
    # Characters before a digit that belong to the number: the number sign stands before them.
    before_number: str
    after_number: Cells = ()
    read_as_digit: str = ""
    thousands: Cells = (0,)
    capital: Cells = ()
    capital_word: Cells = ()
    capital_end: Cells = ()
    capital_passage: Cells = ()  # sign before three words or more in capitals; `capital_end` stands after them
    no_space_before: str = ""
    # Accents, as combining characters; their cells stand before the letter's.
    marks: Mapping[str, Cells] = field(default_factory=dict[str, Cells])


_TEXTS = frozenset({"title", "quoting", "within_number", "before_number", "read_as_digit", "no_space_before"})
_UPPER = "A-ZÀ-ÖØ-Þ"
_PASSAGE = re.compile(rf"(?<![^ ])[{_UPPER}]+(?: [{_UPPER}]+){{2,}}(?![^ ])")


@cache
def read_code(language: str) -> Code:
    """Read the table of a language, one of `LANGUAGES`."""
    text = files("tangible_export.braille").joinpath("codes", f"{language}.toml").read_text(encoding="utf-8")
    return Code(**{name: value if name in _TEXTS else _parse(value) for name, value in tomllib.loads(text).items()})


def _parse(value: Any) -> Any:
    if isinstance(value, dict):
        return {character: _cells(cells) for character, cells in value.items()}
    return tuple(map(_cells, value)) if isinstance(value, list) else _cells(value)


def translate_by_table(text: str, language: str) -> Cells:
    """Translate one line of composed characters. Raises: BrailleError for a character that is not in the table."""
    code, cells = read_code(language), list[int]()
    if code.no_space_before:
        text = re.sub(f" +([{code.no_space_before}])", r"\1", text)
    capitals = _capitals(text, code)
    for place, character in enumerate(text):
        cells += capitals.get(place, ())
        cells += _number_sign(text, place, code)
        cells += (code.digits[int(character)],) if _is_digit(text, place) else _sign(text, place, code)
    return (*cells, *capitals.get(len(text), ()))


def _is_digit(text: str, place: int) -> bool:
    return 0 <= place < len(text) and text[place] in "0123456789"


def _number_sign(text: str, place: int, code: Code) -> Cells:
    """Return the sign before a character with which a number begins, or before which a number has ended."""
    character = text[place]
    if _is_digit(text, place - 1):
        return code.after_number if (character if code.capital else character.lower()) in code.read_as_digit else ()
    if character in code.before_number and _is_digit(text, place + 1):
        return code.number
    if not _is_digit(text, place) or (place and text[place - 1] in code.before_number):
        return ()
    goes_on = _is_digit(text, place - 2) and (
        text[place - 1] in code.within_number or _thousands(text, place - 1, code)
    )
    return () if goes_on else code.number


def _thousands(text: str, place: int, code: Code) -> bool:
    """Tell whether there is a space at this place between a number and a group of three digits that belongs to it."""
    three = re.match(r" [0-9]{3}(?![0-9])", text[place:])
    return code.thousands != (0,) and _is_digit(text, place - 1) and three is not None


def _sign(text: str, place: int, code: Code) -> Cells:
    character = text[place]
    if character in code.quoting:
        closes = place > 0 and (text[place - 1] not in " ([" or text[place + 1 : place + 2] in ("", " "))
        return code.quotes[closes]
    if character == " ":
        return code.thousands if _thousands(text, place, code) else (0,)
    if (cells := _letter(character, code)) is None:
        raise BrailleError(f"{missing_character(character, place + 1, text, code.title)}, or install liblouis")
    return cells


def _letter(character: str, code: Code) -> Cells | None:
    if (lower := character.lower()) in code.signs:
        return code.signs[lower]
    if lower in LETTERS:
        return (LETTERS[lower],)
    base, *marks = unicodedata.normalize("NFD", lower)
    if base not in LETTERS or not marks or not all(mark in code.marks for mark in marks):
        return None
    return (*(cell for mark in marks for cell in code.marks[mark]), LETTERS[base])


def _capitals(text: str, code: Code) -> dict[int, Cells]:
    """Return the signs of capitals: before a capital letter or a run of them, and after the run; by place."""
    if not code.capital:
        return {}
    signs: dict[int, Cells] = {}
    passages = [match.span() for match in _PASSAGE.finditer(text)] if code.capital_passage else []
    for start, end in passages:
        signs[start], signs[end] = code.capital_passage, code.capital_end
    for is_upper, run in groupby(range(len(text)), lambda place: text[place].isupper()):
        places = [*run]
        start, end = places[0], places[-1] + 1
        if not is_upper or any(first <= start < last for first, last in passages):
            continue
        signs[start] = code.capital_word if end - start > 1 else code.capital
        if end - start > 1 and end < len(text) and text[end].isalpha():
            signs[end] = code.capital_end
    return signs
