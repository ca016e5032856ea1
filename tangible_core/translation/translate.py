"""Texts in a language, at the place where they are shown."""

import re

from .chosen import LANGUAGES, language

MARKS = re.compile(r"((?<!\\)\[/?[a-z][a-z0-9_ #]*\]|(?<!\\)\[/\])")


def translate(text: str, to: str) -> str:
    """Return an English text of the program in another language; a text without a translation stays as it is."""
    if to == LANGUAGES[0] or not text:
        return text
    from .catalogue import catalogue  # read only where it is needed

    return catalogue(to)(text)


def localise(text: str) -> str:
    """Return an English text in the language of the terminal."""
    return translate(text, language())


def localise_marked(text: str) -> str:
    """Return `localise` of a text with rich's marks, which stay."""
    if language() == LANGUAGES[0]:
        return text
    return "".join(
        word if number % 2 else _escape(localise(word.replace(r"\[", "[")))
        for number, word in enumerate(MARKS.split(text))
    )


def _escape(text: str) -> str:
    return re.sub(r"\[(?=[a-z/#@])", r"\\[", text)
