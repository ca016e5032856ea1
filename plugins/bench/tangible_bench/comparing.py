"""A whole comparison: measure what is not measured yet, sum it up, plot it, and hold it against earlier results."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path
from threading import Event
from typing import NamedTuple

from tangible_core.errors import ResultsError

from .config.reading import Comparison
from .measuring.plan import measurements
from .measuring.rows import Row, read_rows
from .measuring.run import Outlook, look, run
from .measuring.side_by_side import run_side_by_side
from .results import regressions as verdicts
from .results.files import write_tables
from .results.plot import draw_plot
from .results.set_tables import write_set_tables
from .results.summary import cells
from .results.table import Results
from .tasks.task import TASKS, load_task

ROWS, PLOT = "results.jsonl", "plot.png"


class Step(NamedTuple):
    """A measurement that begins, or that is done."""

    number: int
    """From 0."""
    of: int
    """So many are to be measured."""
    row: Row
    done: bool


@dataclass(frozen=True)
class ComparisonOutcome:
    """What was found out, and where it lies."""

    results: Results
    files: tuple[Path, ...]
    """The rows, the tables for other programs, and the plot where there is something to plot."""
    verdict: verdicts.Verdict | None = None
    """What got worse than in earlier results, where there are any."""


def compare(
    comparison: Comparison,
    earlier: Sequence[Row] | None = None,
    *,
    retry: bool = False,
    progress: Callable[[Step], None] | None = None,
    on_outlook: Callable[[Outlook], None] | None = None,
    stop: Event | None = None,
    workers: int | None = None,
) -> ComparisonOutcome:
    """Measure what a comparison names, into `comparison.out`; rows that are there already are kept.

    earlier: rows of an earlier comparison, to be held against. retry: measure once more what failed before. progress:
    hears of every measurement as it begins and ends. on_outlook: hears first what is known and what is to be measured.
    stop: set from another thread, it ends the measurement under way, which is lost; the others are kept.
    workers: processes for a comparison of `errors_only`, whose measurements end in any order; one a core if not said.
    Raises: ConfigError, ResultsError, OutputError for files that are wrong or cannot be written; Stopped after `stop`.
    """
    path = comparison.out / ROWS
    outlook = look(measurements(comparison), path, retry)
    if on_outlook is not None:
        on_outlook(outlook)
    count = len(outlook.waiting)

    def tell(number: int, row: Row, done: bool) -> None:
        if progress is not None:
            progress(Step(number, count, row, done))

    def begun(number: int, row: Row) -> None:
        tell(number, row, False)

    def done(number: int, row: Row) -> None:
        tell(number, row, True)

    if comparison.protocol.calls:
        rows = run(outlook, path, comparison.protocol.timeout_s, begun, done, stop)
    else:
        rows = run_side_by_side(outlook, path, workers, done, stop, comparison.protocol.timeout_s)
    return _summed(rows, path, earlier)


def read_comparison(path: Path, earlier: Sequence[Row] | None = None) -> ComparisonOutcome:
    """What was measured before, from its rows (.jsonl). Raises: ResultsError."""
    return _summed(read_rows(path), path, earlier)


def _summed(rows: Mapping[str, Row], path: Path, earlier: Sequence[Row] | None) -> ComparisonOutcome:
    found = list(rows.values())
    results = _results(found, path)
    plot = path.with_name(PLOT)
    tables = (*write_tables(path.parent, results), *write_set_tables(path.parent, results))
    files = (path, *tables, *((plot,) if draw_plot(plot, results) else ()))
    return ComparisonOutcome(results, files, None if earlier is None else verdicts.compare(earlier, found))


def _results(rows: Sequence[Row], path: Path) -> Results:
    if not rows or rows[-1].compare not in TASKS:
        raise ResultsError(f"{path}: holds no row of a comparison that is known here ({', '.join(TASKS)})")
    baseline = rows[-1].baseline
    return Results(load_task(rows[-1].compare), cells(rows, baseline), baseline)
