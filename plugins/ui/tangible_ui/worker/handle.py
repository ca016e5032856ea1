"""The server's handle of the worker: request jobs, receive events, kill it, start it again."""

import asyncio
import itertools
import subprocess
import sys
import threading
from collections import deque
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any, final

from tangible_core.errors import TangibleError, shown
from tangible_core.servo import receive, send

from ..prestart import take_worker_process
from .messages import Event, JobFailure, JobRequest, JobResult

# Failed starts in a row after which the worker is given up until `try_again`.
MAX_DEATHS = 3


class WorkerKilled(TangibleError):
    """The worker was killed during the job."""


class WorkerAbsent(TangibleError):
    """The worker does not start."""


@final
class Worker:
    """A process that does jobs; a killed one is replaced, one that does not start three times is given up."""

    def __init__(self, folder: Path, hear: Callable[[Event], None]) -> None:
        """folder: for what pages fetch. hear: called in the event loop's thread for each event."""
        self._folder, self._hear = folder, hear
        self._numbers = itertools.count(1)
        self._waiting: dict[int, asyncio.Future[Any]] = {}
        self._loop = asyncio.get_running_loop()
        self._process: subprocess.Popen[bytes] | None = None
        self._is_closed = False
        self._ready = self._was_killed = False
        self._deaths, self._failure = 0, ""
        self._last_words: deque[str] = deque(maxlen=1)
        self._lock = threading.Lock()
        self._start()

    async def ask(self, job: str, **arguments: Any) -> Any:
        """Do a job, and return its result. Raises: WorkerKilled, WorkerAbsent, whatever the job raises."""
        if self._failure:
            raise WorkerAbsent(self._failure)
        number, future = next(self._numbers), self._loop.create_future()
        self._waiting[number] = future
        try:
            await asyncio.to_thread(self._send, JobRequest(number, job, arguments))
            return await future
        finally:
            self._waiting.pop(number, None)

    async def quick(self, job: str, **arguments: Any) -> Any:
        """Do a quick job; once more if the worker was killed for the sake of a long one. Raises: as `ask`."""
        try:
            return await self.ask(job, **arguments)
        except WorkerKilled:
            return await self.ask(job, **arguments)

    def kill(self) -> None:
        """Kill the process; another one replaces it."""
        self._was_killed = True
        if self._process is not None:
            self._process.kill()

    def close(self) -> None:
        """Kill the process for good."""
        self._is_closed = True
        self.kill()

    def try_again(self) -> None:
        """Start the worker if it was given up."""
        if self._failure:
            self._failure, self._deaths = "", 0
            self._start()

    def _start(self) -> None:
        self._ready = self._was_killed = False
        self._process = process = take_worker_process()
        self._send(self._folder)
        reading = threading.Thread(target=self._read, args=(process,), daemon=True)
        reading.start()
        threading.Thread(target=self._listen, args=(process, reading), daemon=True).start()

    def _read(self, process: subprocess.Popen[bytes]) -> None:
        """Print the process's standard error, and keep its last line, which tells why it ended."""
        assert process.stderr is not None
        with process.stderr as lines, suppress(OSError, ValueError):
            for line in lines:
                text = line.decode(errors="replace")
                self._last_words.append(text.strip())
                sys.stderr.write(text)

    def _send(self, message: Any) -> None:
        with self._lock, suppress(OSError, ValueError):  # the worker was killed: those who wait get WorkerKilled
            assert self._process is not None and self._process.stdin is not None
            send(self._process.stdin, message)

    def _listen(self, process: subprocess.Popen[bytes], reading: threading.Thread) -> None:
        assert process.stdout is not None and process.stdin is not None
        with process.stdout as replies, suppress(Exception):
            while (message := receive(replies)) is not None:
                self._loop.call_soon_threadsafe(self._take, message)
        process.wait()
        reading.join(1.0)  # the last line; a child process may hold the pipe open
        with suppress(OSError):
            process.stdin.close()
        with suppress(RuntimeError):  # the server ended
            self._loop.call_soon_threadsafe(self._handle_exit)

    def _take(self, message: JobResult | JobFailure | Event) -> None:
        if isinstance(message, Event):
            self._ready, self._deaths = True, 0
            self._hear(message)
            return
        future = self._waiting.get(message.number)
        if future is None or future.done():
            return
        if isinstance(message, JobFailure):
            future.set_exception(message.error)
        else:
            future.set_result(message.value)

    def _handle_exit(self) -> None:
        if self._is_closed:
            return
        self._deaths += not (self._ready or self._was_killed)
        if self._deaths < MAX_DEATHS:
            self._start()
            error: TangibleError = WorkerKilled("computation was stopped; finished products are kept")
        else:
            why = self._last_words[-1] if self._last_words else "it printed nothing"
            self._failure = f"the process that computes does not start: {shown(why, 300)}"
            error = WorkerAbsent(self._failure)
            self._hear(Event("maker_gone", {"why": self._failure}))
        for future in self._waiting.values():
            if not future.done():
                future.set_exception(error)
