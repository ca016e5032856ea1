"""The worker's process, which may be slow or killed: a thread for quick jobs and one for long ones."""

import errno
import os
import queue
import shutil
import signal
import threading
from pathlib import Path
from typing import IO, Any, final

from tangible_core.errors import OutputError
from tangible_core.runtime.system import all_threads, lower_priority, take_input
from tangible_core.servo import receive, send, sendable

from .messages import Event, JobFailure, JobRequest, JobResult

FULL = {getattr(errno, name, -1) for name in ("ENOSPC", "EDQUOT", "EFBIG", "EROFS")}
# Niceness after the first long job: pictures can then wait, loop and page cannot. Before it, no loop has input.
NICENESS = 10
# Time for the main thread to find that the server is gone, s, before a reply that nobody reads ends the process.
CLEANING_S = 2.0
_keep_precedence: set[int] = set()


@final
class Sender:
    """Sender of messages to the server; safe to use from any thread."""

    def __init__(self, replies: IO[bytes]) -> None:
        self._replies, self._lock = replies, threading.Lock()

    def say(self, message: JobResult | JobFailure | Event) -> None:
        """Send a message; end the process if nobody reads any more."""
        try:
            with self._lock:
                send(self._replies, message)
        except OSError:
            threading.Timer(CLEANING_S, os._exit, (0,)).start()  # if the server is gone, `main` ends it before


def main() -> None:
    """Do jobs until the pipe closes; then the server is gone, and the folder for pages is removed if it was killed."""
    replies = os.fdopen(os.dup(1), "wb")
    os.dup2(2, 1)  # what a plugin prints goes to standard error
    signal.signal(signal.SIGINT, signal.SIG_IGN)  # Ctrl-C reaches the server, which ends this
    commands, voice = take_input(), Sender(replies)
    lanes: dict[bool, queue.SimpleQueue[JobRequest]] = {quick: queue.SimpleQueue() for quick in (True, False)}
    from ..logs import tell_pages
    from .jobs import JOBS
    from .state import WorkerState

    folder: Path | None = receive(commands)
    if folder is None:
        return
    tell_pages(lambda **told: voice.say(Event("log", told)), information=True)
    state = WorkerState(folder, lambda event, **told: voice.say(Event(event, told)))
    for quick, lane in lanes.items():
        threading.Thread(target=_work, args=(state, lane, voice, quick), daemon=True).start()
    voice.say(Event("maker", {}))
    while (ask := receive(commands)) is not None:
        lanes[JOBS[ask.job].quick].put(ask)
    shutil.rmtree(folder, ignore_errors=True)
    os._exit(0)  # threads are not joined


def _work(state: Any, asks: "queue.SimpleQueue[JobRequest]", voice: Sender, quick: bool) -> None:
    if quick:
        _keep_precedence.add(threading.get_native_id())
    while True:
        voice.say(answer(state, asks.get()))
        if not quick:
            lower_priority(all_threads() - _keep_precedence, NICENESS)


def answer(state: Any, ask: JobRequest) -> JobResult | JobFailure:
    """Do a job; a failure does not keep the next one from being done."""
    from .jobs import JOBS

    try:
        if not state.folder.is_dir():  # the folder for pages is temporary, and the system may have removed it
            state.folder.mkdir(parents=True, exist_ok=True)
            state.shown_digest = ""
        return JobResult(ask.number, JOBS[ask.job].do(state, **ask.arguments))
    except BaseException as error:  # noqa: BLE001 - whatever a plugin raises is for the page to say
        return JobFailure(ask.number, full(error) or sendable(error))


def full(error: BaseException) -> OutputError | None:
    """Return an error with its cure for a full disk; None for any other error."""
    if not isinstance(error, OSError) or error.errno not in FULL:
        return None
    return OutputError(f"{error.filename or 'a temporary folder'}: {error.strerror or error}; free some space")
