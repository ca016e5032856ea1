"""The table of all requests by name, filled by the decorator at each, or by `forward`."""

from collections.abc import Awaitable, Callable
from inspect import Parameter, Signature
from typing import Any, TypeVar

Request = Callable[..., Awaitable[Any]]
"""A request's function: called with the session, the tab, and the tab's arguments by name; its result is the answer."""
R = TypeVar("R", bound=Request)

REQUESTS: dict[str, Request] = {}


def request(name: str = "") -> Callable[[R], R]:
    """Register a coroutine function as a request that tabs may send.

    Its annotations are the types that arguments must have. name: of the request, where it is not the function's own.
    Raises: ValueError if there is a request of this name.
    """

    def register(function: R) -> R:
        key = name or function.__name__
        if key in REQUESTS:
            raise ValueError(f"there are two requests named {key}")
        REQUESTS[key] = function
        return function

    return register


def forward(job: str, *, document: bool = False, **types: Any) -> None:
    """Register the worker's quick job of this name as a request.

    document: the job takes the document too. types: of the tab's arguments; those with a default are a tuple of both.
    """

    async def ask(session: Any, tab: Any, **arguments: Any) -> Any:
        return await session.worker.quick(job, **(session.document() if document else {}), **arguments)

    ask.__name__ = job
    ask.__annotations__ = {name: kind[0] if isinstance(kind, tuple) else kind for name, kind in types.items()}
    defaults = {name: kind[1] for name, kind in types.items() if isinstance(kind, tuple)}
    parameters = [Parameter(name, Parameter.POSITIONAL_OR_KEYWORD) for name in ("session", "tab")]
    parameters += [
        Parameter(name, Parameter.KEYWORD_ONLY, default=defaults.get(name, Parameter.empty)) for name in types
    ]
    ask.__dict__["__signature__"] = Signature(parameters)
    request()(ask)
