"""`export`: what was made of a picture, as files for printers, swell paper, pin displays and readers."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from .. import completing
from ..options import FAILED, MISTAKE, Felt, Json, NoCache, Sets
from ..verbosity import is_quiet
from .run import default_place, open_pipeline

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ...pipeline.output.exporting import Export, Exported


CSV = "csv"
"""What a recording is written as: no exporter's name."""


def export(
    config: Felt,
    to: Annotated[
        list[str] | None,
        typer.Option(
            "--to",
            metavar="NAMES",
            help="Exporters, with commas between them, as `tangible plugins` lists them [default: those of the file].",
            show_default=False,
            autocompletion=completing.exporters,
        ),
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for the files [default: out/NAME].")] = None,
    sets: Sets = None,
    force: Annotated[bool, typer.Option("--force", help="Write over files that no export of this left.")] = False,
    as_json: Json = False,
    no_cache: NoCache = False,
) -> None:
    """Write files for others: a printer, swell paper, pins, a reader.

    `--set export.NAME.OPTION=VALUE` sets an option of an exporter. A recording (.nc, .npz) is written with `--to csv`.
    Exit 2 if something cannot be written of this, 1 if an exporter failed; the others write all the same.
    """
    from .. import show

    names = [name.strip() for each in to or [] for name in each.split(",") if name.strip()]
    if names == [CSV]:
        _print_recording(_as_csv(config, out or Path("out") / config[0].stem, force), as_json)
        return
    pipeline = open_pipeline(config, sets or [], not no_cache)
    done = pipeline.export(out or default_place(config[0]), names or None, force=force)
    if as_json:
        show.print_json(done.document())
    elif not is_quiet():
        _print(pipeline.scene.name, done)
    show.flush()
    for each in done.exports:
        if each.outcome.outcome != "ran":
            show.note(f"{each.name}: {each.outcome.why}")
    if code := _code(done.exports):
        raise typer.Exit(code)


def _as_csv(files: Sequence[Path], folder: Path, force: bool) -> Path:
    """A recording as text, a tick a line. Raises: ConfigError for several; OutputError for what is no recording."""
    from ...errors import ConfigError, OutputError
    from ...session import Recording

    if len(files) > 1:
        raise ConfigError(f"{', '.join(map(str, files))}: name one recording, which is written as CSV")
    place = folder / f"{files[0].stem}.{CSV}"
    if place.exists() and not force:
        raise OutputError(f"{place}: is there already; --out FOLDER writes to another folder, --force writes over it")
    Recording.load(files[0]).save(place)
    return place


def _print_recording(place: Path, as_json: bool) -> None:
    from .. import show

    if as_json:
        show.print_json({"files": [str(place)]})
    elif not is_quiet():
        show.plain(f"written\n  {place}")


def _code(exports: Sequence[Exported]) -> int:
    """Whose mistake it is, if one was made."""
    became = {each.outcome.outcome for each in exports}
    return FAILED if "failed" in became else MISTAKE if "refused" in became else 0


def _print(scene: str, done: Export) -> None:
    from .. import sentences, show

    show.sentence(sentences.exported(scene, done))
    show.outcomes(done.outcomes)
    if files := [path for paths in done.files.values() for path in paths]:
        show.say("\n[bold]written[/]")
    for path in files:
        show.plain(f"  {path}")
