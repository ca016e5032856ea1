"""Parsing of a tab's requests: a known name and valid arguments, or a sentence that says what is wrong."""

import json
from collections.abc import Awaitable, Callable
from typing import Any, NamedTuple, NoReturn

from tangible_core.errors import ConfigError, TangibleError, quoted

from .arguments import checked_arguments

Request = Callable[..., Awaitable[Any]]
"""A request's function: called with the program's state, the tab, and the tab's arguments by name."""
FindRequest = Callable[[str], Request | None]
"""What finds a request by its name; None if there is none."""


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


def parse(text: str, find: FindRequest) -> ParsedRequest:
    """Parse a message. Raises: BadRequest."""
    try:
        said = json.loads(text, parse_constant=_refuse)
    except (ValueError, RecursionError) as error:
        raise BadRequest(None, "the message is not JSON") from error
    number = said.pop("number", None) if isinstance(said, dict) else None
    if type(number) is not int:
        raise BadRequest(None, 'the message is not a JSON object with a "number"')
    name = said.pop("ask", None)
    if not isinstance(name, str) or (ask := find(name)) is None:
        raise BadRequest(number, f"there is no request {quoted(name)}")
    try:
        return ParsedRequest(number, name, ask, checked_arguments(name, ask, 2, said))
    except ConfigError as error:
        raise BadRequest(number, str(error)) from error


def _refuse(constant: str) -> NoReturn:
    raise ValueError(f"{constant} is not JSON")
