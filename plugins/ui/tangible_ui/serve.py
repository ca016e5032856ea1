"""`tangible ui` at work: the socket, the key, the start and the end."""

import asyncio
import gc
import os
import secrets
import socket
import tempfile
import webbrowser
from collections.abc import AsyncGenerator
from contextlib import asynccontextmanager
from functools import partial
from pathlib import Path
from typing import Any

import uvicorn

from tangible_core.errors import ConfigError

from .asks import document
from .desk import Desk
from .feeling import Feeling
from .logs import silence, tell_pages
from .routes import application, static
from .watching import watch

HOST = "127.0.0.1"
EXAMPLE = Path("builtin/motorcycle")


def serve(files: list[Path], sets: list[str], port: int, browser: bool) -> None:
    """Until Ctrl-C. Raises: ConfigError if the page was not built, or the port is taken."""
    if not (static() / "app.js").is_file():
        raise ConfigError(
            "the page was not built when this was installed, as npm could not be reached; install again where it can "
            "(`pip install --force-reinstall --no-deps .`), or build it: `npm ci && npm run build` in plugins/ui/web"
        )
    key = os.environ.get("TANGIBLE_UI_TOKEN") or secrets.token_urlsafe(16)
    listening = _listening(port)
    number = listening.getsockname()[1]
    url = f"http://{HOST}:{number}/?token={key}"
    hosts = frozenset({f"{HOST}:{number}", f"localhost:{number}"})
    with tempfile.TemporaryDirectory(prefix="tangible-ui-") as folder:
        served = _Served(Path(folder), files or [EXAMPLE], sets)
        app = application(lambda: served.desk, key, hosts, served.lifespan)
        print(url, flush=True)  # noqa: T201 - what the command is called for
        if browser:
            webbrowser.open(url)
        settings = uvicorn.Config(
            app, log_level="warning", ws="websockets-sansio", ws_per_message_deflate=False, ws_max_size=2**20,
            loop="asyncio", lifespan="on", timeout_graceful_shutdown=1,
        )  # fmt: skip
        uvicorn.Server(settings).run(sockets=[listening])


def _listening(port: int) -> socket.socket:
    try:
        return socket.create_server((HOST, port))
    except OSError as error:
        raise ConfigError(f"--port {port}: {error.strerror or error}; 0 takes a free one") from error


class _Served:
    """What lives as long as the server."""

    desk: Desk

    def __init__(self, folder: Path, files: list[Path], sets: list[str]) -> None:
        self._folder, self._files, self._sets = folder, files, sets

    @asynccontextmanager
    async def lifespan(self, _: Any) -> AsyncGenerator[None]:
        """Start what takes long at once; at the end leave no force, no process and no file."""
        self.desk = desk = Desk(self._folder, Feeling(f"ui-{os.getpid()}"), self._sets)
        loop = asyncio.get_running_loop()

        def tell(**told: str) -> None:
            loop.call_soon_threadsafe(partial(desk.tell, "log", **told))

        telling = tell_pages(tell)
        desk.begin(document.begin(desk, None, [str(each) for each in self._files]))
        desk.begin(asyncio.to_thread(desk.feeling.start))
        desk.begin(watch(desk))
        gc.freeze()  # what was imported is never looked through again
        yield
        silence(telling)
        await desk.close()
