"""The command `legible`: tests whether fingers can read a picture."""

from __future__ import annotations

from enum import StrEnum
from typing import TYPE_CHECKING, Annotated

import typer

from ..options import FAILED, Config, Json, NoCache, Sets
from .run import open_pipeline

if TYPE_CHECKING:
    from ...legibility import Legibility

COLOURS = {"ok": "green", "warn": "yellow", "illegible": "bold red"}
WIDTHS = 9, 15
"""The columns of grades and of checks, characters."""


class ReadOn(StrEnum):
    """The media that fingers read."""

    swell = "swell"
    print = "print"
    pins = "pins"
    force = "force"


def legible(
    config: Config,
    medium: Annotated[
        ReadOn, typer.Option("--for", help="Medium: swell paper, a printed solid, pins or a force device.")
    ],
    sets: Sets = None,
    width_m: Annotated[float | None, typer.Option("--width-m", help="Width of the picture on the medium, m.")] = None,
    as_json: Json = False,
    no_cache: NoCache = False,
) -> None:
    """Check whether fingers can read a picture on paper, print, pins or a device.

    Prints by the rules of tactile graphics what is ok, what is not and where, and its cure. Writes nothing. Exit 1 if
    something is illegible.
    """
    from ...pipeline.feeling import Feeling

    pipeline = open_pipeline(config, sets or [], not no_cache)
    width_m = Feeling(pipeline).width_on(medium.value) if width_m is None else width_m
    verdicts = Feeling(pipeline).legible(medium.value, width_m)
    _print(pipeline.scene.name, medium.value, width_m, verdicts, as_json)
    if not verdicts.readable:
        raise typer.Exit(FAILED)


def _print(scene: str, medium: str, width_m: float, verdicts: Legibility, as_json: bool) -> None:
    from rich.markup import escape

    from ...legibility import PROFILES
    from ...preflight.wording import quantity
    from .. import show

    if as_json:
        show.print_json({"scene": scene, "medium": medium, "width_m": width_m, **verdicts.as_data()})
        return
    where = next(profile.text for name, profile in PROFILES.items() if name == medium)
    sentence = f"[{COLOURS[verdicts.grade]}]{escape(verdicts.sentence)}[/]"
    heading = f"{escape(scene)}, {quantity(width_m, 'm')} wide, on {where}: {sentence}"
    show.verdicts(heading, verdicts, COLOURS, WIDTHS)
