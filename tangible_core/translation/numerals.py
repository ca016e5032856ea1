"""Numbers in a language's notation."""

import re

UNITS = r"%|[mcu]?m|[mu]?s|N|N/m|N/mm|N s/m|m/s|mm/s|k?Hz|px|[kMG]i?B|bytes|deg|min|h|g|J|dB"
NUMBER = re.compile(rf"([-\u2212+±]?)([1-9]\d{{0,2}}(?:,\d{{3}})+|\d+)(?:\.(\d+))?(e[-+]?\d+)?(?:| ?(?:{UNITS}))")
"""A number alone, with its unit."""
MARKS = {"de": (",", "."), "fr": (",", "\u202f")}
"""The decimal mark, and the mark between thousands."""


class Numerals:
    """The notation of numbers of one language."""

    def __init__(self, language: str) -> None:
        self._decimal, self._thousands = MARKS[language]

    def __call__(self, text: str) -> str | None:
        """Return a number in the notation; None for any other text."""
        if (match := NUMBER.fullmatch(text)) is None:
            return None
        sign, whole, fraction, exponent = match.groups(default="")
        unit = text[match.end(4) if exponent else match.end(3) if fraction else match.end(2) :]
        return (
            f"{sign}{whole.replace(',', self._thousands)}{self._decimal + fraction if fraction else ''}{exponent}{unit}"
        )
