"""Routes of the server: the page, the arrays it draws, and its websocket; all but the page need the key."""

import asyncio
import secrets
from collections.abc import Awaitable, Callable, Coroutine
from pathlib import Path
from typing import Any, final

from starlette.applications import Starlette
from starlette.requests import ClientDisconnect, HTTPConnection, Request
from starlette.responses import FileResponse, PlainTextResponse, Response
from starlette.routing import BaseRoute, Mount, Route, WebSocketRoute
from starlette.types import ASGIApp
from starlette.websockets import WebSocket

from tangible_core.errors import TangibleError
from tangible_core.files import MAX_BYTES, in_words
from tangible_core.translation import translate
from tangible_web.address import static
from tangible_web.connection import show_key
from tangible_web.framing import RECORDING
from tangible_web.hand import Hand
from tangible_web.live import LiveTab
from tangible_web.parsing import Request as TabRequest
from tangible_web.server import ASK_AGAIN, BuiltPage, Guarded

from ..requests import feeling, find_request
from ..state.session import Session
from .translating import in_language, tab_language

FOREVER = "private, max-age=31536000, immutable"
WRONG_KEY = 4401
EXPORTS = "export-"  # prefix of the worker's folders of exported files
NOT_YOURS = "the key in the address is not this program's; open the address it printed"

# Query of a window: first row and number of rows, first column and number, columns of the file, bytes of an item.
WINDOW = frozenset({"row", "rows", "column", "columns", "of", "bytes"})
MAX_ITEMS = 4_000_000

Answer = Callable[[Request], Awaitable[Response]]


@final
class SessionProgram:
    """The program behind the page of `tangible ui`."""

    def __init__(self, session: Session) -> None:
        self.state: Session = session
        self.hand: Hand = session.feeling.hand

    def find_request(self, name: str, /) -> TabRequest:
        """Return what answers a request of this name: the server, or else the worker, which may refuse it."""
        return find_request(name)

    @property
    def running(self) -> bool:
        """True while forces are given."""
        return self.state.feeling.running

    def greeting(self) -> dict[str, Any]:
        """Return what happened before, the surface, and whether no file was opened yet."""
        session = self.state
        empty = session.waits_for_file and not session.document.text
        return {"history": session.tabs.history, "scene": session.tabs.scene, "empty": empty}

    def enter(self, tab: LiveTab) -> None:
        """Add a tab; it gets the hand if no other tab holds it."""
        self.state.tabs.enter(tab)

    def leave(self, tab: LiveTab) -> None:
        """Remove a tab; a hand that it held is released."""
        self.state.tabs.leave(tab)

    def holds(self, tab: LiveTab) -> bool:
        """Return True if this tab moves the hand."""
        return self.state.tabs.holder is tab

    def frame(self, seq: int, status: int) -> bytes | None:
        """Return the newest tick, with the force of a second law and whether ticks are recorded."""
        recorder = self.state.recorder
        recording = recorder is not None and recorder.recording
        return self.state.feeling.frame(seq, status | RECORDING * recording, self.state.laws.other_law())

    def begin(self, work: Coroutine[Any, Any, None]) -> None:
        """Run a coroutine in the background; its errors are sent to all tabs."""
        self.state.begin(work)

    def translate(self, event: dict[str, Any], language: str) -> dict[str, Any]:
        """Return an event in the language of a tab."""
        return in_language(event, tab_language(language))


def application(session: Callable[[], Session], key: str, hosts: frozenset[str], lifespan: Any) -> ASGIApp:
    """Return the server's ASGI app."""
    return Guarded(Starlette(routes=routes(session, key), lifespan=lifespan), hosts)


