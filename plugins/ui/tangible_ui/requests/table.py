"""The table of requests that the server answers, by name, filled by the decorator at each."""

from collections.abc import Awaitable, Callable
from typing import Any, TypeVar

# A request's function: called with the session, the tab, and the tab's arguments by name; its result is the answer.
Request = Callable[..., Awaitable[Any]]
R = TypeVar("R", bound=Request)

REQUESTS: dict[str, Request] = {}


def request(name: str = "") -> Callable[[R], R]:
    """Register a coroutine as a request of tabs, whose annotations are the types of arguments. Raises: ValueError."""

    def register(function: R) -> R:
        key = name or function.__name__
        if key in REQUESTS:
            raise ValueError(f"there are two requests named {key}")
        REQUESTS[key] = function
        return function

    return register


def find_request(name: str) -> Request:
    """Return a request of the table, or one that the worker answers or refuses: jobs are not imported here."""

    async def ask_worker(session: Any, tab: Any, /, **arguments: Any) -> Any:
        document = session.document.arguments()
        return await session.worker.quick("answer_page", request=name, arguments=arguments, **document)

    return REQUESTS.get(name, ask_worker)
