"""What the server answers: the page, the arrays it draws, and its websocket; to this machine and to who has the key."""

import asyncio
import secrets
from collections.abc import Awaitable, Callable
from importlib.resources import files
from pathlib import Path

from starlette.applications import Starlette
from starlette.middleware import Middleware
from starlette.requests import ClientDisconnect, HTTPConnection, Request
from starlette.responses import FileResponse, PlainTextResponse, Response
from starlette.routing import Mount, Route, WebSocketRoute
from starlette.staticfiles import StaticFiles
from starlette.types import ASGIApp, Message, Receive, Scope, Send
from starlette.websockets import WebSocket

from tangible_core.errors import TangibleError

from .desk import Desk
from .live import LiveTab
from .windows import WINDOW, read_window

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
FOREVER = "private, max-age=31536000, immutable"
WRONG_ORIGIN, WRONG_KEY = 4403, 4401


class Guarded:
    """Answers none but this machine's own page: the name it is called by is this machine's, the headers are strict."""

    def __init__(self, app: ASGIApp, hosts: frozenset[str]) -> None:
        self._app, self._hosts = app, hosts

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """A page elsewhere whose name was made to lead here (DNS rebinding) says its own name as host."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return
        if HTTPConnection(scope).headers.get("host", "") not in self._hosts:
            await PlainTextResponse("this address is not served", 403)(scope, receive, send)
            return

        async def with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                extra = [(name.encode(), value.encode()) for name, value in HEADERS.items()]
                message = {**message, "headers": [*message["headers"], *extra]}
            await send(message)

        await self._app(scope, receive, with_headers)


def application(
    desk: Callable[[], Desk], key: str, hosts: frozenset[str], lifespan: Callable[..., object]
) -> Starlette:
    """The routes. Everything but the built page needs the key."""

    def has_key(connection: HTTPConnection) -> bool:
        return secrets.compare_digest(connection.query_params.get("token", "").encode(), key.encode())

    def keyed(answer: Callable[[Request], Awaitable[Response]]) -> Callable[[Request], Awaitable[Response]]:
        async def checked(request: Request) -> Response:
            if not has_key(request):
                return PlainTextResponse(
                    "the key in the address is not this program's; open the address it printed", 403
                )
            return await answer(request)

        return checked

    async def scene(request: Request) -> Response:
        folder = desk().folder
        path = (folder / request.path_params["digest"] / request.path_params["name"]).resolve()
        if folder.resolve() not in path.parents or not path.is_file():
            return PlainTextResponse("there is no such thing any more", 404)
        if request.query_params.keys() & WINDOW:
            return await window_of(path, request)
        return FileResponse(path, headers={"cache-control": FOREVER})

    async def window_of(path: Path, request: Request) -> Response:
        try:
            found = await asyncio.to_thread(read_window, path, {key: int(request.query_params[key]) for key in WINDOW})
        except (KeyError, ValueError):
            return PlainTextResponse("there is no such window", 400)
        return Response(found, media_type="application/octet-stream", headers={"cache-control": FOREVER})

    async def upload(request: Request) -> Response:
        try:
            await desk().shelf.put(request.path_params["batch"], request.path_params["name"], request.stream())
        except TangibleError as error:
            return PlainTextResponse(str(error), 400)
        except ClientDisconnect:
            return PlainTextResponse("it broke off", 400)
        return Response(status_code=204)

    async def live(socket: WebSocket) -> None:
        if socket.headers.get("origin", "") != f"http://{socket.headers.get('host', '')}":
            await socket.close(WRONG_ORIGIN)
        elif not has_key(socket):
            await socket.close(WRONG_KEY)
        else:
            await LiveTab(desk(), socket).live()

    routes = [
        Route("/scene/{digest}/{name}", keyed(scene)),
        Route("/upload/{batch}/{name}", keyed(upload), methods=["PUT"]),
        WebSocketRoute("/live", live),
        Mount("/", StaticFiles(directory=static(), html=True)),
    ]
    return Starlette(routes=routes, middleware=[Middleware(Guarded, hosts=hosts)], lifespan=lifespan)  # pyright: ignore


def static() -> Path:
    """Where the built page lies, if it was built."""
    return Path(str(files("tangible_ui"))) / "static"
