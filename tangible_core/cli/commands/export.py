"""The command `export`: products as files for printers, swell paper, pin displays and readers."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from ...errors import ConfigError, OutputError
from ...files.paths import without_folders
from .. import completing, sentences, show
from ..options import FAILED, MISTAKE, ConfigOrPictures, Json, NoCache, Sets, Verbose, is_quiet, named_language
from .run import default_place, open_pipeline

if TYPE_CHECKING:
    from ...pipeline.output.export_result import Export, Exported


TEXT = "text"  # the exporter of descriptions
CSV = "csv"  # for recordings; not the name of an exporter


def export(
    config: ConfigOrPictures,
    to: Annotated[
        list[str] | None,
        typer.Option(
            "--to",
            metavar="NAMES",
            help="Exporters, separated by commas, as `tangible plugins` lists them [default: those of the file].",
            show_default=False,
            autocompletion=completing.exporters,
        ),
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for the files [default: out/NAME].")] = None,
    sets: Sets = None,
    cut_out: Annotated[
        bool, typer.Option("--cut-out", help="Leave the ground of a photograph away; a network sees the figure.")
    ] = False,
    force: Annotated[bool, typer.Option("--force", help="Overwrite files that no export of this wrote.")] = False,
    verbose: Verbose = False,
    as_json: Json = False,
    no_cache: NoCache = False,
) -> None:
    """Write files for others: a printer, swell paper, pins, a reader.

    `--set export.NAME.OPTION=VALUE` sets an option of an exporter, `--lang` the language of a description, and
    of all words for a picture without a pipeline file. `--to csv` writes a recording (.nc, .npz) as text.
    Exit 2 if an exporter cannot write this, 1 if one failed; the others still write their files.
    """
    from ...pipeline.starter import are_pictures

    names = [name.strip() for text in to or [] for name in text.split(",") if name.strip()]
    if names == [CSV]:
        _print_recording(_as_csv(config, out or Path("out") / config[0].stem, force), as_json)
        return
    spoken = [f"export.{TEXT}.language={named_language()}"] if named_language() and TEXT in names else []
    if named_language() and are_pictures(config):  # no file states the language of its words
        spoken.append(f"language={named_language()}")
    pipeline = open_pipeline(config, [*spoken, *(sets or [])], not no_cache)
    place = out or default_place(config[0], config[1:])
    done = pipeline.export(place, names or None, force=force, cut_out=cut_out)
    if as_json:
        show.print_json(done.document())
    elif not is_quiet():
        _print(pipeline.scene.name, done, verbose)
    show.flush()
    for result in done.exports:
        if result.outcome.outcome != "ran":
            show.note(f"{result.name}: {result.outcome.why}")
    if code := _code(done.exports):
        raise typer.Exit(code)


def _as_csv(files: Sequence[Path], folder: Path, force: bool) -> Path:
    from ...session import Recording

    if len(files) > 1:
        raise ConfigError(f"{', '.join(map(str, files))}: name one recording to write as CSV")
    place = folder / f"{files[0].stem}.{CSV}"
    if place.exists() and not force:
        raise OutputError(f"{place}: is there already; --out FOLDER writes to another folder, --force writes over it")
    Recording.load(files[0]).save(place)
    return place


def _print_recording(place: Path, as_json: bool) -> None:
    if as_json:
        show.print_json({"files": [str(place)]})
    elif not is_quiet():
        show.plain(f"written\n  {place}")


def _code(exports: Sequence[Exported]) -> int:
    outcomes = {export.outcome.outcome for export in exports}
    return FAILED if "failed" in outcomes else MISTAKE if "refused" in outcomes else 0


def _print(scene: str, done: Export, verbose: bool) -> None:
    show.sentence(sentences.export_summary(without_folders(scene), done))
    if verbose:
        show.outcomes(done.outcomes)
    if files := [path for paths in done.files.values() for path in paths]:
        show.say("\n[bold]written[/]")
    for path in files:
        show.plain(f"  {path}")
