"""Errors without times: cells side by side in workers that stay warm, for what runs beside another has no time."""

from collections.abc import Callable
from dataclasses import asdict, replace
from pathlib import Path
from threading import Event
from typing import Any

from tangible_batch.farm import LONGEST_S, Done, Farm
from tangible_batch.running import Workforce
from tangible_core.files.json_lines import JsonLines
from tangible_core.runtime.stopping import check_stopped, stoppable

from ..config.reading import Comparison
from .plan import Measurement
from .rows import Row
from .run import Outlook
from .worker import answer


def errors_only(comparison: Comparison) -> Comparison:
    """The same without times: one round, no timed call, no baseline; in a folder beside."""
    protocol = comparison.protocol.model_copy(update={"repeats": 1, "warmups": 0, "calls": 0})
    out = comparison.out.with_name(f"{comparison.out.name}-errors")
    return replace(comparison, protocol=protocol, baseline=None, out=out)


def run_side_by_side(
    outlook: Outlook,
    path: Path,
    workers: int | None,
    finished: Callable[[int, Row], None],
    stop: Event | None = None,
    timeout_s: float = LONGEST_S,
) -> dict[str, Row]:
    """Measure what is waiting on all cores, or so many workers, and add it to the file; returns all rows by key.

    Raises: BatchError without the extra, OutputError if the file cannot be written, Stopped after `stop` was set.
    """
    rows, who = dict(outlook.kept), Workforce(workers)
    if not outlook.waiting:
        return rows
    with (
        stoppable(stop),
        JsonLines(path) as file,
        Farm(min(who.workers_here, len(outlook.waiting)), who.threads_each or 1) as farm,
    ):
        for number, done in enumerate(farm.map(_cell, outlook.waiting, timeout_s=timeout_s)):
            check_stopped()
            row = replace(done.job.row, **_outcome(done))
            file.add(asdict(row))
            rows[row.key] = row
            finished(number, row)
    return rows


def _cell(wanted: Measurement) -> dict[str, Any]:
    return answer(wanted.place, wanted.job)


def _outcome(done: Done[Measurement, dict[str, Any]]) -> dict[str, Any]:
    return done.result or {"error": done.death}
