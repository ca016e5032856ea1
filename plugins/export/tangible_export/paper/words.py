"""The words of a page that are no names, by language."""

from typing import NamedTuple


class Words(NamedTuple):
    """Of one language."""

    key: str
    """Stands over a list of what letters and fills mean."""
    corner: str
    """What the corner mark says to who hears the page."""


WORDS = {
    "en": Words("key", "upper right corner"),
    "de": Words("Legende", "Ecke oben rechts"),
    "fr": Words("légende", "coin supérieur droit"),
}


def words(language: str) -> Words:
    """Of a language tag such as `de-AT`; English for want of another."""
    return WORDS.get(language.partition("-")[0].lower(), WORDS["en"])
