"""The command `legible`: tests whether fingers can read a picture."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any, NamedTuple, get_args

import typer

from tangible_core.cli import FAILED, Config, Json, NoCache, Sets, Verbose, open_pipeline
from tangible_core.plugins import Medium

if TYPE_CHECKING:
    from tangible_core.preflight import Legibility

COLOURS = {"ok": "green", "warn": "yellow", "illegible": "bold red"}
WIDTHS = 9, 15  # characters: grades, checks


def legible(
    config: Config,
    medium: Annotated[
        Medium | None,
        typer.Option(
            "--for",
            help="Medium: swell paper, a printed solid, pins or a force device [default: each].",
            show_default=False,
        ),
    ] = None,
    sets: Sets = None,
    width_m: Annotated[float | None, typer.Option("--width-m", help="Width of the picture on the medium, m.")] = None,
    verbose: Verbose = False,
    as_json: Json = False,
    no_cache: NoCache = False,
) -> None:
    """Check whether fingers can read a picture on paper, print, pins or a device.

    Prints by the rules of tactile graphics what is not legible and where, and its cure; with --verbose also what is ok.
    Writes nothing. Exit 1 if something is illegible.
    """
    from tangible_core.cli import show
    from tangible_core.files import without_folders
    from tangible_core.pipeline import Feeling

    pipeline = open_pipeline(config, sets or [], not no_cache)
    feeling, scene = Feeling(pipeline), pipeline.scene.name
    results = list[Found]()
    media: tuple[Medium, ...] = (medium,) if medium else get_args(Medium)
    for name in media:
        wide_m = feeling.width_on(name) if width_m is None else width_m
        results.append(Found(name, wide_m, feeling.is_simplified_on(name), feeling.legible(name, wide_m)))
    if as_json:
        documents = [result.as_data() for result in results]
        show.print_json({"scene": scene, **(documents[0] if medium else {"media": documents})})
    elif medium or verbose:
        for result in results:
            show.verdicts(_heading(without_folders(scene), result), result.verdicts, COLOURS, WIDTHS, verbose)
    else:
        for result in results:
            show.say(_heading(without_folders(scene), result))
        show.plain(f"\n`tangible legible {config} --for swell` (or print, pins, force) says where, and the cures")
    if not all(result.verdicts.readable for result in results):
        raise typer.Exit(FAILED)


class Found(NamedTuple):
    """The verdicts on a picture of a width on a medium."""

    medium: Medium
    width_m: float
    simplified: bool
    verdicts: Legibility

    def as_data(self) -> dict[str, Any]:
        """Return the verdicts as JSON data."""
        return {
            "medium": self.medium,
            "width_m": self.width_m,
            "simplified": self.simplified,
            **self.verdicts.as_data(),
        }


def _heading(scene: str, found: Found) -> str:
    from rich.markup import escape

    from tangible_core.preflight import quantity

    from ..rules import PROFILES

    where, width = PROFILES[found.medium].text, quantity(found.width_m, "m")
    sentence = f"[{COLOURS[found.verdicts.grade]}]{escape(found.verdicts.sentence)}[/]"
    if found.simplified:
        return f"{escape(scene)}, its parts simplified, {width} wide, {where}: {sentence}"
    return f"{escape(scene)}, {width} wide, {where}: {sentence}"
