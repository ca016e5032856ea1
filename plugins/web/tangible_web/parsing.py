"""Parsing of a tab's requests: a known name and valid arguments, or a sentence that says what is wrong."""

import inspect
import json
from collections.abc import Awaitable, Callable
from functools import cache
from typing import Any, NamedTuple, NoReturn, get_type_hints

from pydantic import BaseModel, ConfigDict, ValidationError, create_model

from tangible_core.errors import ConfigError, TangibleError, quoted, shown

# A request's function: called with the program's state, the tab, and the tab's arguments by name.
Request = Callable[..., Awaitable[Any]]
FindRequest = Callable[[str], Request | None]  # a finder of requests by name; None if there is none


class BadRequest(TangibleError):
    """A message that is not a valid request."""

    def __init__(self, number: int | None, text: str) -> None:
        super().__init__(text)
        self.number = number
        """Number under which the tab waits for the answer; None if it gave none."""


class ParsedRequest(NamedTuple):
    """A valid request of a tab."""

    number: int
    name: str
    ask: Request
    arguments: dict[str, Any]


def parse(text: str, find: FindRequest) -> ParsedRequest:
    """Parse a message. Raises: BadRequest."""
    try:
        message = json.loads(text, parse_constant=_refuse)
    except (ValueError, RecursionError) as error:
        raise BadRequest(None, "the message is not JSON") from error
    number = message.pop("number", None) if isinstance(message, dict) else None
    if type(number) is not int:
        raise BadRequest(None, 'the message is not a JSON object with a "number"')
    name = message.pop("ask", None)
    if not isinstance(name, str) or (ask := find(name)) is None:
        raise BadRequest(number, f"there is no request {quoted(name)}")
    try:
        return ParsedRequest(number, name, ask, checked_arguments(name, ask, 2, message))
    except ConfigError as error:
        raise BadRequest(number, str(error)) from error


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is not JSON")


MAX_SHOWN = 200


def checked_arguments(name: str, answer: Callable[..., Any], own: int, arguments: dict[str, Any]) -> dict[str, Any]:
    """Return a page's arguments of a function, without its `own` first, checked by type. Raises: ConfigError."""
    if any(parameter.kind is parameter.VAR_KEYWORD for parameter in inspect.signature(answer).parameters.values()):
        return arguments  # it checks them itself
    try:
        values = _model(answer, own).model_validate_json(json.dumps(arguments))
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"])) or "arguments"
        raise ConfigError(shown(f"{name}: {where}: {first['msg']}", MAX_SHOWN)) from error
    except RecursionError as error:
        raise ConfigError(f"{name}: the arguments are nested too deeply") from error
    return {key: getattr(values, key) for key in values.model_fields_set}


@cache
def _model(answer: Callable[..., Any], own: int) -> type[BaseModel]:
    """Return a model of the arguments after the first `own`, and no others."""
    types = get_type_hints(answer)
    rest = list(inspect.signature(answer).parameters.values())[own:]
    fields: dict[str, Any] = {
        parameter.name: (types[parameter.name], ... if parameter.default is parameter.empty else parameter.default)
        for parameter in rest
    }
    return create_model(answer.__name__, __config__=ConfigDict(extra="forbid", strict=True), **fields)
