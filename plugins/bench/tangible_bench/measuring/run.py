"""Measure what is not measured yet: one fresh process after the other, each row kept as soon as it is known."""

import json
import subprocess
import tempfile
import time
from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import asdict, dataclass, replace
from pathlib import Path
from signal import Signals
from threading import Event
from typing import IO, Any

from tangible_core.runtime.child_process import command
from tangible_core.runtime.stopping import check_stopped, stoppable

from .plan import Measurement
from .rows import Row, append, mend, read_rows

Tell = Callable[[int, Row], None]
"""Hears the number of a measurement, from 0, and its row: without a result before it, with one after it."""

LOOK_EVERY_S = 0.1
"""How often a wait for a measurement looks whether it shall end."""


@dataclass(frozen=True)
class Outlook:
    """What a file already knows of a comparison."""

    kept: dict[str, Row]
    """Rows that need not be measured again, by key."""
    waiting: tuple[Measurement, ...]


def look(wanted: Sequence[Measurement], path: Path, retry: bool = False) -> Outlook:
    """What of the wanted measurements is in the file, and what is not.

    retry: measure those that failed once more.
    Raises: ResultsError for a file that is damaged, or holds no results.
    """
    keys = {each.row.key for each in wanted}
    held = read_rows(path) if path.exists() else {}
    kept = {key: row for key, row in held.items() if key in keys and not (retry and row.error)}
    return Outlook(kept, tuple(each for each in wanted if each.row.key not in kept))


def run(
    outlook: Outlook, path: Path, timeout_s: float, started: Tell, finished: Tell, stop: Event | None = None
) -> dict[str, Row]:
    """Measure what is waiting, and add it to the file; returns all rows by key.

    A method that failed on a scene is not tried there again in later rounds. An interruption loses at most the
    measurement that is under way.
    Raises: OutputError if the file cannot be written, Stopped after `stop` was set.
    """
    with stoppable(stop):
        return _run(outlook, path, timeout_s, started, finished)


def _run(outlook: Outlook, path: Path, timeout_s: float, started: Tell, finished: Tell) -> dict[str, Row]:
    mend(path)
    rows = dict(outlook.kept)
    failed = {row.cell for row in rows.values() if row.error}
    for number, each in enumerate(outlook.waiting):
        if each.row.cell in failed:
            continue
        check_stopped()
        started(number, each.row)
        row = replace(each.row, **_outcome(each, timeout_s))
        append(path, row)
        rows[row.key] = row
        if row.error:
            failed.add(row.cell)
        finished(number, row)
    return rows


def _outcome(wanted: Measurement, timeout_s: float) -> dict[str, Any]:
    """What a fresh process says, or how it ended."""
    with tempfile.TemporaryFile() as said, tempfile.TemporaryFile() as noise:
        try:
            code = _ended(wanted, timeout_s, said, noise)
        except subprocess.TimeoutExpired:
            return {"error": f"took longer than {timeout_s:g} s and was ended; raise timeout_s or drop the method"}
        return _answer(_text(said)) or {"error": _death(code, _text(noise))}


def _ended(wanted: Measurement, timeout_s: float, said: IO[bytes], noise: IO[bytes]) -> int:
    """Exit code of a worker that was given a job; on any other end, it is ended too."""
    words = command(f"{__package__}.worker")
    with subprocess.Popen(words, bufsize=0, stdin=subprocess.PIPE, stdout=said, stderr=noise) as process:
        try:
            assert process.stdin is not None
            with suppress(BrokenPipeError):  # it died before it could listen: its exit code tells
                process.stdin.write((json.dumps([wanted.place, asdict(wanted.job)]) + "\n").encode())
            return _waited(process, timeout_s)  # with its input left open: the end of that is the worker's own
        finally:
            process.kill()


def _waited(process: subprocess.Popen[bytes], timeout_s: float) -> int:
    """Exit code of a process. Raises: TimeoutExpired, or Stopped within a tenth of a second of being asked to stop."""
    end_s = time.monotonic() + timeout_s
    while True:
        try:
            return process.wait(min(LOOK_EVERY_S, max(0.0, end_s - time.monotonic())))
        except subprocess.TimeoutExpired:
            check_stopped()
            if time.monotonic() >= end_s:
                raise


def _answer(text: str) -> dict[str, Any] | None:
    try:
        return json.loads(text)
    except ValueError:
        return None


def _death(code: int, noise: str) -> str:
    """How a process ended that had no time to say why; with the last line it wrote."""
    how = f"killed by {Signals(-code).name}" if code < 0 else f"ended with exit code {code}"
    last = noise.strip().rpartition("\n")[2]
    return f"{how}: {last}" if last else how


def _text(file: IO[bytes]) -> str:
    file.seek(0)
    return file.read().decode(errors="replace")
