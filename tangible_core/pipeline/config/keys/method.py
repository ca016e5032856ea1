"""Keys that name methods: one of a kind, or a list of them."""

from collections.abc import Iterable, Mapping
from dataclasses import dataclass
from typing import Any, cast

from pydantic import BaseModel
from ruamel.yaml.comments import CommentedMap

from ....errors import ConfigError, quoted
from ....files.yaml.source import Location
from ....plugins.interfaces import KINDS
from ..methods import NamedMethod, choose, named_method
from .key import Forms, Key, Reading, Unchecked


@dataclass(frozen=True)
class MethodBlock(Key, Unchecked):
    """A key with one method of the kind that it is named after."""

    stands_last = True

    def read(self, reading: Reading, block: Any) -> Any:
        return choose(reading.source, (self.name,), self.name, block, reading.registry)

    def take(self, reading: Reading, value: Any) -> Any:
        return _take_method((self.name,), self.name, reading, value)

    def write(self, value: NamedMethod[Any]) -> Any:
        return value.as_written(self.name)

    def word_option(self, depth: int) -> str:
        return "use" if depth == 1 else ""

    def settings(self) -> Iterable[str]:
        return (f"{self.name}.use=",)

    def models(self, value: NamedMethod[Any] | None) -> Mapping[Location, BaseModel]:
        return {} if value is None else {(self.name,): value.method}

    def schema(self, forms: Forms) -> dict[str, Any]:
        return forms.of_kind(self.name)


@dataclass(frozen=True)
class MethodList(Key, Unchecked):
    """A key with a list of methods of the kind that it is named after."""

    stands_last = True

    def read(self, reading: Reading, block: Any) -> Any:
        if block is None:
            return ()
        if not isinstance(block, list):
            names = ", ".join(reading.registry.names(self.name))
            return reading.source.complain(
                (self.name,),
                f"{self.name}: takes a list of {_plural(self.name)}, such as [{{use: ...}}], not {quoted(block)}; "
                f"installed: {names}",
            )
        entries = enumerate(cast("list[Any]", block))
        methods = [
            choose(reading.source, (self.name, at), self.name, method, reading.registry) for at, method in entries
        ]
        return tuple(method for method in methods if method is not None)

    def take(self, reading: Reading, value: Any) -> Any:
        methods = [value] if isinstance(value, str) else value
        return tuple(_take_method((self.name, at), self.name, reading, method) for at, method in enumerate(methods))

    def write(self, value: Iterable[NamedMethod[Any]]) -> Any:
        return [method.as_written(self.name) for method in value]

    def word_option(self, depth: int) -> str:
        return "use" if depth == 2 else ""

    def models(self, value: Iterable[NamedMethod[Any]]) -> Mapping[Location, BaseModel]:
        return {(self.name, index): method.method for index, method in enumerate(value)}

    def schema(self, forms: Forms) -> dict[str, Any]:
        return {"anyOf": [{"type": "array", "items": forms.of_kind(self.name)}, {"type": "null"}]}


def _take_method(place: Location, kind: str, reading: Reading, method: Any) -> NamedMethod[Any] | None:
    """Return a method with its name, from an object or from what a file may have; None after a complaint."""
    if isinstance(method, str | Mapping):
        block = dict(cast("Mapping[str, Any]", method)) if isinstance(method, Mapping) else method
        return choose(reading.source, place, kind, block, reading.registry)
    try:
        return named_method(kind, method, reading.registry)
    except ConfigError as error:
        return reading.source.complain(place, str(error))


def _plural(kind: str) -> str:
    return f"{KINDS[cast(Any, kind)].__name__.lower()}s"


def find_or_add(methods: list[Any], name: str) -> int:
    """Find a method in a list of a file by its name, or its number from 0; a method that is not there is added.

    >>> find_or_add(["stl", {"use": "swell"}], "swell")
    1
    """
    if name.isdecimal() and int(name) < len(methods):
        return int(name)
    for index, entry in enumerate(methods):
        if name == (cast("dict[Any, Any]", entry).get("use") if isinstance(entry, dict) else entry):
            return index
    methods.append(CommentedMap(use=name))
    return len(methods) - 1
