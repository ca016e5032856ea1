"""`compare`: measure what a comparison file names, show it, and say what got worse."""

from collections.abc import Mapping, Sequence
from dataclasses import asdict, replace
from pathlib import Path
from typing import Any

from ..bench import against as verdicts
from ..bench.config import Comparison, load_comparison
from ..bench.plan import measurements
from ..bench.plot import draw_plot
from ..bench.rows import Row, read_rows
from ..bench.run import Outlook, look, run
from ..bench.summary import cells
from ..bench.table import FRONT, Results, Table, tables
from ..bench.task import TASKS, load_task
from ..data import Outcome
from ..errors import ResultsError
from ..plugins import hooks
from ..plugins.registry import default_registry
from . import show

ROWS, PLOT = "results.jsonl", "plot.png"


def compare(
    config: Path, sets: Sequence[str], out: Path | None, against: Path | None, detail: bool, retry: bool, as_json: bool
) -> bool:
    """Measure, or read what was measured; False if something got worse."""
    earlier = list(read_rows(against).values()) if against else None
    if config.suffix == ".jsonl":
        path, rows = config, read_rows(config)
    else:
        comparison = load_comparison(config, default_registry(), sets)
        comparison = replace(comparison, out=out or comparison.out)
        path = comparison.out / ROWS
        rows = _measure(comparison, path, retry)
    results = _results(list(rows.values()), path)
    files = [path]
    if draw_plot(path.with_name(PLOT), results):
        files.append(path.with_name(PLOT))
    verdict = None if earlier is None else verdicts.compare(earlier, list(rows.values()))
    if as_json:
        show.print_json(_document(results, files, verdict))
    else:
        _print(results, files, verdict, detail)
    return verdict is None or not verdict.worse


def _measure(comparison: Comparison, path: Path, retry: bool) -> Mapping[str, Row]:
    wanted = measurements(comparison)
    outlook = look(wanted, path, retry)
    if outlook.kept:
        failed = sum(row.error is not None for row in outlook.kept.values())
        again = f", {failed} of them failed: --retry measures these once more" if failed else ""
        show.note(f"{len(outlook.kept)} of {len(wanted)} measurements are in {path} already and are kept{again}")
    try:
        return run(outlook, path, comparison.protocol.timeout_s, *_observers(outlook))
    except KeyboardInterrupt:
        show.note(f"interrupted; what was measured is kept in {path}, and the same command goes on from there")
        raise


def _observers(outlook: Outlook) -> tuple[Any, Any]:
    """A measurement is a stage like any other: whoever watches stages sees it, and --quiet hides it."""
    plugins, count = default_registry().plugins, len(outlook.waiting)

    def named(number: int, row: Row) -> str:
        return f"{row.scene}, {row.perturb}, round {row.repeat + 1} ({number + 1} of {count})"

    def started(number: int, row: Row) -> None:
        hooks.tell(plugins, "tangible_stage_started", product=named(number, row), method=row.method)

    def finished(number: int, row: Row) -> None:
        kind, why = ("failed", row.error) if row.error else ("ran", "measured")
        outcome = Outcome(named(number, row), kind, why or "", row.method, row.seconds or 0.0)
        hooks.tell(plugins, "tangible_stage_finished", outcome=outcome)

    return started, finished


def _results(rows: Sequence[Row], path: Path) -> Results:
    if not rows or rows[-1].compare not in TASKS:
        raise ResultsError(f"{path}: holds no row of a comparison that is known here ({', '.join(TASKS)})")
    baseline = rows[-1].baseline
    return Results(load_task(rows[-1].compare), cells(rows, baseline), baseline)


def _document(results: Results, files: Sequence[Path], verdict: verdicts.Verdict | None) -> dict[str, Any]:
    return {
        "compare": results.task.kind,
        "baseline": results.baseline,
        "scenes": results.scenes,
        "methods": [asdict(line) for perturb in results.perturbs for line in results.means(perturb)],
        "front": [results.means()[index].method for index in results.on_front(results.means(), results.judged)],
        "cells": [asdict(cell) for cell in results.cells.values()],
        "files": [str(path) for path in files],
        **({} if verdict is None else {"against": asdict(verdict)}),
    }


def _print(results: Results, files: Sequence[Path], verdict: verdicts.Verdict | None, detail: bool) -> None:
    for table in tables(results, detail):
        _print_table(table)
    unit = results.task.clock.unit
    show.say(f"{FRONT} nobody is faster and better; {unit}: median of the rounds; peak MB: on top of the scene")
    if results.baseline:
        show.say(f"time / baseline: against {results.baseline} in the same round, median; over scenes, geometric mean")
    if verdict is not None:
        _print_verdict(verdict)
    for path in files:
        show.plain(f"written: {path}")


def _print_verdict(verdict: verdicts.Verdict) -> None:
    rows = [(each.method, f"{each.scene}, {each.perturb}", each.what, *_change(each)) for each in verdict.worse]
    if rows:
        _print_table(Table("worse than before", ("method", "where", "what", "before", "now", "allowed"), tuple(rows)))
    show.say(f"{verdict.compared} cells compared, {verdict.time}; {len(rows)} figures got worse beyond the noise")
    if verdict.missing:
        show.say(f"not in both: {len(verdict.missing)} cells, such as {verdict.missing[0]}")


def _change(each: verdicts.Worse) -> tuple[str, str, str]:
    if each.why:
        return "a result", each.why, ""
    return f"{each.before:.5g}", f"{each.after:.5g}", f"+- {each.allowed:.2g}"


def _print_table(table: Table) -> None:
    """Numbers are never cut: a table of many is as wide as it must be, whatever the terminal."""
    from rich.measure import Measurement
    from rich.table import Table as Drawn
    from rich.text import Text

    drawn = Drawn(title=table.title, title_justify="left", box=None, pad_edge=False, header_style="bold")
    for heading in table.headings:
        if heading in WORDS:
            drawn.add_column(heading, overflow="fold", vertical="bottom")
        else:
            drawn.add_column(heading.replace(" ", "\n"), justify="right", vertical="bottom")
    for row in table.rows:
        drawn.add_row(*(Text(cell) for cell in row))
    console = show.console()
    numbers = sum(heading not in WORDS for heading in table.headings)
    if numbers > 1:
        console.width = max(
            console.width, Measurement.get(console, console.options.update(max_width=WIDEST), drawn).maximum
        )
    console.print(drawn, "")


WIDEST = 1000

WORDS = {"method", "where", "what", "why", FRONT}
"""Headings of columns that hold text."""
