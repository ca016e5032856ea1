"""`compare`: measure the methods that a comparison file names, show the results, and report what got worse."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Literal

import typer

from tangible_core.cli import FAILED, Json, Sets, is_quiet, show
from tangible_core.errors import ArgumentError, ConfigError

if TYPE_CHECKING:
    from ..config.reading import Comparison


def _complete_sets(incomplete: str) -> list[tuple[str, str]]:
    """Return the standard sets that start with a word; none for an empty one, so that a shell completes file names."""
    from ..datasets import SETS

    return [
        (name, standard_set.title) for name, standard_set in SETS.items() if incomplete and name.startswith(incomplete)
    ]


def compare(
    configs: Annotated[
        list[Path],
        typer.Argument(
            metavar="FILE...",
            help="Comparison file (YAML), results (.jsonl) to show again, a standard set, such as kitti-2015, or the "
            "names of methods.",
            show_default=False,
            autocompletion=_complete_sets,
        ),
    ],
    sets: Sets = None,
    folder: Annotated[
        Path | None, typer.Option(help="Folder of a standard set [default: a folder of its name].")
    ] = None,
    out: Annotated[Path | None, typer.Option("--out", help="Folder for results [default: as in the file].")] = None,
    against: Annotated[
        Path | None, typer.Option(help="Earlier results (.jsonl); exit 1 if something got worse.")
    ] = None,
    detail: Annotated[bool, typer.Option("--detail", help="A table for each scene, with every measure.")] = False,
    quick: Annotated[
        bool, typer.Option("--quick", help="A first look: one round, one call, no perturbations.")
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
    as_json: Json = False,
) -> None:
    """Compare methods by time, memory and error.

    All methods are measured on the same scenes. An interrupted comparison continues where it stopped. Exit 1 if a
    method failed on every scene.
    """
    from ..comparing import ROWS, read_comparison
    from ..comparing import compare as run_comparison
    from ..config.reading import errors_only, shorten
    from ..measuring.rows import read_rows
    from . import printing
    from .progress import Progress

    if workers is not None and not errors:
        raise ArgumentError("--workers: goes with --errors-only; side by side, methods would spoil each other's times")
    config = configs[0] if len(configs) == 1 else Path("-".join(map(str, configs)))
    _check_options(config, folder, table, as_json)
    earlier = None if against is None else list(read_rows(against).values())
    if config.suffix == ".jsonl":
        outcome = read_comparison(config, earlier)
    else:
        comparison = _read(configs, folder, sets or [])
        comparison = shorten(comparison) if quick else comparison
        comparison = errors_only(comparison) if errors else comparison
        comparison = replace(comparison, out=out or comparison.out)
        progress = Progress(comparison.out / ROWS)
        try:
            outcome = run_comparison(
                comparison, earlier, retry=retry, workers=workers,
                progress=progress.report, on_outlook=progress.announce,
            )  # fmt: skip
        except KeyboardInterrupt:
            remark = f"all finished measurements are kept in {progress.path}"
            show.note(f"interrupted; {remark}, and the same command continues from there")
            raise
    if as_json:
        show.print_json(printing.as_document(outcome))
    elif table is not None:
        printing.print_for_papers(outcome.results, table)
    elif not is_quiet():
        printing.print_outcome(outcome, detail)
    if without_result := outcome.results.methods_without_result:
        show.flush()
        show.note(f"no result on any scene: {', '.join(without_result)}")
    if without_result or (outcome.verdict is not None and outcome.verdict.worse):
        raise typer.Exit(FAILED)


def _is_set(config: Path) -> bool:
    from ..datasets import SETS

    return str(config).partition("@")[0] in SETS and not config.is_file()


def _check_options(config: Path, folder: Path | None, table: str | None, json: bool) -> None:
    if folder is not None and not _is_set(config):
        raise ConfigError(f"--folder: is the folder of a standard set, and {config} is not one; leave it out")
    if table is not None and json:
        raise ConfigError("--table: decides what is printed, as does --json; leave one of them out")


def _read(configs: Sequence[Path], folder: Path | None, sets: Sequence[str]) -> Comparison:
    """Read a comparison file or a shipped one, or write one for a standard set or for methods."""
    from tangible_core.plugins.registry import default_registry

    from ..config.reading import comparison_of_methods, comparison_of_set, load_comparison, parse_comparison, preset

    config, registry = configs[0], default_registry()
    if _is_set(config):
        return parse_comparison(comparison_of_set(str(config), folder), config, registry, sets)
    if len(configs) == 1 and (config.exists() or config.suffix):
        return load_comparison(config, registry, sets)
    if len(configs) == 1 and (file := preset(str(config))):
        return replace(load_comparison(file, registry, sets), out=Path("out", file.stem))
    names = list(map(str, configs))
    name = Path(f"compare-{'-'.join(name.replace('/', '-') for name in names)}")
    return parse_comparison(comparison_of_methods(names, registry), name, registry, sets)
