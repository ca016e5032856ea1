"""Results of a comparison on the terminal: a sentence, tables, JSON, or the tables that papers print."""

from dataclasses import asdict
from math import isfinite, nan
from os import environ
from typing import Any

from rich.measure import Measurement
from rich.table import Table as RichTable
from rich.text import Text

from tangible_core.cli import show
from tangible_core.translation import localise

from ..comparing import ComparisonOutcome
from ..results import files, set_tables
from ..results.regressions import Regression, Verdict
from ..results.table import FRONT, Results, Table, tables

# Headings of the columns that hold text; all others hold numbers.
WORDS = {"method", "where", "what", "why", FRONT}


def as_document(outcome: ComparisonOutcome) -> dict[str, Any]:
    """Return the results as `--json` prints them."""
    results, verdict = outcome.results, outcome.verdict
    return {
        "compare": results.task.kind,
        "baseline": results.baseline,
        "scenes": results.scenes,
        "methods": [asdict(line) for perturb in results.perturbs for line in results.means(perturb)],
        "front": [results.means()[index].method for index in results.on_front(results.means(), results.main_measure)],
        "cells": [asdict(cell) for cell in results.cells.values()],
        "failed": results.methods_without_result,
        "files": [str(path) for path in outcome.files],
        **({} if verdict is None else {"against": asdict(verdict)}),
    }


def print_for_papers(results: Results, form: str) -> None:
    """Print the tables of the standard sets or, where no scene is from a set, the means. form: latex or csv."""
    ways = {"latex": (set_tables.as_latex, files.as_latex), "csv": (set_tables.as_csv, files.as_csv)}
    of_set, of_all = ways[form]
    for text in [of_set(set_table) for set_table in set_tables.set_tables(results)] or [of_all(results)]:
        show.plain(text.rstrip("\n"))


def print_outcome(outcome: ComparisonOutcome, detail: bool) -> None:
    """Print a sentence, the tables, what got worse, and the names of the files."""
    results, unit = outcome.results, outcome.results.task.clock.unit
    show.sentence(summary(results))
    for table in tables(results, detail):
        _print_table(table)
    if not any(cell.seconds for cell in results.cells.values()):
        show.say("errors alone were measured: times and memory are left empty")
    for set_table in set_tables.set_tables(results):
        _print_table(set_tables.as_table(set_table))
    show.say(f"{FRONT} Pareto-optimal: no other method is both faster and better")
    show.say(f"{unit}: median of the rounds; peak MB: on top of the scene")
    if results.baseline:
        show.say(f"time / baseline: against {results.baseline} in the same round, median; over scenes, geometric mean")
    if outcome.verdict is not None:
        _print_verdict(outcome.verdict)
    for path in outcome.files:
        show.plain(f"written: {path}")


def summary(results: Results) -> str:
    """Return a sentence: which method is the most exact, and which the fastest."""
    task, means = results.task, results.means()
    with_time = [line for line in means if isfinite(line.seconds)]
    best = (with_time or [line for line in means if isfinite(line.measures.get(results.main_measure, nan))] or [None])[
        0
    ]
    if best is None:
        return "No method has a result on every scene."
    scenes = f"{len(results.scenes)} scenes" if len(results.scenes) > 1 else results.scenes[0]
    value = best.measures.get(results.main_measure, nan)
    heading = results.heading(results.main_measure) if with_time else task.measures[results.main_measure].title
    exact = f"{heading}: {value:.{task.measures[results.main_measure].digits}f}"
    if not with_time:
        return f"On {scenes}, {best.method} is the most exact ({exact}); times were not measured."
    fastest = min(with_time, key=lambda line: line.seconds)
    time = f"{task.clock.per_second * fastest.seconds:.3g} {task.clock.unit}"
    if not isfinite(value):
        return f"On {scenes}, {fastest.method} is the fastest ({time})."
    return f"On {scenes}, {best.method} is the most exact ({exact}), and {fastest.method} is the fastest ({time})."


def _print_verdict(verdict: Verdict) -> None:
    rows = [
        (regression.method, f"{regression.scene}, {regression.perturb}", regression.what, *_change(regression))
        for regression in verdict.worse
    ]
    if rows:
        _print_table(Table("worse than before", ("method", "where", "what", "before", "now", "allowed"), tuple(rows)))
    show.say(f"{verdict.compared} cells compared, {verdict.time}; {len(rows)} figures got worse beyond the noise")
    if verdict.missing:
        show.say(f"not in both: {len(verdict.missing)} cells, such as {verdict.missing[0]}")


def _change(regression: Regression) -> tuple[str, str, str]:
    if regression.why:
        return "a result", regression.why, ""
    return f"{regression.before:.5g}", f"{regression.after:.5g}", f"+- {regression.allowed:.2g}"


def _print_table(table: Table) -> None:
    """Print a table without cutting numbers: one with many columns is as wide as it must be, on any terminal."""
    rich_table = RichTable(
        title=localise(table.title), title_justify="left", box=None, pad_edge=False, header_style="bold"
    )
    for heading in table.headings:
        if heading in WORDS:
            rich_table.add_column(localise(heading), overflow="fold", vertical="bottom")
        else:
            rich_table.add_column(localise(heading).replace(" ", "\n"), justify="right", vertical="bottom")
    rows = [[Text(localise(cell)) for cell in row] for row in table.rows]
    for row in rows:
        rich_table.add_row(*row)
    console = show.console()
    if (console.is_terminal or "COLUMNS" in environ) and show.is_narrow(console, rich_table):
        console.print(localise(table.title), "")
        show.entries(console, table.headings, rows)
        return
    if sum(heading not in WORDS for heading in table.headings) > 1:
        width = Measurement.get(console, console.options.update(max_width=show.WIDEST), rich_table)
        console.width = max(console.width, width.maximum)
    console.print(rich_table, "")
