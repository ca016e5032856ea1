"""Measurements: timed, one new process after the other; or errors alone, side by side in workers that stay warm."""

import json
import os
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

from tangible_batch.farm import LONGEST_S, Farm
from tangible_batch.running import Workforce
from tangible_core.files import JsonLines
from tangible_core.runtime import check_stopped, command, stoppable

from .plan import Measurement
from .rows import Row, append, mend, read_rows
from .worker import answer

Report = Callable[[int, Row], None]
"""A callback with the number of a measurement, from 0, and its row: before it without a result, after it with one."""

POLL_S = 0.1  # the interval at which a wait for a measurement checks for a stop, seconds


@dataclass(frozen=True)
class Outlook:
    """The known rows of a comparison, and the measurements to do."""

    current: dict[str, Row]  # the rows that need not be measured again, by key
    waiting: tuple[Measurement, ...]


def look(requests: Sequence[Measurement], path: Path, retry: bool = False) -> Outlook:
    """Return which measurements are in the file and which are to do; retry: failed ones too. Raises: ResultsError."""
    keys = {measurement.row.key for measurement in requests}
    in_file = read_rows(path) if path.exists() else {}
    current = {key: row for key, row in in_file.items() if key in keys and not (retry and row.error)}
    return Outlook(current, tuple(measurement for measurement in requests if measurement.row.key not in current))


def run(
    outlook: Outlook, path: Path, timeout_s: float, on_start: Report, on_finish: Report, stop: Event | None = None
) -> dict[str, Row]:
    """Do the waiting measurements, add their rows to the file, return all rows by key. Raises: OutputError, Stopped."""
    with stoppable(stop):
        mend(path)
        rows = dict(outlook.current)
        failed_cells = {row.cell for row in rows.values() if row.error}
        for number, measurement in enumerate(outlook.waiting):
            if measurement.row.cell in failed_cells:
                continue
            check_stopped()
            on_start(number, measurement.row)
            row = replace(measurement.row, **_outcome(measurement, timeout_s))
            append(path, row)
            rows[row.key] = row
            if row.error:
                failed_cells.add(row.cell)
            on_finish(number, row)
        return rows


def _outcome(measurement: Measurement, timeout_s: float) -> dict[str, Any]:
    """Run a new worker and return the fields that it measured, or the error with which it ended."""
    with tempfile.TemporaryFile() as output, tempfile.TemporaryFile() as errors:
        try:
            code = _run_worker(measurement, timeout_s, output, errors)
        except subprocess.TimeoutExpired:
            return {"error": f"took longer than {timeout_s:g} s and was ended; raise timeout_s or drop the method"}
        with suppress(ValueError):
            return json.loads(_text(output))
        return {"error": _crash_message(code, _text(errors))}


def _run_worker(measurement: Measurement, timeout_s: float, output: IO[bytes], errors: IO[bytes]) -> int:
    """Give a job to a new worker, and return its exit code; on an exception, the worker is killed too."""
    words = command(f"{__package__}.worker")
    with subprocess.Popen(words, bufsize=0, stdin=subprocess.PIPE, stdout=output, stderr=errors) as process:
        try:
            assert process.stdin is not None
            with suppress(BrokenPipeError):  # the worker died before it could read: its exit code is reported
                process.stdin.write(
                    (json.dumps([os.getpid(), measurement.place, asdict(measurement.job)]) + "\n").encode()
                )
            return _wait(process, timeout_s)  # its input stays open, else the worker ends
        finally:
            process.kill()


def _wait(process: subprocess.Popen[bytes], timeout_s: float) -> int:
    """Return the exit code of a process. Raises: TimeoutExpired, or Stopped within POLL_S of the stop."""
    end_s = time.monotonic() + timeout_s
    while True:
        try:
            return process.wait(min(POLL_S, max(0.0, end_s - time.monotonic())))
        except subprocess.TimeoutExpired:
            check_stopped()
            if time.monotonic() >= end_s:
                raise


def _crash_message(code: int, errors: str) -> str:
    """Return how a process ended that could not report why, with its last line."""
    how = f"killed by {Signals(-code).name}" if code < 0 else f"ended with exit code {code}"
    last = errors.strip().rpartition("\n")[2]
    return f"{how}: {last}" if last else how


def _text(file: IO[bytes]) -> str:
    file.seek(0)
    return file.read().decode(errors="replace")


def run_side_by_side(
    outlook: Outlook,
    path: Path,
    workers: int | None,
    on_finish: Callable[[int, Row], None],
    stop: Event | None = None,
    timeout_s: float = LONGEST_S,
) -> dict[str, Row]:
    """Do as `run` on all cores, or n workers. Raises: BatchError without the extra, OutputError, Stopped."""
    rows, workforce = dict(outlook.current), Workforce(workers)
    if not outlook.waiting:
        return rows
    with (
        stoppable(stop),
        JsonLines(path) as file,
        Farm(min(workforce.workers_here, len(outlook.waiting)), workforce.threads_each or 1) as farm,
    ):
        for number, ended_job in enumerate(farm.map(_measure, outlook.waiting, timeout_s=timeout_s)):
            check_stopped()
            row = replace(ended_job.job.row, **(ended_job.result or {"error": ended_job.death}))
            file.add_row(asdict(row))
            rows[row.key] = row
            on_finish(number, row)
    return rows


def _measure(measurement: Measurement) -> dict[str, Any]:
    return answer(measurement.place, measurement.job)
