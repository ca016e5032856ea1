"""The web server of a page: who is let in, its limits, its files, and a thread for a program that has other work."""

import asyncio
from collections.abc import AsyncGenerator, Callable, Sequence
from contextlib import asynccontextmanager
from functools import partial
from threading import Event, Thread
from typing import Any, Self, TypeVar, final

import uvicorn
from starlette.applications import Starlette
from starlette.requests import HTTPConnection
from starlette.responses import PlainTextResponse, Response
from starlette.routing import BaseRoute
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Message, Receive, Scope, Send

from .address import Address
from .connection import PING_S, Connection, Exchange, Strangers
from .hand import KEEP_S, Hand

# Cache rule: a browser may keep the file, and asks each time if it is still current.
ASK_AGAIN = "no-cache"
MAX_MESSAGE_BYTES = 2**20  # size limit of a message, bytes; pipeline files are smaller
T = TypeVar("T")


def settings(app: ASGIApp, log_level: str = "warning") -> uvicorn.Config:
    """Return settings with which nobody can block the server, fill its memory, or find the key in a log."""
    strangers = Strangers()
    http: Any = partial(Exchange, strangers)
    sockets: Any = partial(Connection, strangers)
    return uvicorn.Config(
        app, log_level=log_level, access_log=False, server_header=False, loop="asyncio", http=http, lifespan="on",
        ws=sockets, ws_per_message_deflate=False, ws_max_size=MAX_MESSAGE_BYTES,
        ws_ping_interval=PING_S, ws_ping_timeout=PING_S,
        timeout_graceful_shutdown=1,
    )  # fmt: skip


POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; "
    "media-src 'self' blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
HEADERS = {
    "content-security-policy": POLICY,
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
}
NEVER = "no-store"
READING = ("GET", "HEAD")


class Guarded:
    """An ASGI app that refuses foreign hosts and origins, and adds strict headers to every answer."""

    def __init__(self, app: ASGIApp, hosts: frozenset[str]) -> None:
        """hosts: all names of this server, with the port, in small letters."""
        self._app, self._hosts = app, hosts

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request; errors have the headers too."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return

        async def with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                message = {**message, "headers": _strict(message["headers"])}
            await send(message)

        headers = HTTPConnection(scope).headers
        why = refusal_text(self._hosts, scope.get("method", ""), headers.get("host"), headers.get("origin"))
        if not why:
            await self._app(scope, receive, with_headers)
        elif scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008})
        else:
            await PlainTextResponse(why, 403)(scope, receive, with_headers)


def refusal_text(hosts: frozenset[str], method: str, host: str | None, origin: str | None) -> str:
    """Return why a request is refused, "" if it is not. hosts: names of the server. method: "" for a websocket."""
    if (host or "").lower() not in hosts:
        return "this address is not served"
    if method not in READING and (origin or "").lower() not in {f"http://{name}" for name in hosts}:
        return "another page may not do that"
    return ""


def _strict(headers: list[tuple[bytes, bytes]]) -> list[tuple[bytes, bytes]]:
    has_rule = any(name.lower() == b"cache-control" for name, _ in headers)
    extra = HEADERS if has_rule else {**HEADERS, "cache-control": NEVER}
    return [*headers, *((name.encode(), value.encode()) for name, value in extra.items())]


class BuiltPage(StaticFiles):
    """The pages' own files; a new build is used at the next load."""

    def file_response(self, *args: Any, **options: Any) -> Response:
        """Return the file with its ETag, which the browser must send each time."""
        response = super().file_response(*args, **options)
        response.headers["cache-control"] = ASK_AGAIN
        return response


@final
class ServerThread:
    """A server in a thread, as a context manager; the hand that its page moves is released at the end."""

    def __init__(self, routes: Sequence[BaseRoute], address: Address, hand: Hand) -> None:
        app = Guarded(Starlette(routes=routes, lifespan=self._lifespan), address.hosts)
        self._server, self._hand, self._ready = uvicorn.Server(settings(app, "error")), hand, Event()
        self._thread = Thread(target=self._server.run, kwargs={"sockets": [address.listening]}, daemon=True)

    def __enter__(self) -> Self:
        self._thread.start()
        self._ready.wait()
        return self

    def __exit__(self, *_: object) -> None:
        self._server.should_exit = True
        self._thread.join()

    def call(self, work: Callable[[], T]) -> T:
        """Call a function in the server's thread, and return its result."""

        async def there() -> T:
            return work()

        return asyncio.run_coroutine_threadsafe(there(), self._loop).result()

    def post(self, work: Callable[[], object]) -> None:
        """Call a function in the server's thread, soon, after those that were posted before."""
        self._loop.call_soon_threadsafe(work)

    @asynccontextmanager
    async def _lifespan(self, _: Any) -> AsyncGenerator[None]:
        self._loop = asyncio.get_running_loop()
        keeping = asyncio.ensure_future(self._keep())
        self._ready.set()
        yield
        keeping.cancel()
        self._hand.release()

    async def _keep(self) -> None:
        while True:
            self._hand.keep()
            await asyncio.sleep(KEEP_S)
