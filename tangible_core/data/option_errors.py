"""Errors of pydantic about a block of YAML: in plain words, and at locations that the block has."""

import re
from collections.abc import Iterable, Iterator
from typing import Any, cast, get_args

from pydantic import BaseModel, ValidationError

from ..errors import did_you_mean, quoted, shown

Location = tuple[Any, ...]
"""Keys and indices from the top of the file."""
PLAIN_WORDS = {
    "dict_type": "Input should be a mapping, such as {key: value}",
    "model_type": "Input should be a mapping, such as {key: value}",
    "list_type": "Input should be a list, such as [1, 2]",
    "tuple_type": "Input should be a list, such as [1, 2]",
    "path_type": "Input should be the path of a file",
    "int_parsing": "Input should be a valid integer",
    "string_unicode": "Input should be text of whole characters",
    "float_parsing": "Input should be a valid number",
    "invalid_key": "Keys should be words (a number has a decimal point, such as 0.08)",
}
"""Messages in place of pydantic's, which name types of Python, by the type of its error."""
DECIMAL_COMMA = re.compile(r"[-+]?\d+,\d+(?![\d,])")
_WANTED = "Input should be "


def plain_errors(error: ValidationError, block: Any) -> list[dict[str, Any]]:
    """Return pydantic's errors with plain messages and locations that the block has."""
    errors: list[dict[str, Any]] = [{**item, "loc": _location_in(block, item["loc"])} for item in error.errors()]
    locations: list[Location] = [item["loc"] for item in errors]
    deepest = [item for item in errors if not any(_is_within(other, item["loc"]) for other in locations)]
    by_place = dict[tuple[Location, str], dict[str, Any]]()
    for item in deepest:
        text = str(PLAIN_WORDS.get(item["type"]) or item["msg"].removeprefix("Value error, "))
        key = (item["loc"], "" if text.startswith(_WANTED) else text)
        if key in by_place and key[1] == "":
            text = f"{by_place[key]['msg']}, or {text.removeprefix(_WANTED)}"
        by_place[key] = {**item, "msg": text}
    return list(by_place.values())


def sentences_about(
    error: ValidationError, model: type[BaseModel], block: Any, location: Location = ()
) -> list[tuple[Location, str]]:
    """Return pydantic's errors about the options of a model as sentences, each with its place."""
    return [_sentence(plain_error, model, location) for plain_error in plain_errors(error, block)]


def _sentence(error: dict[str, Any], model: type[BaseModel], location: Location) -> tuple[Location, str]:
    is_key = error["type"] == "extra_forbidden"  # the last part is then the file's, and not a name of pydantic's
    inner = error["loc"][:-1] if is_key else error["loc"]
    plain = (part for part in inner if part != "[key]" and not str(part).startswith(":"))
    where = (*location, *plain, *error["loc"][len(inner) :])
    name = shown(".".join(str(part) for part in where))
    if is_key:
        options = list(model_at(model, error["loc"][:-1]).model_fields)
        options_text = f"; known: {', '.join(options)}" if options else "; there are no options"
        return where, f"{name}: unknown option{did_you_mean(str(where[-1]), options)}{options_text}"
    is_clear = isinstance(error["input"], dict) or error["type"] == "missing"
    value_text, hint = "" if is_clear else f", not {quoted(error['input'])}", ""
    if isinstance(error["input"], str) and DECIMAL_COMMA.match(error["input"]):
        hint = f"; with a decimal point it is {shown(error['input'].replace(',', '.'))}"
    if name.endswith("_m") and error["type"].startswith("less_than"):
        hint = f"; for millimetres write {cast(float, error['input']):g} mm"
    if error["type"] == "literal_error":
        hint = did_you_mean(f"{error['input']}", re.findall(r"'([^']*)'", error["msg"]))
    return where, f"{name}: {error['msg']}{value_text}{hint}".removeprefix(": ")


def _is_within(inner: Location, outer: Location) -> bool:
    return len(inner) > len(outer) and inner[: len(outer)] == outer


def _location_in(block: Any, location: Location) -> Location:
    """Return a location without the names that pydantic gives to the forms of an option that has several."""
    node: Any = block
    parts = list[Any]()
    for part in location:
        if isinstance(part, str) and not isinstance(node, dict) and part != "[key]":
            continue
        parts.append(part)
        if isinstance(node, dict | list) and has(node, part):
            node = cast(Any, node)[part]
    return tuple(parts)


def has(node: Any, part: Any) -> bool:
    """Return True if a mapping has this key, or a list this index."""
    return part in node if isinstance(node, dict) else isinstance(part, int) and part < len(node)


def model_at(model: type[BaseModel], location: Iterable[Any]) -> type[BaseModel]:
    """Return the innermost model on the way to a location in a model."""
    for part in location:
        if isinstance(part, str) and part in model.model_fields:
            model = next(_models_in(model.model_fields[part].annotation), model)
    return model


def _models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in get_args(annotation):
        yield from _models_in(part)
