"""The maker from outside: ask it, hear it, kill it."""

import asyncio
import itertools
import subprocess
import threading
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, final

from tangible_core.errors import TangibleError
from tangible_core.runtime.child_process import command
from tangible_core.servo.wire import receive, send

from .messages import Answer, Ask, Event, Refused


class MakingStopped(TangibleError):
    """The maker was killed while it worked."""


@final
class Maker:
    """A process that does jobs. One that is killed is followed by another; what waited for it gets MakingStopped."""

    def __init__(self, folder: Path, hear: Callable[[Event], None]) -> None:
        """folder: where it leaves what pages fetch. hear: called in the event loop's thread for each event."""
        self._folder, self._hear = folder, hear
        self._numbers = itertools.count(1)
        self._waiting: dict[int, asyncio.Future[Any]] = {}
        self._loop = asyncio.get_running_loop()
        self._process: subprocess.Popen[bytes] | None = None
        self._closed = False
        self._lock = threading.Lock()
        self._start()

    @property
    def busy(self) -> bool:
        """Whether anybody waits for a job."""
        return bool(self._waiting)

    async def ask(self, job: str, **told: Any) -> Any:
        """Do a job, and return what it made.

        Raises: MakingStopped if the maker was killed meanwhile, and whatever the job raises.
        """
        number, future = next(self._numbers), self._loop.create_future()
        self._waiting[number] = future
        try:
            await asyncio.to_thread(self._send, Ask(number, job, told))
            return await future
        finally:
            self._waiting.pop(number, None)

    def kill(self) -> None:
        """End whatever it does; another one takes its place."""
        if self._process is not None:
            self._process.kill()

    def close(self) -> None:
        """End it for good."""
        self._closed = True
        self.kill()

    def _start(self) -> None:
        words = command("tangible_ui.maker.process")
        self._process = process = subprocess.Popen(words, stdin=subprocess.PIPE, stdout=subprocess.PIPE)
        self._send(self._folder)
        threading.Thread(target=self._listen, args=(process,), daemon=True).start()

    def _send(self, message: Any) -> None:
        with self._lock, suppress(OSError, ValueError):  # it was killed: whoever waits hears of it
            assert self._process is not None and self._process.stdin is not None
            send(self._process.stdin, message)

    def _listen(self, process: subprocess.Popen[bytes]) -> None:
        assert process.stdout is not None and process.stdin is not None
        with process.stdout as replies, suppress(Exception):
            while (message := receive(replies)) is not None:
                self._loop.call_soon_threadsafe(self._take, message)
        process.wait()
        with suppress(OSError):
            process.stdin.close()
        with suppress(RuntimeError):  # the server ended
            self._loop.call_soon_threadsafe(self._lost)

    def _take(self, message: Answer | Refused | Event) -> None:
        if isinstance(message, Event):
            self._hear(message)
            return
        future = self._waiting.get(message.number)
        if future is None or future.done():
            return
        if isinstance(message, Refused):
            future.set_exception(message.error)
        else:
            future.set_result(message.value)

    def _lost(self) -> None:
        if self._closed:
            return
        self._start()
        for future in self._waiting.values():
            if not future.done():
                future.set_exception(MakingStopped("making was stopped; what was finished is kept"))
