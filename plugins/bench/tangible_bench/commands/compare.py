"""`compare`: measure what a comparison file names, show it, and say what got worse."""

from __future__ import annotations

from os import environ
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Annotated, Any, Literal

import typer

from tangible_core.cli.loudness import is_quiet
from tangible_core.cli.options import FAILED, Json, Sets

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..comparing import Step
    from ..config.reading import Comparison
    from ..measuring.forecast import Forecast
    from ..measuring.run import Outlook
    from ..results import regressions as verdicts
    from ..results.table import Results, Table
    from ..submitting import Submitted


def _sets(incomplete: str) -> list[tuple[str, str]]:
    """Standard sets, once a word looks like one: a shell completes names of files where nothing is offered."""
    from ..datasets import SETS

    return [(name, each.title) for name, each in SETS.items() if incomplete and name.startswith(incomplete)]


def compare(
    config: Annotated[
        Path,
        typer.Argument(
            help="Comparison file (YAML), results (.jsonl) to show again, or a standard set, such as kitti-2015.",
            show_default=False,
            autocompletion=_sets,
        ),
    ],
    sets: Sets = None,
    folder: Annotated[
        Path | None, typer.Option(help="Where a standard set lies [default: a folder of its name].")
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for results [default: as the file says].")] = None,
    against: Annotated[
        Path | None, typer.Option(help="Earlier results (.jsonl); exit 1 if something got worse.")
    ] = None,
    detail: Annotated[bool, typer.Option("--detail", help="A table for each scene, with every measure.")] = False,
    quick: Annotated[
        bool, typer.Option("--quick", help="A first look: one round, one call, nothing perturbed.")
    ] = False,
    errors: Annotated[
        bool, typer.Option("--errors-only", help="Errors without times: all cores work, in a fraction of the time.")
    ] = False,
    workers: Annotated[
        int | None, typer.Option(min=1, help="With --errors-only, processes [default: one a core].")
    ] = None,
    retry: Annotated[bool, typer.Option("--retry", help="Measure again what failed before.")] = False,
    table: Annotated[
        Literal["latex", "csv"] | None, typer.Option(help="Print the table that papers print, and nothing else.")
    ] = None,
    submission: Annotated[
        Path | None, typer.Option(help="Measure nothing; write a folder to submit to the benchmark.")
    ] = None,
    as_json: Json = False,
) -> None:
    """Compare methods by time, memory and error.

    All methods are measured on the same scenes. What was interrupted goes on where it stopped. Exit 1 if a method
    failed on every scene.
    """
    from dataclasses import replace

    from tangible_core.cli import show
    from tangible_core.errors import ArgumentError

    from ..comparing import ROWS, read_comparison
    from ..comparing import compare as measured
    from ..config.reading import quick as shortened
    from ..measuring.rows import read_rows
    from ..measuring.side_by_side import errors_only

    if workers is not None and not errors:
        raise ArgumentError("--workers: goes with --errors-only; side by side, methods would spoil each other's times")
    _check_options(config, folder, table, submission, as_json)
    if submission is not None:
        _submit(_comparison(config, folder, sets or []), submission, as_json)
        return
    earlier = None if against is None else list(read_rows(against).values())
    if config.suffix == ".jsonl":
        found = read_comparison(config, earlier)
    else:
        comparison = _comparison(config, folder, sets or [])
        comparison = shortened(comparison) if quick else comparison
        comparison = errors_only(comparison) if errors else comparison
        comparison = replace(comparison, out=out or comparison.out)
        path = comparison.out / ROWS
        watch = _Watch(path)
        try:
            how: dict[str, Any] = {"retry": retry, "workers": workers}
            found = measured(comparison, earlier, progress=watch.tell, on_outlook=watch.say, **how)
        except KeyboardInterrupt:
            show.note(f"interrupted; what was measured is kept in {path}, and the same command goes on from there")
            raise
    if as_json:
        show.print_json(_document(found.results, found.files, found.verdict))
    elif table is not None:
        _print_for_papers(found.results, table)
    elif not is_quiet():
        _print(found.results, found.files, found.verdict, detail)
    if failed := found.results.failed:
        show.flush()
        show.note(f"no result on any scene: {', '.join(failed)}")
    if failed or (found.verdict is not None and found.verdict.worse):
        raise typer.Exit(FAILED)


def _is_set(config: Path) -> bool:
    from ..datasets import SETS

    return str(config).partition("@")[0] in SETS and not config.is_file()


def _check_options(config: Path, folder: Path | None, table: str | None, submission: Path | None, json: bool) -> None:
    """Raises: ConfigError for options that do not go together."""
    from tangible_core.errors import ConfigError

    if folder is not None and not _is_set(config):
        raise ConfigError(f"--folder: says where a standard set lies, and {config} is none; leave it out")
    if submission is not None and config.suffix == ".jsonl":
        raise ConfigError(f"--submission: {config} holds figures alone; name the comparison file that they are of")
    if table is not None and (json or submission is not None):
        raise ConfigError("--table: says what is printed, as --json and --submission do; leave one of them out")


def _comparison(config: Path, folder: Path | None, sets: Sequence[str]) -> Comparison:
    """Of a file, or of a standard set that has none."""
    from tangible_core.plugins.registry import default_registry

    from ..config.reading import load_comparison, parse_comparison
    from ..config.standard_set import comparison_of_set

    if not _is_set(config):
        return load_comparison(config, default_registry(), sets)
    return parse_comparison(comparison_of_set(str(config), folder), config, default_registry(), sets)


def _submit(comparison: Comparison, folder: Path, as_json: bool) -> None:
    """Raises: Exit with 1 if a method has no result on a pair."""
    from dataclasses import asdict

    from tangible_core.cli import show
    from tangible_core.data import Outcome
    from tangible_core.plugins import hooks
    from tangible_core.plugins.registry import default_registry

    from ..submitting import submit

    plugins = default_registry().plugins

    def started(method: str, scene: str) -> None:
        hooks.tell(plugins, "tangible_stage_started", product=scene, method=method)

    done: list[Submitted] = []
    for each in submit(comparison, folder, started):
        done.append(each)
        kind, why = ("failed", each.error) if each.error else ("ran", "written")
        hooks.tell(
            plugins, "tangible_stage_finished", outcome=Outcome(each.scene, kind, why, each.method, each.seconds)
        )
    failed = [each for each in done if each.error]
    if as_json:
        show.print_json([{**asdict(each), "files": [str(path) for path in each.files]} for each in done])
    elif not is_quiet():
        for method in dict.fromkeys(each.method for each in done):
            files = [path for each in done if each.method == method for path in each.files]
            show.plain(f"{method}: {len(files)} files in {folder}")
    for each in failed:
        show.flush()
        show.note(f"no result of {each.method} on {each.scene}: {each.error}")
    if failed:
        raise typer.Exit(FAILED)


def _print_for_papers(results: Results, form: str) -> None:
    """The tables of the sets, or, of scenes that are of none, the means."""
    from tangible_core.cli import show

    from ..results import files as writing
    from ..results import set_tables

    ways = {"latex": (set_tables.as_latex, writing.as_latex), "csv": (set_tables.as_csv, writing.as_csv)}
    of_set, of_all = ways[form]
    texts = [of_set(each) for each in set_tables.set_tables(results)] or [of_all(results)]
    for text in texts:
        show.plain(text.rstrip("\n"))


class _Watch:
    """Says before the first measurement how long all of them will take, and during each how long the rest will."""

    def __init__(self, path: Path) -> None:
        self._path = path
        self._forecast: Forecast | None = None
        self._since_s = 0.0

    def say(self, outlook: Outlook) -> None:
        """What is known already, and how long the rest takes."""
        from tangible_core.cli import show
        from tangible_core.cli.sentences import approximately

        from ..measuring.forecast import forecast

        self._forecast, self._since_s = forecast(outlook.waiting), monotonic()
        if is_quiet():
            return
        count = len(outlook.waiting)
        if outlook.kept:
            failed = sum(row.error is not None for row in outlook.kept.values())
            again = f", {failed} of them failed: --retry measures these once more" if failed else ""
            wanted = len(outlook.kept) + count
            show.note(f"{len(outlook.kept)} of {wanted} measurements are in {self._path} already and are kept{again}")
        if count and not self._forecast.is_of_times:
            show.note(f"{count} measurements, side by side and without times; what is done is kept if you interrupt it")
        elif count:
            takes = approximately(self._forecast.whole_s)
            show.note(f"{count} measurements, which will take {takes}; what is done is kept if you interrupt it")

    def tell(self, step: Step) -> None:
        """A measurement is a stage like any other: whoever watches stages sees it, and --quiet hides it."""
        from tangible_core.cli.sentences import approximately
        from tangible_core.data import Outcome
        from tangible_core.plugins import hooks
        from tangible_core.plugins.registry import default_registry

        plugins, row = default_registry().plugins, step.row
        name = f"{row.scene}, {row.perturb}, round {row.repeat + 1} ({step.number + 1} of {step.of}"
        if not step.done:
            assert self._forecast is not None
            left = approximately(self._forecast.left_s(step.number, monotonic() - self._since_s))
            hooks.tell(plugins, "tangible_stage_started", product=f"{name}, {left} left)", method=row.method)
            return
        kind, why = ("failed", row.error) if row.error else ("ran", "measured")
        outcome = Outcome(f"{name})", kind, why or "", row.method, row.seconds or 0.0)
        hooks.tell(plugins, "tangible_stage_finished", outcome=outcome)


def _document(results: Results, files: Sequence[Path], verdict: verdicts.Verdict | None) -> dict[str, Any]:
    from dataclasses import asdict

    return {
        "compare": results.task.kind,
        "baseline": results.baseline,
        "scenes": results.scenes,
        "methods": [asdict(line) for perturb in results.perturbs for line in results.means(perturb)],
        "front": [results.means()[index].method for index in results.on_front(results.means(), results.judged)],
        "cells": [asdict(cell) for cell in results.cells.values()],
        "failed": results.failed,
        "files": [str(path) for path in files],
        **({} if verdict is None else {"against": asdict(verdict)}),
    }


def _print(results: Results, files: Sequence[Path], verdict: verdicts.Verdict | None, detail: bool) -> None:
    from tangible_core.cli import show

    from ..results import sentences
    from ..results.set_tables import set_tables, shown
    from ..results.table import FRONT, tables

    show.sentence(sentences.compared(results))

    for table in tables(results, detail):
        _print_table(table)
    if not any(cell.seconds for cell in results.cells.values()):
        show.say("errors alone were measured: times and memory are left empty")
    for each in set_tables(results):
        _print_table(shown(each))
    unit = results.task.clock.unit
    show.say(f"{FRONT} Pareto-optimal: no other method is both faster and better")
    show.say(f"{unit}: median of the rounds; peak MB: on top of the scene")
    if results.baseline:
        show.say(f"time / baseline: against {results.baseline} in the same round, median; over scenes, geometric mean")
    if verdict is not None:
        _print_verdict(verdict)
    for path in files:
        show.plain(f"written: {path}")


def _print_verdict(verdict: verdicts.Verdict) -> None:
    from tangible_core.cli import show

    from ..results.table import Table

    rows = [(each.method, f"{each.scene}, {each.perturb}", each.what, *_change(each)) for each in verdict.worse]
    if rows:
        _print_table(Table("worse than before", ("method", "where", "what", "before", "now", "allowed"), tuple(rows)))
    show.say(f"{verdict.compared} cells compared, {verdict.time}; {len(rows)} figures got worse beyond the noise")
    if verdict.missing:
        show.say(f"not in both: {len(verdict.missing)} cells, such as {verdict.missing[0]}")


def _change(each: verdicts.Regression) -> tuple[str, str, str]:
    if each.why:
        return "a result", each.why, ""
    return f"{each.before:.5g}", f"{each.after:.5g}", f"+- {each.allowed:.2g}"


def _print_table(table: Table) -> None:
    """Numbers are never cut: a table of many is as wide as it must be, whatever the terminal."""
    from rich.measure import Measurement
    from rich.table import Table as Drawn
    from rich.text import Text

    from tangible_core.cli import show

    from ..results.table import FRONT

    words = {*WORDS, FRONT}
    drawn = Drawn(title=table.title, title_justify="left", box=None, pad_edge=False, header_style="bold")
    for heading in table.headings:
        if heading in words:
            drawn.add_column(heading, overflow="fold", vertical="bottom")
        else:
            drawn.add_column(heading.replace(" ", "\n"), justify="right", vertical="bottom")
    for row in table.rows:
        drawn.add_row(*(Text(cell) for cell in row))
    console = show.console()
    if (console.is_terminal or "COLUMNS" in environ) and show.is_narrow(console, drawn):
        console.print(table.title, "")
        show.entries(console, table.headings, [[Text(cell) for cell in row] for row in table.rows])
        console.print("")
        return
    numbers = sum(heading not in words for heading in table.headings)
    if numbers > 1:
        wanted = Measurement.get(console, console.options.update(max_width=show.WIDEST), drawn)
        console.width = max(console.width, wanted.maximum)
    console.print(drawn, "")


WORDS = {"method", "where", "what", "why"}
"""Headings of columns that hold text, beside that of the front."""
