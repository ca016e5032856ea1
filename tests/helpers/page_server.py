"""The page's server in this process, in a thread of its own, without a worker and at first without a loop."""

import asyncio
import http.client
import json
import threading
import time
from collections.abc import AsyncGenerator, Callable
from contextlib import AbstractContextManager, ExitStack, asynccontextmanager
from pathlib import Path
from typing import Any, Self

from websockets.exceptions import ConnectionClosed
from websockets.sync.client import ClientConnection, connect

from tangible_ui.feeling.feeling import Feeling
from tangible_ui.serving.routes import application
from tangible_ui.serving.serve import Server, watch
from tangible_ui.state.session import Session
from tangible_web.address import HOST, Address
from tangible_web.framing import BEAT_FRAME
from tangible_web.server import settings
from waiting import LONGEST_S

KEY = "key-of-a-test-0123456789"


class NoWorker:
    """A worker that does no job."""

    def __init__(self, folder: Path, hear: Callable[[Any], None]) -> None:
        self.asked: list[str] = []
        self.wait: asyncio.Event | None = None

    async def ask(self, job: str, **told: Any) -> Any:
        self.asked.append(job)
        if self.wait is not None:
            await self.wait.wait()
        return {}

    quick = ask

    def kill(self) -> None:
        """Do nothing."""

    def close(self) -> None:
        """Do nothing."""


class PageServer:
    """A server that listens in its `with` block."""

    def __init__(self, folder: Path, monkeypatch: Any) -> None:
        monkeypatch.setattr("tangible_ui.state.session.Worker", NoWorker)
        self.folder = folder / "drawn"
        self.folder.mkdir()
        self.complaints: list[dict[str, Any]] = []
        self._ready = threading.Event()
        self._thread = threading.Thread(target=self._serve)

    def _serve(self) -> None:
        with Address.of(0) as address:
            self.port = address.port
            self.host = f"{HOST}:{self.port}"
            app = application(lambda: self.session, KEY, address.hosts, self._lifespan)
            self.server = Server(settings(app), lambda: None)
            self.server.run(sockets=[address.listening])

    @asynccontextmanager
    async def _lifespan(self, _: Any) -> AsyncGenerator[None]:
        self.loop = asyncio.get_running_loop()
        self.loop.set_exception_handler(lambda _, context: self.complaints.append(context))
        self.session = Session(self.folder, Feeling("ui-test"), [])
        self.session.begin(watch(self.session))
        self._ready.set()
        yield
        await self.session.close()

    def __enter__(self) -> Self:
        self._thread.start()
        assert self._ready.wait(LONGEST_S)
        return self

    def __exit__(self, *_: object) -> None:
        self.server.should_exit = True
        self._thread.join(LONGEST_S)
        assert not self._thread.is_alive()
        assert not self.complaints, self.complaints

    def done(self, work: Callable[[], Any]) -> Any:
        """Do something in the server's own thread."""

        async def there() -> Any:
            return work()

        return asyncio.run_coroutine_threadsafe(there(), self.loop).result(LONGEST_S)

    def ask(
        self, path: str, method: str = "GET", body: bytes | None = None, **headers: str | None
    ) -> http.client.HTTPResponse:
        """Send a request; headers are named with underscores, None omits one. The answer's text is its `text`."""
        said = {"host": self.host, "origin": f"http://{self.host}" if method not in ("GET", "HEAD") else None}
        said |= {name.replace("_", "-"): value for name, value in headers.items()}
        connection = http.client.HTTPConnection(HOST, self.port, timeout=LONGEST_S)
        connection.putrequest(method, path, skip_host=True, skip_accept_encoding=True)
        for name, value in said.items():
            if value is not None:
                connection.putheader(name, value)
        if body is not None and "content_length" not in headers:
            connection.putheader("content-length", str(len(body)))
        connection.endheaders(body)
        response = connection.getresponse()
        response.text = response.read().decode()  # type: ignore[attr-defined]
        connection.close()
        return response

    def tab(self, key: str = KEY, origin: str | None = "", **options: Any) -> "TestTab":
        """A page's websocket, which must be let in."""
        own = f"http://{self.host}" if origin == "" else origin
        url = f"ws://{self.host}/live?token={key}"
        return TestTab(connect(url, origin=own, compression=None, max_size=None, proxy=None, **options))  # type: ignore[arg-type]


class TestTab:
    """A tab's websocket."""

    __test__ = False

    def __init__(self, connecting: AbstractContextManager[ClientConnection]) -> None:
        self._open = ExitStack()
        self.socket = self._open.enter_context(connecting)
        self.frames = 0
        self._number = 0

    def ask(self, name: Any, **told: Any) -> int:
        """Send a request without waiting for the answer; return its number."""
        self._number += 1
        self.socket.send(json.dumps({"number": self._number, "ask": name, **told}))
        return self._number

    def next(self, timeout: float = LONGEST_S) -> dict[str, Any] | None:
        """The next event; frames are counted. None if there is none in time. Raises: ConnectionClosed."""
        until_s = time.monotonic() + timeout
        try:
            while isinstance(said := self.socket.recv(max(0.0, until_s - time.monotonic())), bytes):
                self.frames += said != BEAT_FRAME
        except TimeoutError:
            return None
        return json.loads(said)

    def until(self, **wanted: Any) -> dict[str, Any]:
        """The next event that has these values."""
        while (said := self.next()) is not None:
            if all(said.get(key) == value for key, value in wanted.items()):
                return said
        raise AssertionError(f"no {wanted}")

    def closed(self) -> int:
        """The code with which it is closed."""
        try:
            while True:
                self.socket.recv(LONGEST_S)
        except ConnectionClosed as error:
            return error.rcvd.code if error.rcvd else 1006

    def close(self) -> None:
        self._open.close()

    def __enter__(self) -> Self:
        return self

    def __exit__(self, *_: object) -> None:
        self.close()
