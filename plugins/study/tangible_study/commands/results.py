"""The commands `study analyse` and `study simulate`: what was found, and what would be found."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tangible_core.cli import Json, is_quiet, show

if TYPE_CHECKING:
    from ..analysis.analysing import Analysis
    from ..simulation.power import Need


def analyse(
    folder: Annotated[
        Path, typer.Argument(metavar="FOLDER", help="Folder of the results of a study.", show_default=False)
    ],
    out: Annotated[
        Path | None, typer.Option("--out", help="Folder for tables and plots [default: FOLDER/analysis].")
    ] = None,
    as_json: Json = False,
) -> None:
    """Say what a study found and how sure that is; write tables and plots.

    Training trials, and trials in which the device did not render what was requested, are left out and counted.
    """
    from ..analysis.analysing import analyse as analyse_folder

    _report(analyse_folder(folder), out or folder / "analysis", as_json)


def simulate(
    file: Annotated[Path, typer.Argument(metavar="STUDY", help="Study file (YAML).", show_default=False)],
    observer: Annotated[
        str, typer.Option("--observer", help="Observer model: psychometric, detection, or hand.")
    ] = "detection",
    sets: Annotated[
        list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Set one option of the observer; repeatable.")
    ] = None,
    participants: Annotated[int, typer.Option(min=1, max=999, help="Number of simulated participants.")] = 12,
    out: Annotated[
        Path | None, typer.Option("--out", help="Folder for the results [default: out/NAME-simulated].")
    ] = None,
    seed: Annotated[int, typer.Option(min=0, help="Seed of the observers.")] = 0,
    power: Annotated[
        bool, typer.Option("--power", help="Tell how many trials and participants are needed; nothing is written.")
    ] = False,
    as_json: Json = False,
) -> None:
    """Run a study with an observer model in place of people, and analyse it.

    The same procedures choose the trials, and the results are a folder like that of a study with people. The observer's
    option `difference` is what there is to find.
    """
    from ..analysis.analysing import analyse as analyse_folder
    from ..simulation.observers import make_observer
    from ..simulation.power import plan, write_folder
    from ..study_file import load_study

    study = load_study(file)
    model = make_observer(observer, sets or [], study)
    if power:
        _print_needs(plan(study, model, seed=seed, progress=_announce), as_json)
        return
    root = out or Path("out") / f"{file.stem}-simulated"
    write_folder(root, study, model, participants, seed)
    _report(analyse_folder(root), root / "analysis", as_json)


def _report(analysis: Analysis, out: Path, as_json: bool) -> None:
    from ..analysis.analysing import counts
    from ..analysis.files import write_results

    files = write_results(out, analysis)
    if as_json:
        show.print_json({**analysis.document(), "files": files})
    elif not is_quiet():
        show.sentence(counts(analysis.answers))
        for name, texts in analysis.sentences.items():
            show.plain(f"{name}:")
            for text in texts:
                show.say(text)
        for path in files[:2]:
            show.plain(f"written: {path}")


def _announce(comparison: str, repetitions: int) -> None:
    if not is_quiet():
        show.note(f"{comparison}: trying {repetitions} repetitions")


def _print_needs(needs: Sequence[Need], as_json: bool) -> None:
    if as_json:
        show.print_json([need._asdict() for need in needs])
        return
    headings = ("comparison", "repetitions", "trials of each", "difference found", "participants needed")
    rows = [
        (
            need.comparison,
            str(need.repetitions),
            str(need.trials),
            f"{need.effect:.3g} +- {need.spread:.2g}",
            "-" if need.participants is None else str(need.participants),
        )
        for need in needs
    ]
    show.table(headings, rows, "participants needed to find the difference in 4 of 5 studies")
    show.say(
        "The difference is that of the two conditions that are hardest to tell apart, with its standard deviation over "
        "participants; -: more than 200 participants, or no difference to find."
    )
