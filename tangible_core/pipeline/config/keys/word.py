"""A key with a single value: a word, a number, a choice."""

from dataclasses import dataclass
from functools import cached_property
from typing import Any

from pydantic import BaseModel, BeforeValidator, create_model
from pydantic_core import PydanticUseDefault

from ....scene.workspace import Section
from .key import Forms, Key, Reading


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
        """Check the value by the type of the field."""
        found = reading.source.model((), self._form, {self.name: block})
        return None if found is None else getattr(found, self.name)

    def schema(self, forms: Forms) -> dict[str, Any]:
        """Describe the value by the type of the field."""
        return forms.of(self._form)["properties"][self.name]

    @cached_property
    def _form(self) -> type[BaseModel]:
        """A model of this field alone."""
        fields: dict[str, Any] = {self.name: (self.field.annotation, self.field)}
        return create_model(self.name, __base__=Section, **fields)
