"""The base of all kinds of keys, and what a key needs to be read and to be described."""

from abc import ABC, abstractmethod
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from typing import Any, ClassVar, Self

from pydantic import BaseModel
from pydantic.fields import FieldInfo
from pydantic_core import core_schema

from ....errors import TangibleError
from ....files.yaml.source import Location, Source
from ....plugins.registry import Registry


class Unchecked:
    """A marker of a field whose value pydantic does not check, as it was checked before."""

    def __get_pydantic_core_schema__(self, source: Any, handler: Any) -> core_schema.CoreSchema:
        return core_schema.any_schema()


@dataclass(frozen=True)
class Reading:
    """A configuration while it is read: its source, which collects the complaints, and the installed methods."""

    source: Source
    registry: Registry


@dataclass
class Forms:
    """JSON Schemas of the models and methods that a key may hold, and the definitions that they refer to."""

    registry: Registry
    distribution: str | None  # the distribution whose methods are described; all that are installed when None
    definitions: dict[str, Any] = field(default_factory=dict[str, Any])

    def of(self, model: type[BaseModel]) -> dict[str, Any]:
        """Return the schema of a model."""
        schema = model.model_json_schema(ref_template="#/$defs/{model}")
        self.definitions.update(schema.pop("$defs", {}))
        return schema

    def of_method(self, name: str, method: type[BaseModel]) -> dict[str, Any]:
        """Return the schema of a method's block: `use` and the options."""
        form = self.of(method)
        form["title"] = name
        form["properties"] = {"use": {"const": name}, **form.get("properties", {})}
        form["required"] = ["use", *form.get("required", [])]
        return form

    def of_kind(self, kind: str) -> dict[str, Any]:
        """Return the schema of any method of a kind: its name alone, or its block. A broken plugin is left out."""
        methods = list(self._methods(kind))
        return {"anyOf": [{"enum": [name for name, _ in methods]}, *(self.of_method(*method) for method in methods)]}

    def _methods(self, kind: str) -> Iterator[tuple[str, type[BaseModel]]]:
        for name in self.registry.names(kind):
            try:
                if self.distribution in (None, self.registry.find(kind, name).distribution):
                    yield name, self.registry.load(kind, name)
            except TangibleError:
                continue


@dataclass(frozen=True)
class Key(ABC):
    """A key of the pipeline file: the marker of a field of `PipelineConfig`, which names and describes it."""

    note: str = ""
    """A sentence in Markdown that follows the description on the reference page."""
    name: str = ""
    """The name of the field; `for_field` fills it in."""
    field: FieldInfo = field(default_factory=FieldInfo)
    stands_last: ClassVar[bool] = False
    """True for a key that a completed file has behind the others."""
    missing: ClassVar[str] = ""
    """The complaint about a file without this key, for a key that every file needs."""

    def for_field(self, name: str, field: FieldInfo) -> Self:
        """Return this key of a field."""
        return replace(self, name=name, field=field)

    @abstractmethod
    def read(self, reading: Reading, block: Any) -> Any:
        """Return the checked value of what a file has under this key; None after a complaint, or for the default."""

    def take(self, reading: Reading, value: Any) -> Any:
        """Return the checked value of an argument in Python; by default it may be whatever a file may have."""
        return self.read(reading, value)

    def write(self, value: Any) -> Any:
        """Return plain values for a file. Raises: ConfigError for a value that no file can have."""
        return value

    def word_option(self, depth: int) -> str:
        """Return the option that a word alone stands for, `depth` keys below the top (1: this key); empty for none."""
        return ""

    def settings(self) -> Iterable[str]:
        """Return the beginnings of `--set` for this key, as a shell completes them."""
        return (f"{self.name}=",)

    def models(self, value: Any) -> Mapping[Location, BaseModel]:
        """Return the models in a value by their places in the file."""
        return {}

    @abstractmethod
    def schema(self, forms: Forms) -> dict[str, Any]:
        """Return the JSON Schema of what a file may have under this key."""


def find_keys(model: type[BaseModel]) -> dict[str, Key]:
    """Return the keys of a pipeline file by name, in the order of the fields; fields without a marker are none."""
    return {
        name: marker.for_field(name, field)
        for name, field in model.model_fields.items()
        for marker in field.metadata
        if isinstance(marker, Key)
    }
