"""The languages that descriptions have words in."""

import logging
import re
from collections.abc import Callable, Mapping
from typing import Literal, NamedTuple, get_args
from unicodedata import category

from ...errors import quoted, shown
from ...plugins.notes import note
from . import de, en, fr

Language = Literal["en", "de", "fr"]
LANGUAGES: tuple[Language, ...] = get_args(Language)


class Table(NamedTuple):
    """The words of one language."""

    words: Mapping[str, str]
    """By key, with places for what is filled in."""
    materials: Mapping[str, str]
    """Names of the library's materials."""
    felt: Mapping[str, str]
    """The same as they stand after `feels like`."""
    no_break_before: str = ""
    """Marks that the space before them keeps on their line."""


TABLES: Mapping[Language, Table] = {
    "en": Table(en.WORDS, en.MATERIALS, en.FELT),
    "de": Table(de.WORDS, de.MATERIALS, de.FELT),
    "fr": Table(fr.WORDS, fr.MATERIALS, fr.FELT, ":;%"),
}


def language_of(tag: str) -> Language:
    """The language of the words for what is tagged so: English where there are none in its own.

    >>> language_of("de-AT"), language_of("pt")
    ('de', 'en')
    """
    spoken = tag.partition("-")[0].lower()
    for each in LANGUAGES:
        if each == spoken:
            return each
    return "en"


def spoken_language(tag: str, log: logging.Logger) -> Language:
    """`language_of`, with a note where English stands in for a language that has no words here."""
    language = language_of(tag)
    if language != tag.partition("-")[0].lower():
        note(log, f"described in English: there are no words for the language {quoted(tag)}; {_there_are()}")
    return language


def _there_are() -> str:
    *most, last = LANGUAGES
    return f"there are for {', '.join(most)} and {last}"


def part_label(part: str | int, language: str = "en") -> str:
    """What a part is called on a page, in a key or aloud: its name, or its number where nobody named it.

    language: a tag, as of a pipeline.

    >>> part_label("helmet"), part_label(3), part_label(3, "de-AT")
    ('helmet', 'part 3', 'Teil 3')
    """
    if isinstance(part, str):
        return written(part)
    return Words(language_of(language))("part number", number=part)


def written(text: str) -> str:
    """Somebody's words as a page has them: all of them on one line, without what is no character of a text.

    >>> written(" two\\n lines\\x07")
    'two lines'
    """
    return " ".join("".join(each for each in text if each.isspace() or category(each) not in ("Cc", "Cs")).split())


class Words:
    """What is said in one language."""

    def __init__(self, language: Language) -> None:
        self.language: Language = language
        self._table = TABLES[language]

    def __call__(self, key: str, **parts: object) -> str:
        """What stands under this key, with these parts in their places."""
        text = self._table.words[key]
        if marks := self._table.no_break_before:
            text = re.sub(f" ([{marks}])", "\u00a0\\1", text)
        return text.format(**parts)

    def material(self, name: str) -> str:
        """The name of a material."""
        return self._table.materials.get(name) or shown(name)

    def felt(self, name: str, given: Callable[[str], str] = shown) -> str:
        """A material as it stands after `feels like`. given: writes the name of one that the library does not have."""
        return self._table.felt.get(name) or given(name)

    def number(self, value: float) -> str:
        """Two digits, and all of a whole number."""
        rounded = float(f"{value:.2g}") if value < 100 else float(round(value))
        text = f"{rounded:.12f}".rstrip("0").rstrip(".")
        return text.replace(".", self("point"))

    def together(self, parts: list[str]) -> str:
        """One after the other."""
        *most, last = parts
        return f"{', '.join(most)} {self('and')} {last}" if most else last
