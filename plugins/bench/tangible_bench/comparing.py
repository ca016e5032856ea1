"""A whole comparison: measure what is missing, sum it up, plot it, and compare it with earlier results."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from threading import Event
from typing import NamedTuple

from tangible_core.errors import ResultsError
from tangible_core.runtime.system import folder_lock

from .config.reading import Comparison
from .measuring.plan import measurements
from .measuring.rows import Row, read_rows
from .measuring.run import Outlook, Report, look, run, run_side_by_side
from .results.files import write_tables
from .results.plot import draw_plot
from .results.regressions import Verdict, find_regressions
from .results.set_tables import write_set_tables
from .results.summary import cells
from .results.table import Results
from .tasks.task import TASKS, load_task

ROWS, PLOT = "results.jsonl", "plot.png"


class Step(NamedTuple):
    """The start or the end of a measurement."""

    number: int  # the number of the measurement, from 0
    of: int  # the number of all measurements to do
    row: Row
    is_end: bool


@dataclass(frozen=True)
class ComparisonOutcome:
    """The results of a comparison, and their files."""

    results: Results
    # The rows, the tables for other programs, and the plot if there is something to plot.
    files: tuple[Path, ...]
    verdict: Verdict | None = None  # the figures that got worse than in earlier results, if there are any


def compare(
    comparison: Comparison,
    earlier: Sequence[Row] | None = None,
    *,
    retry: bool = False,
    progress: Callable[[Step], None] = lambda step: None,
    on_outlook: Callable[[Outlook], None] = lambda outlook: None,
    stop: Event | None = None,
    workers: int | None = None,
) -> ComparisonOutcome:
    """Measure what a comparison names, into `comparison.out`; existing rows are kept.

    earlier: rows to be compared with. on_outlook: called first, with the known rows and the measurements to do.
    stop: ends the measurement under way, from another thread. workers: processes for a comparison of `errors_only`.
    Raises: ConfigError, ResultsError, OutputError; Stopped after `stop`.
    """
    path = comparison.out / ROWS
    outlook = look(measurements(comparison), path, retry)
    on_outlook(outlook)

    def report(is_end: bool) -> Report:
        return lambda number, row: progress(Step(number, len(outlook.waiting), row, is_end))

    timeout_s = comparison.protocol.timeout_s
    if comparison.protocol.calls:
        rows = run(outlook, path, timeout_s, report(is_end=False), report(is_end=True), stop)
    else:
        rows = run_side_by_side(outlook, path, workers, report(is_end=True), stop, timeout_s)
    return _sum_up(rows, path, earlier)


def read_comparison(path: Path, earlier: Sequence[Row] | None = None) -> ComparisonOutcome:
    """Sum up the rows (.jsonl) of an earlier comparison. Raises: ResultsError."""
    return _sum_up(read_rows(path), path, earlier)


def _sum_up(by_key: Mapping[str, Row], path: Path, earlier: Sequence[Row] | None) -> ComparisonOutcome:
    rows = list(by_key.values())
    if not rows or rows[-1].compare not in TASKS:
        raise ResultsError(f"{path}: holds no row of a comparison of a known kind ({', '.join(TASKS)})")
    baseline = rows[-1].baseline
    results = Results(load_task(rows[-1].compare), cells(rows, baseline), baseline)
    plot = path.with_name(PLOT)
    with folder_lock(path.parent):
        tables = (*write_tables(path.parent, results), *write_set_tables(path.parent, results))
        files = (path, *tables, *((plot,) if draw_plot(plot, results) else ()))
    return ComparisonOutcome(results, files, None if earlier is None else find_regressions(earlier, rows))
