"""Measurements of errors alone: side by side in workers that stay warm, as times would disturb each other."""

from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from threading import Event
from typing import Any

from tangible_batch.farm import LONGEST_S, Farm
from tangible_batch.running import Workforce
from tangible_core.files import JsonLines
from tangible_core.runtime import check_stopped, stoppable

from .plan import Measurement
from .rows import Row
from .run import Outlook
from .worker import answer


def run_side_by_side(
    outlook: Outlook,
    path: Path,
    workers: int | None,
    finished: Callable[[int, Row], None],
    stop: Event | None = None,
    timeout_s: float = LONGEST_S,
) -> dict[str, Row]:
    """Do the waiting measurements on all cores or n workers, add their rows to the file, and return all rows by key.

    Raises: BatchError without the extra, OutputError if the file cannot be written, Stopped after `stop` was set.
    """
    rows, workforce = dict(outlook.kept), Workforce(workers)
    if not outlook.waiting:
        return rows
    with (
        stoppable(stop),
        JsonLines(path) as file,
        Farm(min(workforce.workers_here, len(outlook.waiting)), workforce.threads_each or 1) as farm,
    ):
        for number, done in enumerate(farm.map(_measure, outlook.waiting, timeout_s=timeout_s)):
            check_stopped()
            row = replace(done.job.row, **(done.result or {"error": done.death}))
            file.add_row(asdict(row))
            rows[row.key] = row
            finished(number, row)
    return rows


def _measure(wanted: Measurement) -> dict[str, Any]:
    return answer(wanted.place, wanted.job)
