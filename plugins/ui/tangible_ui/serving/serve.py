"""Start and end of `tangible ui`."""

import asyncio
import gc
import logging
import signal
import threading
import time
from collections.abc import AsyncGenerator, Callable, Generator
from concurrent.futures import ThreadPoolExecutor
from contextlib import asynccontextmanager, contextmanager
from functools import partial
from pathlib import Path
from types import FrameType
from typing import Any, final

import uvicorn

from tangible_core.runtime import ENDING
from tangible_web.address import Address
from tangible_web.hand import KEEP_S
from tangible_web.server import settings

from ..feeling.feeling import Feeling
from ..logs import silence, tell_pages
from ..requests import document
from ..stale_files import channel_of_this_process, folder_of_this_process
from ..state.session import Session
from .routes import application

log: logging.Logger = logging.getLogger(__name__)
# Threads for waiting calls: a disk, a pipe, a loop that ends. Such a call must not wait for another one of them.
THREADS = 32

LATEST_START_S = 2.0  # longest wait for a first scene before the loop starts, s


def serve(files: list[Path], sets: list[str], address: Address) -> None:
    """Serve until Ctrl-C. Raises: OutputError if no temporary folder can be made."""
    with folder_of_this_process() as folder, channel_of_this_process() as channel:
        lifetime = Served(folder, channel, files, sets)
        app = application(lambda: lifetime.session, address.key, address.hosts, lifetime.lifespan)
        server = Server(settings(app), lifetime.asked_to_end)
        server.run(sockets=[address.listening])
    if lifetime.failure is not None:
        raise lifetime.failure
    for number in server.signals[:1]:
        signal.raise_signal(number)


@final
class Server(uvicorn.Server):
    """A server that first takes the force away on a signal; then it ends as programs do on that signal."""

    def __init__(self, config: uvicorn.Config, asked_to_end: Callable[[], None]) -> None:
        super().__init__(config)
        self.signals: list[int] = []
        self._asked_to_end = asked_to_end

    @contextmanager
    def capture_signals(self) -> Generator[None]:
        """Handle the signals that were not ignored before, as by nohup."""
        here = threading.current_thread() is threading.main_thread()
        before = {number: signal.getsignal(number) for number in (signal.SIGINT, *ENDING) if here}
        mine = {number: handler for number, handler in before.items() if handler != signal.SIG_IGN}
        for number in mine:
            signal.signal(number, self.handle_exit)
        try:
            yield
        finally:
            for number, handler in mine.items():
                signal.signal(number, handler)

    def handle_exit(self, sig: int, frame: FrameType | None) -> None:
        """Take the force away, and end; a second Ctrl-C does not wait."""
        self.signals.append(sig)
        self._asked_to_end()
        super().handle_exit(sig, frame)


@final
class Served:
    """The session, for as long as the server lives."""

    def __init__(self, folder: Path, channel: str, files: list[Path], sets: list[str]) -> None:
        self._folder, self._channel, self._files, self._sets = folder, channel, files, sets
        self._session: Session | None = None
        self.failure: Exception | None = None
        """The error that kept it from starting."""

    @property
    def session(self) -> Session:
        """The session, which exists from the start on."""
        assert self._session is not None
        return self._session

    def asked_to_end(self) -> None:
        """Take the force away at once; the rest ends later."""
        if self._session is not None:
            self._session.feeling.cut()

    @asynccontextmanager
    async def lifespan(self, _: Any) -> AsyncGenerator[None]:
        """Start slow things at once; at the end leave no force, no process and no file."""
        loop = asyncio.get_running_loop()
        loop.set_default_executor(ThreadPoolExecutor(THREADS))
        try:
            self._session = session = Session(self._folder, Feeling(self._channel), self._sets)
        except Exception as error:
            self.failure = error
            raise

        def tell(**payload: str) -> None:
            loop.call_soon_threadsafe(partial(session.tabs.tell, "log", **payload))

        telling = tell_pages(tell)
        loop.set_exception_handler(partial(_unforeseen, session))
        session.begin(watch(session))
        session.begin(document.offer(session))
        session.waits_for_file = not self._files
        if self._files:
            session.begin(document.begin(session, None, [str(file) for file in self._files]))
        session.begin(_start(session))
        gc.freeze()  # the collector skips what was imported
        try:
            yield
        finally:
            silence(telling)
            await session.close()


def _unforeseen(session: Session, _: asyncio.AbstractEventLoop, context: dict[str, Any]) -> None:
    """Report an error that asyncio found in a task that nobody waited for."""
    session.report_failure(context.get("exception") or RuntimeError(context["message"]))


async def _start(session: Session) -> None:
    """Start the loop when the surface is on its way to the screen, or late: both need the whole processor."""
    until_s = time.monotonic() + LATEST_START_S
    while session.tabs.scene is None and time.monotonic() < until_s:
        await asyncio.sleep(0.02)
    await asyncio.to_thread(session.feeling.start)


async def watch(session: Session) -> None:
    """Poll the loop until the server ends: keep the hand, move that of a compared law, report ends."""
    while True:
        session.feeling.hand.keep()
        session.laws.follow(session.feeling)
        if why := session.feeling.beacon_over():
            session.tabs.tell("beacon", part=None, name="", why=why)
        if (end := session.feeling.loop_end()) is not None:
            session.tabs.tell("loop", running=False, why=end.why, lost=end.is_lost)
        if why := session.laws.comparison.loop_end():
            shown_name = session.laws.names[1 - session.laws.acting]
            log.warning("%s is no longer computed beside the law that is felt: %s", shown_name, why)
        await asyncio.sleep(KEEP_S)
