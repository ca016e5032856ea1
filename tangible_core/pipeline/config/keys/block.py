"""Keys with a block of options, a pydantic model, or with a single value."""

from collections.abc import Callable, Iterable, Mapping
from dataclasses import dataclass
from functools import cached_property
from typing import Any, cast, get_args

from pydantic import BaseModel, BeforeValidator, create_model
from pydantic_core import PydanticUseDefault

from ....files.yaml.source import Location, Source
from ....scene.workspace import Section
from .key import Forms, Key, Reading


@dataclass(frozen=True)
class Block(Key):
    """A key with a block of options; the type of its field is the model, or the model or None."""

    word: str = ""  # the option that a word alone stands for
    # The option that a map whose keys are numbers stands for; in Python, a word stands for it, too.
    labels: str = ""
    # A check of the whole block in a file, which notes its complaints in the source.
    check: Callable[[Source, Location, Any], None] | None = None

    @property
    def model(self) -> type[BaseModel]:
        """The model of the options."""
        forms = get_args(self.field.annotation) or (self.field.annotation,)
        return next(form for form in forms if isinstance(form, type) and issubclass(form, BaseModel))

    @property
    def nullable(self) -> bool:
        """True for a block that `null` switches off."""
        return type(None) in get_args(self.field.annotation)

    def read(self, reading: Reading, block: Any) -> Any:
        options = self._parse(reading, block)
        if options is not None and self.check is not None:
            self.check(reading.source, (self.name,), options)
        return options

    def take(self, reading: Reading, value: Any) -> Any:
        if isinstance(value, self.model):
            return value
        value = {self.labels: value} if self.labels and isinstance(value, str) else value
        return self._parse(reading, dict(cast("Mapping[Any, Any]", value)) if isinstance(value, Mapping) else value)

    def _parse(self, reading: Reading, block: Any) -> Any:
        if block is None and self.nullable:
            return None
        if self.word and isinstance(block, str):
            block = {self.word: block}
        keys = list(cast("dict[Any, Any]", block)) if isinstance(block, dict) else []
        numbers = [key for key in keys if isinstance(key, int)]
        if self.labels and numbers and self.model.model_fields.keys() & set(keys):
            rule = f"rules: [{{segment: {numbers[0]}, material: {cast(Any, block)[numbers[0]]}}}]"
            wrong = f"a number does not go with other keys, such as `{self.labels}`; write `{rule}` in its place"
            reading.source.complain((self.name, numbers[0]), wrong)
            return None
        if self.labels and numbers:
            block = cast(Any, {self.labels: block})
        return reading.source.model((self.name,), self.model, block)

    def write(self, value: Any) -> Any:
        return value and value.model_dump(mode="json", exclude_none=True)

    def word_option(self, depth: int) -> str:
        return self.word if depth == 1 else ""

    def settings(self) -> Iterable[str]:
        alone = [f"{self.name}="] if self.word else []
        return (*alone, *(f"{self.name}.{option}=" for option in self.model.model_fields))

    def models(self, value: Any) -> Mapping[Location, BaseModel]:
        return {} if value is None else {(self.name,): value}

    def schema(self, forms: Forms) -> dict[str, Any]:
        block = forms.of(self.model)
        others = list[dict[str, Any]]()
        if self.word:
            others.append({"enum": block["properties"][self.word]["enum"]})
        if self.labels:
            others.append(by_number({"type": "string"}))
        if self.nullable:
            others.append({"type": "null"})
        return {"anyOf": [block, *others]} if others else block


def by_number(value: Mapping[str, Any]) -> dict[str, Any]:
    """Return the JSON Schema of a map from whole numbers, from 1, to such values."""
    return {"type": "object", "patternProperties": {"^[1-9][0-9]*$": dict(value)}, "additionalProperties": False}


def _default_for_null(value: Any) -> Any:
    if value is None:
        raise PydanticUseDefault
    return value


NULL_IS_DEFAULT = BeforeValidator(_default_for_null)
"""A marker of a field for which `null` in a file means the default."""


@dataclass(frozen=True)
class Word(Key):
    """A key with a single value, which the type of its field checks."""

    def read(self, reading: Reading, block: Any) -> Any:
        options = reading.source.model((), self._form, {self.name: block})
        return None if options is None else getattr(options, self.name)

    def schema(self, forms: Forms) -> dict[str, Any]:
        return forms.of(self._form)["properties"][self.name]

    @cached_property
    def _form(self) -> type[BaseModel]:
        fields: dict[str, Any] = {self.name: (self.field.annotation, self.field)}
        return create_model(self.name, __base__=Section, **fields)