def routes(session: Callable[[], Session], key: str) -> list[BaseRoute]:
    """Return the routes; all but the built page need the key."""

    def has_key(connection: HTTPConnection) -> bool:
        has = secrets.compare_digest(connection.query_params.get("token", "").encode(), key.encode())
        if has:
            show_key(connection)
        return has

    def require_key(answer: Answer) -> Answer:
        async def check_key(request: Request) -> Response:
            return await answer(request) if has_key(request) else refusal(request, NOT_YOURS, 403)

        return check_key

    async def scene(request: Request) -> Response:
        digest, name = request.path_params["digest"], request.path_params["name"]
        path = None if digest.startswith(EXPORTS) else _lying(session().folder, digest, name)
        if path is None:
            return refusal(request, "this file is gone", 404)
        if request.query_params.keys() & WINDOW:
            return await send_window(path, request)
        return FileResponse(path, headers={"cache-control": FOREVER})

    async def opening(request: Request) -> Response:
        """Send the picture that was opened last, for a page that has no surface yet."""
        path = session().opening
        if path is None or not path.is_file():
            return refusal(request, "this file is gone", 404)
        return FileResponse(path, headers={"cache-control": "no-store"})

    async def export_file(request: Request) -> Response:
        """Send a file to keep; it is never shown as a page of this address, whatever it contains."""
        folder, name = request.path_params["folder"], request.path_params["name"]
        path = _lying(session().folder, folder, name) if folder.startswith(EXPORTS) else None
        if path is None:
            return refusal(request, "this file is not there any more; export it again", 404)
        return FileResponse(path, filename=name)

    async def panel_file(request: Request) -> Response:
        """Send an ES module, or another file, of a plugin's panel."""
        folder = session().panel_folders.get(request.path_params["panel"])
        path = None if folder is None else _lying(folder.parent, folder.name, request.path_params["name"])
        if path is None:
            return refusal(request, "no plugin brings this file", 404)
        return FileResponse(path, headers={"cache-control": ASK_AGAIN})

    async def send_window(path: Path, request: Request) -> Response:
        try:
            content = await asyncio.to_thread(
                read_window, path, {key: int(request.query_params[key]) for key in WINDOW}
            )
        except (KeyError, ValueError):
            return refusal(request, "there is no such window", 400)
        return Response(content, media_type="application/octet-stream", headers={"cache-control": FOREVER})

    async def upload(request: Request) -> Response:
        name = request.path_params["name"]
        length = request.headers.get("content-length", "0")
        if int(length) > MAX_BYTES:  # before the first byte is read
            return refusal(request, f"{name}: holds more than {in_words(MAX_BYTES)}; open a smaller one", 413)
        try:
            await session().uploads.put(request.path_params["batch"], name, request.stream())
        except TangibleError as error:
            return refusal(request, str(error), 400)
        except ClientDisconnect:
            return refusal(request, "the upload broke off", 400)
        return Response(status_code=204)

    async def stop(_: Request) -> Response:
        """Stop, for a page whose websocket does not answer."""
        await feeling.stop(session(), None)
        return Response(status_code=204)

    async def live(socket: WebSocket) -> None:
        if has_key(socket):
            await LiveTab(SessionProgram(session()), socket).live()
        else:  # only after an accept can a page tell a wrong key from a program that is gone
            await socket.accept()
            await socket.close(WRONG_KEY, NOT_YOURS)

    return [
        Route("/scene/{digest}/{name}", require_key(scene)),
        Route("/opening", require_key(opening)),
        Route("/export/{folder}/{name}", require_key(export_file)),
        Route("/panels/{panel}/{name}", require_key(panel_file)),
        Route("/upload/{batch}/{name}", require_key(upload), methods=["PUT"]),
        Route("/stop", require_key(stop), methods=["POST"]),
        WebSocketRoute("/live", live),
        Mount("/", BuiltPage(directory=static(), html=True)),
    ]


def refusal(request: Request, text: str, status: int) -> Response:
    """Return a sentence in the language of the tab that asked."""
    return PlainTextResponse(translate(text, tab_language(request.query_params.get("language", ""))), status)


def _lying(folder: Path, digest: str, name: str) -> Path | None:
    """Return a file in a folder of this one; None for a path that leads elsewhere, or an impossible name."""
    try:
        path = (folder / digest / name).resolve()
        return path if folder.resolve() in path.parents and path.is_file() else None
    except (OSError, ValueError):  # too long, or a NUL in it
        return None


def read_window(path: Path, query: dict[str, int]) -> bytes:
    """Return the rectangle, row by row. asked: a number for each of WINDOW. Raises: ValueError if it is not there."""
    row, rows, column, columns, of, size = (query[key] for key in ("row", "rows", "column", "columns", "of", "bytes"))
    inside = min(row, column) >= 0 and min(rows, columns, size) > 0 and column + columns <= of
    if not inside or rows * columns > MAX_ITEMS or (row + rows) * of * size > path.stat().st_size:
        raise ValueError("no such window")
    with path.open("rb") as file:
        parts: list[bytes] = []
        for line in range(row, row + rows):
            file.seek((line * of + column) * size)
            parts.append(file.read(columns * size))
    return b"".join(parts)
