"""The commands `study check` and `study run`: an experiment with people from a file."""

from __future__ import annotations

import sys
from collections.abc import Callable
from contextlib import ExitStack
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Annotated

import typer

from tangible_core.cli import Json, is_quiet, show
from tangible_core.errors import ConfigError
from tangible_core.translation import translate

from .results import analyse, simulate

if TYPE_CHECKING:
    from tangible_web.hand import Hand

    from ..design import Study
    from ..desks.desk import Desk
    from ..presenting.stimuli import Stimuli

app: typer.Typer = typer.Typer(name="study", rich_markup_mode=None, add_completion=False, no_args_is_help=True)
StudyPath = Annotated[Path, typer.Argument(metavar="STUDY", help="Study file (YAML).", show_default=False)]
Device = Annotated[str | None, typer.Option(help="Device of all conditions [default: that of their pipelines].")]
DeviceSets = Annotated[
    list[str] | None, typer.Option("--set", metavar="KEY=VALUE", help="Set one value of the device; repeatable.")
]


@app.callback()
def study() -> None:
    """Run an experiment with people from a file; check it first."""


@app.command()
def check(file: StudyPath, device: Device = None, sets: DeviceSets = None, as_json: Json = False) -> None:
    """Check a study file, and that the device renders all that it asks for.

    No device is opened. Exit 2 if anything is wrong.
    """
    from ..session.order import StudyCourse

    stimuli = _open(file, device, sets)
    stimuli.make(_progress(stimuli))
    stimuli.check()
    trials = StudyCourse(stimuli.file, 0).trials
    if as_json:
        facts = {"study": stimuli.file.study.study, "device": stimuli.device, "surfaces": len(stimuli)}
        show.print_json({**facts, "trials": trials, "digest": stimuli.file.digest})
    elif not is_quiet():
        show.sentence(
            f"{file}: nothing is wrong. A participant has {trials} trials, with {len(stimuli)} surfaces on the device "
            f"{stimuli.device}.",
            apart=False,
        )


@app.command()
def run(
    file: StudyPath,
    participant: Annotated[str, typer.Option("--participant", help="Name of the participant, such as P7.")],
    out: Annotated[Path | None, typer.Option("--out", help="Folder for all results [default: out/NAME].")] = None,
    device: Device = None,
    sets: DeviceSets = None,
    page: Annotated[
        bool,
        typer.Option(
            "--page",
            help="Address the participant on a page in the browser, which reads aloud; without --device, surfaces are "
            "felt and heard there too, by keyboard, mouse, finger or game pad.",
        ),
    ] = False,
    resume: Annotated[bool, typer.Option("--resume", help="Go on where this participant stopped.")] = False,
) -> None:
    """Run a study with a participant, at the keyboard or on a page.

    At a terminal, each question is a line, each answer a key and Enter. Nothing shown tells which condition is
    presented. `q` leaves, and --resume goes on from there.
    """
    from contextlib import ExitStack

    from ..desks.desk import ParticipantLeft
    from ..session.running import begin

    hand = _own_hand(sets) if page and device is None else None
    stimuli = _open(file, device, sets, hand)
    if hand is not None and stimuli.has_film:
        raise ConfigError(f"{file}: has a film, which is not felt on the page; name a device with --device")
    root = out or Path("out", file.stem)
    with ExitStack() as stack:
        desk = _open_page(stimuli.file.study, hand, stack) if page else _terminal(stimuli.file.study)
        try:
            session = begin(stimuli.file, stimuli, participant, root, desk, resume=resume, progress=_progress(stimuli))
            if session is None:
                show.note("The participant does not agree; nothing was kept.")
                return
            count = session.run()
        except ParticipantLeft:
            show.note(f"the answers so far are kept in {root}; --resume goes on from there")
            return
    if not is_quiet():
        show.plain(f"{count} answers are kept in {root}")


def _terminal(design: Study) -> Desk:
    from ..desks.desk import Terminal

    return Terminal(sys.stdin, _print, lambda text: translate(text, design.language))


def _own_hand(sets: list[str] | None) -> Hand:
    """Return the hand by which the page is the device. Raises: ConfigError if keys of another device are set."""
    from ..desks.page import new_hand

    if any(setting.startswith("device.") for setting in sets or ()):
        raise ConfigError("--set device...: the page is the device; name another one with --device")
    return new_hand()


def _open_page(design: Study, hand: Hand | None, stack: ExitStack) -> Desk:
    """Serve the page until the stack ends, and open it in the browser."""
    import webbrowser

    from ..desks.page import Page

    to_participant = partial(translate, to=design.language)
    page = stack.enter_context(Page(design.language, to_participant, hand, design.sounds))
    show.note(f"the page of the participant: {page.address}")
    webbrowser.open(page.address)
    return page


def _open(file: Path, device: str | None, sets: list[str] | None, hand: Hand | None = None) -> Stimuli:
    from ..presenting.stimuli import Stimuli
    from ..session.running import device_changes
    from ..study_file import load_study

    if hand is None:
        return Stimuli(load_study(file), device_changes(device, sets or []))
    from ..desks.page import hand_changes

    return Stimuli(load_study(file), (*hand_changes(hand), *device_changes(None, sets or [])))


def _progress(stimuli: Stimuli) -> Callable[[int], None]:
    """Return a function that prints how many surfaces are made, without their names."""

    def count(number: int) -> None:
        if not is_quiet():
            show.note(f"{number} of {len(stimuli)} surfaces are ready")

    return count


def _print(text: str) -> None:
    """Print a line at once, in the language of the participant and not in that of the terminal."""
    from tangible_core.runtime import stream

    print(text, file=stream(), flush=True)


app.command()(simulate)
app.command()(analyse)
