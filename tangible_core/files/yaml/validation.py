"""pydantic's complaints about a block of YAML, in plain words and at places that the block has."""

from collections.abc import Iterable, Iterator, Mapping
from typing import Any, cast, get_args

from pydantic import BaseModel, ValidationError

Location = tuple[Any, ...]
"""Keys and indices from the top of the file."""


PLAIN_WORDS = {
    "dict_type": "Input should be a mapping, such as {key: value}",
    "model_type": "Input should be a mapping, such as {key: value}",
    "list_type": "Input should be a list, such as [1, 2]",
    "tuple_type": "Input should be a list, such as [1, 2]",
    "path_type": "Input should be the path of a file",
    "int_parsing": "Input should be a valid integer",
    "float_parsing": "Input should be a valid number",
}
"""What pydantic says in words of Python's, by the type of its error."""


def deepest(error: ValidationError, block: Any) -> list[Mapping[str, Any]]:
    """What pydantic complains of, at places that the block has; of the forms of an option, that which fits farthest."""
    found: list[dict[str, Any]] = [{**each, "loc": place_in(block, each["loc"])} for each in error.errors()]
    places: list[Location] = [each["loc"] for each in found]
    return [each for each in found if not any(_is_within(place, each["loc"]) for place in places)]


def joined(found: Iterable[Mapping[str, Any]]) -> list[dict[str, Any]]:
    """The same in plain words; what is wanted at one place said once: `Input should be greater than 0, or 'auto'`."""
    wanted = "Input should be "
    joined = dict[tuple[Location, str], dict[str, Any]]()
    for each in found:
        said = str(PLAIN_WORDS.get(each["type"]) or each["msg"].removeprefix("Value error, "))
        key = (each["loc"], "" if said.startswith(wanted) else said)
        if key in joined and key[1] == "":
            said = f"{joined[key]['msg']}, or {said.removeprefix(wanted)}"
        joined[key] = {**each, "msg": said}
    return list(joined.values())


def _is_within(inner: Location, outer: Location) -> bool:
    return len(inner) > len(outer) and inner[: len(outer)] == outer


def place_in(block: Any, location: Location) -> Location:
    """A place as the block has it: without the names that pydantic gives the forms of an option that has several."""
    node: Any = block
    place = list[Any]()
    for part in location:
        if isinstance(part, str) and not isinstance(node, dict) and part != "[key]":
            continue
        place.append(part)
        if isinstance(node, dict | list) and has(node, part):
            node = cast(Any, node)[part]
    return tuple(place)


def model_at(model: type[BaseModel], location: Iterable[Any]) -> type[BaseModel]:
    """The innermost of a model's models on the way to a place in it."""
    for part in location:
        if isinstance(part, str) and part in model.model_fields:
            model = next(_models_in(model.model_fields[part].annotation), model)
    return model


def _models_in(annotation: Any) -> Iterator[type[BaseModel]]:
    if isinstance(annotation, type) and issubclass(annotation, BaseModel):
        yield annotation
    for part in get_args(annotation):
        yield from _models_in(part)


def has(node: Any, part: Any) -> bool:
    """Return True if a mapping has this key, or a list this index."""
    return part in node if isinstance(node, dict) else isinstance(part, int) and part < len(node)
