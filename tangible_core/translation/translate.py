"""The language of the person at the terminal, and texts in a language, at the place where they are shown."""

import re
from collections.abc import Mapping

MARKS = re.compile(r"((?<!\\)\[/?[a-z][a-z0-9_ #]*\]|(?<!\\)\[/\])")
# The languages of which there is a catalogue; English, the first, is the language of the source and needs none.
LANGUAGES = ("en", "de", "fr")
LOCALES = ("LC_ALL", "LC_MESSAGES", "LANG")
"""The variables of the environment that name the locale of messages, the strongest first."""
WITHOUT_LANGUAGE = ("", "C", "POSIX")
_chosen = [LANGUAGES[0]]


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


def language() -> str:
    """Return the language in which the terminal is addressed."""
    return _chosen[0]


def set_language(tag: str) -> None:
    """Address the terminal in the language of a tag, such as `de` or `de_AT.UTF-8`; in English if it has none."""
    _chosen[0] = _spoken(tag) or LANGUAGES[0]


def language_of_environment(environment: Mapping[str, str]) -> str:
    """Return the language that the environment asks for, by the variables of gettext and in their order.

    >>> language_of_environment({"LANG": "de_DE.UTF-8"})
    'de'
    >>> language_of_environment({"LANG": "en_GB.UTF-8", "LANGUAGE": "nl:fr:de"})
    'fr'
    >>> language_of_environment({"LC_ALL": "C.UTF-8", "LANGUAGE": "de"})
    'en'
    """
    locale = next((environment[variable] for variable in LOCALES if environment.get(variable)), "")
    if locale.partition(".")[0] in WITHOUT_LANGUAGE:
        return LANGUAGES[0]
    tags = [*environment.get("LANGUAGE", "").split(":"), locale]
    return next((name for name in map(_spoken, tags) if name), LANGUAGES[0])


def _spoken(tag: str) -> str:
    """Return the language of a tag, or "" if there is no catalogue of it."""
    name = tag.replace("_", "-").partition("-")[0].partition(".")[0].lower()
    return name if name in LANGUAGES else ""
