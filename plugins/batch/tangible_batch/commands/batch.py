"""`batch`: many scenes through one pipeline file."""

from __future__ import annotations

from collections.abc import Iterator, Sequence
from dataclasses import asdict
from pathlib import Path
from time import monotonic
from typing import TYPE_CHECKING, Annotated

import typer

from tangible_core.cli import FAILED, Json, Sets, completing, is_quiet, show
from tangible_core.errors import ConfigError, check_positive
from tangible_core.plugins import hooks
from tangible_core.plugins.registry import default_registry

if TYPE_CHECKING:
    from ..job import Row
    from ..running import Tally


def batch(
    files: Annotated[
        list[Path],
        typer.Argument(
            metavar="FILE...",
            help="Pipeline file (YAML) and pictures; pictures alone get values that suit the first.",
            show_default=False,
            autocompletion=completing.scenes,
        ),
    ],
    over: Annotated[
        list[str] | None,
        typer.Option(
            "--over",
            metavar="PICTURES | GLOB | FOLDER | rows.csv | rows.parquet",
            help="Pictures and pairs, or rows of settings.",
            show_default=False,
        ),
    ] = None,
    sets: Sets = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for the results [default: out/NAME-batch].")] = None,
    workers: Annotated[int | None, typer.Option(min=1, help="Processes [default: one a core].")] = None,
    threads: Annotated[
        int | None, typer.Option(min=1, help="Threads of each [default: the cores shared among them].")
    ] = None,
    scheduler: Annotated[
        str, typer.Option(metavar="tcp://HOST:PORT", help="Work on the machines of this Dask scheduler.")
    ] = "",
    retry: Annotated[bool, typer.Option("--retry", help="Repeat scenes that failed before.")] = False,
    sheets: Annotated[bool, typer.Option("--sheets", help="Draw a whole report of each, not a card alone.")] = False,
    cache: Annotated[
        Path | None, typer.Option("--cache", help="Keep results of stages here, for scenes that share them.")
    ] = None,
    timeout: Annotated[
        float | None, typer.Option(help="Seconds after which a scene is ended and fails [default: 3600].")
    ] = None,
    chunk: Annotated[int, typer.Option(min=1, help="The most scenes that are sent to a worker together.")] = 4,
    as_json: Json = False,
) -> None:
    """Run many pictures, or many settings, through one pipeline file.

    Each scene becomes a row, even if it fails. An interrupted batch continues where it stopped. Exit 1 if a scene
    failed.
    """
    from tangible_core.pipeline.config import with_overrides
    from tangible_core.pipeline.output import default_name

    from ..farm import LONGEST_S
    from ..manifest import find_rows
    from ..results import ROWS, write_gallery, write_index
    from ..running import BatchOptions, Tally, Workforce, run_batch

    config, text, pictures = _divide(files, over or [])
    timeout_s = LONGEST_S if timeout is None else timeout
    check_positive("--timeout", timeout_s)
    name = default_name(config)
    place = out or Path("out", f"{name}-batch")
    text = with_overrides(text, config, sets or [])
    tally, workforce = Tally(), Workforce(workers, threads, scheduler)
    options = BatchOptions(retry, sheets, cache, chunk, timeout_s)
    scenes = list(find_rows(pictures, besides=place))
    names = [scene.id for scene in scenes]
    rows = run_batch(text, config.absolute(), scenes, place, workforce, options, tally)
    try:
        for row in _show_progress(rows, tally, name):
            if row["outcome"] != "ok" and not (as_json or is_quiet()):
                show.note(f"{row['id']}: {row['error']}")
    except KeyboardInterrupt:
        show.note(f"interrupted; all finished scenes are kept in {place}, and the same command continues from there")
        raise
    result_files = [place / ROWS, write_index(place, names), *write_gallery(place, names)]
    _print(tally, [str(path) for path in result_files], as_json)
    if tally.failed:
        raise typer.Exit(FAILED)


def _divide(files: Sequence[Path], over: Sequence[str]) -> tuple[Path, str, list[str]]:
    """Return the pipeline file, its text, and what it runs over: a shell makes many words of `--over *.jpg`."""
    from tangible_core.files.yaml import read_text
    from tangible_core.pipeline import are_pictures
    from tangible_core.pipeline.starter import starter

    config = next((file for file in files if file.suffix.lower() in (".yaml", ".yml")), files[0])
    others = [*over, *(str(file) for file in files if file != config)]
    if not are_pictures([config]):
        if not others:
            raise ConfigError(f"{config}: has nothing to run over; name pictures behind it, or rows: --over rows.csv")
        return config, read_text(config), others
    return config, starter([config], config).text, [str(config), *others]


def _show_progress(rows: Iterator[Row], tally: Tally, name: str) -> Iterator[Row]:
    """Yield the rows; meanwhile, show how many are done and how long the rest will take."""
    from tangible_core.cli import approximately
    from tangible_core.data import Outcome

    plugins, since_s = default_registry().plugins, monotonic()
    try:
        for row in rows:
            if tally.made:
                left_s = (monotonic() - since_s) / tally.made * (tally.wanted - tally.kept - tally.made)
                count = f"{tally.kept + tally.made} of {tally.wanted} scenes"
                progress = f"{count} ({tally.failed} failed, {approximately(left_s)} left)"
                hooks.tell(plugins, "tangible_stage_started", product=progress, method=name)
            yield row
    finally:
        hooks.tell(plugins, "tangible_stage_finished", outcome=Outcome("scenes", "ran", "", name))


def _print(tally: Tally, files: Sequence[str], as_json: bool) -> None:
    if as_json:
        show.print_json({**asdict(tally), "files": files})
    elif not is_quiet():
        good = tally.wanted - tally.failed
        remark = f", {tally.kept} of them before" if tally.kept else ""
        again = f"; {tally.failed} failed: --retry repeats these" if tally.failed else ""
        show.sentence(f"{good} of {tally.wanted} scenes are made{remark}{again}.")
        for path in files[:MAX_FILES]:
            show.plain(f"written: {path}")


MAX_FILES = 4
