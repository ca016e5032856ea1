"""A text with placeholders: recognised in a finished English text, and filled in another language."""

import re
from collections.abc import Callable, Mapping
from functools import cached_property

PLACEHOLDER = re.compile(r"\{(\w+)(!s)?\}")
LONG = 9
"""The fewest characters of a literal that is not in a text twice by chance."""


class Template:
    """An English text with placeholders such as `{name}`, and its translation."""

    def __init__(self, english: str, translation: str) -> None:
        self.english = english
        self.translation = translation
        self.literals: tuple[str, ...] = tuple(PLACEHOLDER.split(english)[::3])
        self.letters: int = sum(map(str.isalpha, "".join(self.literals)))
        self.longest: str = max(self.literals, key=len)

    @cached_property
    def names(self) -> tuple[str, ...]:
        """The names of the placeholders, in the order of the English text."""
        return tuple(match[1] for match in PLACEHOLDER.finditer(self.english))

    def is_once_in(self, text: str) -> bool:
        """Return True if a text may be made of this template; two texts of it in one, joined as a list, are not."""
        times = text.count(self.longest)
        return times == 1 or (times > 1 and len(self.longest) < LONG)

    def match(self, text: str) -> Mapping[str, str] | None:
        """Return what stands in place of each placeholder if a text was made of this template."""
        first, *middle, last = self.literals
        if not (text.startswith(first) and text.endswith(last)) or len(text) < len(first) + len(last):
            return None
        begin, end, values = len(first), len(text) - len(last), list[str]()
        for literal in middle:
            place = _place(text, literal, begin, end)
            if place < 0:
                return None
            values.append(text[begin:place])
            begin = place + len(literal)
        values.append(text[begin:end])
        for number in reversed(range(len(middle))):  # of placeholders side by side, the first one has it all
            if not middle[number]:
                values[number], values[number + 1] = values[number + 1], values[number]
        if "\n" not in self.english and any("\n" in value for value in values):
            return None
        return dict(zip(self.names, values, strict=True))

    def fill(self, values: Mapping[str, str], embed: Callable[[str], str]) -> str:
        """Return the translation with these values. embed: puts a value into the language."""
        parts = self.translation.split("`")
        for number, part in enumerate(parts):
            is_code = number % 2 == 1

            def value(match: re.Match[str], is_code: bool = is_code) -> str:
                own = values[match[1]]
                return own if is_code or match[2] else embed(own)

            parts[number] = PLACEHOLDER.sub(value, part)
        return "`".join(parts)


def _place(text: str, literal: str, begin: int, end: int) -> int:
    """Return where a literal stands first, or -1; a full stop alone is not the point in a number."""
    place = text.find(literal, begin, end)
    while literal == "." and place > 0 and text[place - 1].isdigit() and text[place + 1 : place + 2].isdigit():
        place = text.find(literal, place + 1, end)
    return place
