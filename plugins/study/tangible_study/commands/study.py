"""The commands `study check` and `study run`: an experiment with people from a file."""

from __future__ import annotations

from pathlib import Path
from typing import Annotated

import typer

from tangible_core.cli.options import Json
from tangible_core.cli.verbosity import is_quiet

app = typer.Typer(name="study", rich_markup_mode=None, add_completion=False, no_args_is_help=True)
StudyPath = Annotated[Path, typer.Argument(metavar="STUDY", help="Study file (YAML).", show_default=False)]


@app.callback()
def study() -> None:
    """Run an experiment with people from a file; check it first."""


@app.command()
def check(file: StudyPath, as_json: Json = False) -> None:
    """Check a study file before anybody sits down."""
    from tangible_core.cli import show

    from ..session.order import StudyCourse
    from ..study_file import load_study

    found = load_study(file)
    trials = StudyCourse(found, 0).trials
    if as_json:
        show.print_json({"study": found.study.study, "digest": found.digest, "trials": trials})
    elif not is_quiet():
        show.sentence(f"{file}: nothing is wrong; a participant has {trials} trials.")
