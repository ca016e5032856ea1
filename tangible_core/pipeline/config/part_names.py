"""The names of parts."""

from collections.abc import Mapping

from ...files.yaml.source import Location
from ...parts import PartChoice

Wrong = tuple[Location, str]
"""A complaint: the keys that it is about, and a sentence."""


def numbers_of(parts: Mapping[int, PartChoice]) -> dict[str, int]:
    """Return the numbers of parts by name."""
    return {choice.name.strip(): number for number, choice in parts.items() if choice.name.strip()}


def names_of(parts: Mapping[int, PartChoice], count: int) -> tuple[str, ...]:
    """Return a name for each of `count` parts; empty for a part without one."""
    return tuple(parts[number].name.strip() if number in parts else "" for number in range(count))
