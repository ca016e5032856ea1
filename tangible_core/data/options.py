"""The options of a method in words: their docstrings, and from its JSON Schema values, bounds, defaults."""

import ast
from collections.abc import Iterable, Mapping
from functools import cache
from inspect import cleandoc, getsource
from itertools import pairwise
from textwrap import fill
from typing import Any, NamedTuple, cast

from pydantic import BaseModel

from .units import option_unit

BOUNDS = {"minimum": "≥", "exclusiveMinimum": ">", "maximum": "≤", "exclusiveMaximum": "<"}


def field_texts(model: type[BaseModel]) -> dict[str, str]:
    """Return the docstrings below a model's fields, by name; pydantic's own reading of sources delays each start."""
    bases = (cls for cls in reversed(model.__mro__) if issubclass(cls, BaseModel) and cls is not BaseModel)
    return {name: text for cls in bases for name, text in _own_texts(cls).items()}


@cache
def _own_texts(cls: type) -> dict[str, str]:
    try:
        source = getsource(cls)
    except (OSError, TypeError):
        return {}
    tree = ast.parse("if 1:\n" + source if source[0].isspace() else source)
    body = next(node.body for node in ast.walk(tree) if isinstance(node, ast.ClassDef))
    return {
        field.target.id: cleandoc(text.value.value)
        for field, text in pairwise(body)
        if isinstance(field, ast.AnnAssign) and isinstance(field.target, ast.Name)
        if isinstance(text, ast.Expr) and isinstance(text.value, ast.Constant) and isinstance(text.value.value, str)
    }


class Option(NamedTuple):
    """An option of a method, in words."""

    name: str
    unit: str
    values: str  # the values that may be written, with bounds
    default: str
    meaning: str

    @property
    def bounds(self) -> str:
        """The unit and the values."""
        return ", ".join(filter(None, (self.unit, self.values)))


def describe_options(model: type[BaseModel]) -> list[Option]:
    """Describe all options of a method, those of a block below it as `block.option`."""
    form = model.model_json_schema(ref_template="#/$defs/{model}")
    return [
        Option(
            name, option_unit(name), values_in_code(option).replace("`", ""), default_in_code(option).strip("`"),
            " ".join(option.get("description", "").split()),
        )
        for name, option in options_in(form, form.get("$defs", {}))
    ]  # fmt: skip


def options_as_text(model: type[BaseModel]) -> str:
    """Return a paragraph for each option, with its default, unit, bounds and meaning; empty without options."""
    options = describe_options(model)
    heads = (f"{option.name} = {option.default or None}   ({option.bounds})" for option in options)
    lines = (
        f"{head}\n{fill(option.meaning, 100, initial_indent='    ', subsequent_indent='    ')}"
        for head, option in zip(heads, options, strict=True)
    )
    return "\n".join(("Options:", *lines)) if options else ""


def options_in(
    form: Mapping[str, Any], blocks: Mapping[str, Any], prefix: str = ""
) -> Iterable[tuple[str, dict[str, Any]]]:
    """Find options by name, those of a block below it as `block.option`."""
    for name, option in form.get("properties", {}).items():
        if name == "use":
            continue
        inner = _inner(option)
        yield f"{prefix}{name}", {**option, "default": None} if inner else option
        for block in inner:
            yield from options_in(blocks[block], blocks, f"{prefix}{name}.")


def _inner(option: Mapping[str, Any]) -> list[str]:
    """Return the names of the blocks that an option is, may be, or is a list of."""
    forms = (option, *option.get("anyOf", ()), option.get("items", {}))
    return [name_of_block(form) for form in forms if "$ref" in form]


def name_of_block(form: Mapping[str, Any]) -> str:
    """Return the name of the block to which a form refers."""
    return form["$ref"].rpartition("/")[2]


def default_in_code(option: Mapping[str, Any]) -> str:
    """Return the default as code; nothing for null and an empty text."""
    default = option.get("default")
    return "" if default in (None, "") else f"`{default}`"


def values_in_code(option: Mapping[str, Any]) -> str:
    """Return the values that may be written, with bounds."""
    if forms := option.get("anyOf", option.get("oneOf")):
        return " or ".join(values_in_code(form) for form in cast("list[dict[str, Any]]", forms))
    if "enum" in option:
        return names_in_code(option["enum"])
    if "const" in option:
        return f"`{option['const']}`"
    if "examples" in option:
        return f"text such as {option['examples'][0]}"
    bounds = [f"{sign} {option[word]}" for word, sign in BOUNDS.items() if word in option]
    return " ".join([option.get("type", "block"), *bounds])


def names_in_code(values: Iterable[Any]) -> str:
    """List values as code."""
    return ", ".join(f"`{value}`" for value in values)
