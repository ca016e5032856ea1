"""`export`: what was made of a picture, as files for printers, swell paper, pin displays and readers."""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from . import completing
from .loudness import is_quiet
from .options import FAILED, MISTAKE, Felt, Json, NoCache, Sets
from .run import default_place, open_pipeline

if TYPE_CHECKING:
    from collections.abc import Sequence

    from ..pipeline.exporting import Export, Exported


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

    `--set export.NAME.OPTION=VALUE` sets an option of an exporter. Exit 2 if something cannot be written of this, 1 if
    an exporter failed; the others write all the same.
    """
    from . import show

    names = [name.strip() for each in to or [] for name in each.split(",") if name.strip()]
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


def _code(exports: Sequence[Exported]) -> int:
    """Whose mistake it is, if one was made."""
    became = {each.outcome.outcome for each in exports}
    return FAILED if "failed" in became else MISTAKE if "refused" in became else 0


def _print(scene: str, done: Export) -> None:
    from . import sentences, show

    show.sentence(sentences.exported(scene, done))
    show.outcomes(done.outcomes)
    if files := [path for paths in done.files.values() for path in paths]:
        show.say("\n[bold]written[/]")
    for path in files:
        show.plain(f"  {path}")
