"""Parsing of a tab's requests: a known name and valid arguments, or a sentence that says what is wrong."""

import json
<<<<<<< HEAD:plugins/web/tangible_web/parsing.py
from collections.abc import Awaitable, Callable, Mapping
from functools import cache
from typing import Any, NamedTuple, NoReturn, get_type_hints
=======
from typing import Any, NamedTuple, NoReturn
>>>>>>> 38328574 (ui: let a job for pages be the request itself):plugins/ui/tangible_ui/serving/parsing.py

from tangible_core.errors import ConfigError, TangibleError, quoted

<<<<<<< HEAD:plugins/web/tangible_web/parsing.py
from tangible_core.errors import TangibleError, did_you_mean, quoted, shown

Request = Callable[..., Awaitable[Any]]
"""A request's function: called with the program's state, the tab, and the tab's arguments by name."""
MOST_SHOWN = 200
=======
from ..requests import REQUESTS, Request, find_request
from ..worker.arguments import checked_arguments
>>>>>>> 38328574 (ui: let a job for pages be the request itself):plugins/ui/tangible_ui/serving/parsing.py


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
    told: dict[str, Any]


def parse(text: str, requests: Mapping[str, Request]) -> ParsedRequest:
    """Parse a message. requests: those that there are, by name. Raises: BadRequest."""
    try:
        said = json.loads(text, parse_constant=_refuse)
    except (ValueError, RecursionError) as error:
        raise BadRequest(None, "the message is not JSON") from error
    number = said.pop("number", None) if isinstance(said, dict) else None
    if type(number) is not int:
        raise BadRequest(None, 'the message is not a JSON object with a "number"')
    name = said.pop("ask", None)
<<<<<<< HEAD:plugins/web/tangible_web/parsing.py
    if not isinstance(name, str) or (ask := requests.get(name)) is None:
        hint = did_you_mean(name, requests) if isinstance(name, str) else ""
        raise BadRequest(number, f"there is no request {quoted(name)}{hint}")
    return ParsedRequest(number, name, ask, _fitting(number, name, ask, said))


def _fitting(number: int, name: str, ask: Request, said: dict[str, Any]) -> dict[str, Any]:
    """Return the arguments, validated by their types."""
    try:
        found = _arguments(ask).model_validate_json(json.dumps(said))
    except ValidationError as error:
        first = error.errors()[0]
        where = ".".join(map(str, first["loc"])) or "arguments"
        raise BadRequest(number, shown(f"{name}: {where}: {first['msg']}", MOST_SHOWN)) from error
    except RecursionError as error:
        raise BadRequest(number, f"{name}: the arguments are nested too deeply") from error
    return {key: getattr(found, key) for key in found.model_fields_set}


@cache
def _arguments(ask: Request) -> type[BaseModel]:
    """Return a model of the arguments that a request takes, and no others."""
    types = get_type_hints(ask)
    _, _, *rest = inspect.signature(ask).parameters.values()  # the state and the tab come first
    fields: dict[str, Any] = {
        each.name: (types[each.name], ... if each.default is each.empty else each.default) for each in rest
    }
    return create_model(ask.__name__, __config__=ConfigDict(extra="forbid", strict=True), **fields)
=======
    if not isinstance(name, str):
        raise BadRequest(number, f"there is no request {quoted(name)}")
    if name not in REQUESTS:  # one that the worker answers, which checks its arguments
        return ParsedRequest(number, name, find_request(name), said)
    try:
        return ParsedRequest(number, name, REQUESTS[name], checked_arguments(name, REQUESTS[name], 2, said))
    except ConfigError as error:
        raise BadRequest(number, str(error)) from error
>>>>>>> 38328574 (ui: let a job for pages be the request itself):plugins/ui/tangible_ui/serving/parsing.py


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is not JSON")
