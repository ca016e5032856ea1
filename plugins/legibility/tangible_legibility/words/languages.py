"""The languages of descriptions, and sentences from their tables of words."""

import json
import logging
import re
from collections.abc import Callable, Mapping
from importlib.resources import files
from typing import Literal, NamedTuple, get_args
from unicodedata import category

from tangible_core.data import shown_number
from tangible_core.errors import quoted, shown
from tangible_core.plugins import note

Language = Literal["en", "de", "fr"]
LANGUAGES: tuple[Language, ...] = get_args(Language)


class Table(NamedTuple):
    """The words of one language."""

    # Texts by key, with placeholders; the key of a place is its third from the top and its third from the left.
    words: Mapping[str, str]
    materials: Mapping[str, str]
    # Names of the materials in the form that follows `feels like`, where that is another one.
    after_like: Mapping[str, str] = {}
    no_break_before: str = ""  # marks before which a space does not break


TABLES: Mapping[Language, Table] = {
    each: Table(**json.loads(files("tangible_legibility.words").joinpath(f"{each}.json").read_text(encoding="utf-8")))
    for each in LANGUAGES
}


def language_of(tag: str) -> Language:
    """Return the language of the words for this tag: English if the language has none.

    >>> language_of("de-AT"), language_of("pt")
    ('de', 'en')
    """
    code = tag.partition("-")[0].lower()
    for each in LANGUAGES:
        if each == code:
            return each
    return "en"


def spoken_language(tag: str, log: logging.Logger) -> Language:
    """Return `language_of`, and note where English stands in for a language without words."""
    language = language_of(tag)
    if language != tag.partition("-")[0].lower():
        note(log, f"described in English: there are no words for the language {quoted(tag)}; {_there_are()}")
    return language


def _there_are() -> str:
    *most, last = LANGUAGES
    return f"there are for {', '.join(most)} and {last}"


def part_label(part: str | int, language: str = "en") -> str:
    """Return the label of a part on a page, in a key or aloud: its name, or its number if it has none.

    language: a tag, as of a pipeline.

    >>> part_label("helmet"), part_label(3), part_label(3, "de-AT")
    ('helmet', 'part 4', 'Teil 4')
    """
    if isinstance(part, str):
        return one_line(part)
    return Words(language_of(language))("part number", number=shown_number(part))


def one_line(text: str) -> str:
    """Return a text on one line, without control characters and surrogates.

    >>> one_line(" two\\n lines\\x07")
    'two lines'
    """
    return " ".join("".join(each for each in text if each.isspace() or category(each) not in ("Cc", "Cs")).split())


class Words:
    """The words of one language."""

    def __init__(self, language: Language) -> None:
        self.language: Language = language
        self._table = TABLES[language]

    def __call__(self, key: str, **parts: object) -> str:
        """Return the text of this key, its placeholders filled."""
        text = self._table.words[key]
        if marks := self._table.no_break_before:
            text = re.sub(f" ([{marks}])", "\u00a0\\1", text)
        return text.format(**parts)

    def material(self, name: str) -> str:
        """Return the name of a material."""
        return self._table.materials.get(name) or shown(name)

    def material_after_like(self, name: str, given: Callable[[str], str] = shown) -> str:
        """Return a material as it follows `feels like`. given: converts a name that is not in the library."""
        return self._table.after_like.get(name) or self._table.materials.get(name) or given(name)

    def number(self, value: float) -> str:
        """Format a number with two digits, or all of a whole number above 100."""
        rounded = float(f"{value:.2g}") if value < 100 else float(round(value))
        text = f"{rounded:.12f}".rstrip("0").rstrip(".")
        return text.replace(".", self("point"))

    def join(self, parts: list[str]) -> str:
        """Join texts with commas and `and`."""
        *most, last = parts
        return f"{', '.join(most)} {self('and')} {last}" if most else last
