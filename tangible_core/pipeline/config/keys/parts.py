"""The key `parts:`, a map from the number of a part to its name, height and material."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, cast

from ....data.part_words import FROM_ONE
from ....errors import MAX_QUOTED, quoted
from ....parts import PartChoice
from .block import by_number
from .key import Forms, Key, Reading, Unchecked

EXAMPLE = "{1: wall, 7: {name: helmet, height_m: 4 mm}}"


@dataclass(frozen=True)
class PartsBlock(Key, Unchecked):
    """The key with a name, a height and a material for parts, by number."""

    def read(self, reading: Reading, block: Any) -> Any:
        source = reading.source
        if not isinstance(block, dict | None):
            example = f"takes a mapping from the number of a part to its name, such as {EXAMPLE}"
            source.complain((self.name,), f"{self.name}: {example}, not {quoted(block)}")
            return {}
        parts: dict[int, PartChoice] = {}
        for key, part in cast("dict[Any, Any]", block or {}).items():
            number, place = _number(key), (self.name, key)
            if number is None or number in parts:
                source.complain(place, f"{self.name}.{key}: {_no_number(key) if number is None else 'is there twice'}")
            elif isinstance(part, PartChoice):
                parts[number] = part
            elif not isinstance(part, str | dict | None):
                expected = "takes the name of a part, or {name: ..., height_m: ..., material: ...}"
                source.complain(place, f"{self.name}.{key}: {expected}, not {quoted(part)}")
            elif (choice := source.model(place, PartChoice, {} if part is None else part)) is not None:
                parts[number] = choice
        return parts

    def take(self, reading: Reading, value: Any) -> Any:
        if not isinstance(value, Mapping):
            return self.read(reading, value)
        blocks = dict[Any, Any]()
        for key, part in cast("Mapping[Any, Any]", value).items():
            if isinstance(key, str):  # only JSON's keys have to be words
                reading.source.complain((self.name, key), f"{self.name}.{key}: {_no_number(key)}")
            else:
                blocks[key] = dict(cast("Mapping[Any, Any]", part)) if isinstance(part, Mapping) else part
        return self.read(reading, blocks)

    def write(self, value: Mapping[int, PartChoice]) -> Any:
        return {number: part.model_dump(mode="json", exclude_defaults=True) for number, part in value.items()}

    def word_option(self, depth: int) -> str:
        return "name" if depth == 2 else ""

    def settings(self) -> Iterable[str]:
        """Return nothing: numbers of parts cannot be guessed."""
        return ()

    def schema(self, forms: Forms) -> dict[str, Any]:
        part = {"anyOf": [{"type": "string"}, {"type": "null"}, forms.of(PartChoice)]}
        return {"anyOf": [by_number(part), {"type": "null"}], "title": "Parts"}


def _no_number(key: Any) -> str:
    if quoted(key).strip("'") == "0":
        return f"numbers of parts are {FROM_ONE}, not 0"
    return f"the number of a part is a whole number from 1, not {quoted(key)}; such as {EXAMPLE}"


def _number(key: Any) -> int | None:
    """Return the number of a part, which JSON has as a word; None for any other key."""
    if isinstance(key, str) and key.isdecimal() and len(key) < MAX_QUOTED:
        key = int(key)
    return int(key) if isinstance(key, int) and not isinstance(key, bool) and key > 0 else None
