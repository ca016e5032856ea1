"""The command `preflight`: checks before a motor moves."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import TYPE_CHECKING, Annotated, Any

import typer

from tangible_core.cli import FAILED, Config, Json, NoCache, Sets, Verbose, configured_device, open_pipeline, show
from tangible_core.errors import OutputError

if TYPE_CHECKING:
    from tangible_core.preflight import Flight, Hand, Loop, Preflight

    from ..fixing import Fixed

COLOURS = {"ok": "green", "warn": "yellow", "unsafe": "bold red"}
WIDTHS = 6, 12  # characters: grades, checks


def preflight(
    config: Config,
    sets: Sets = None,
    fix: Annotated[
        Path | None, typer.Option("--fix", metavar="OUT.yaml", help="Write a pipeline file that passes.")
    ] = None,
    force: Annotated[bool, typer.Option("--force", help="With --fix, overwrite an existing file.")] = False,
    seconds: Annotated[float, typer.Option(help="How long to measure this machine's timing, s.")] = 2.0,
    rate: Annotated[float, typer.Option(help="Rate of the force loop, Hz.")] = 1000.0,
    speed: Annotated[float, typer.Option(help="Speed of the hand's stroke, m/s.")] = 0.12,
    press: Annotated[float, typer.Option(help="Pressing force of the hand, N.")] = 3.0,
    verbose: Verbose = False,
    as_json: Json = False,
    no_cache: NoCache = False,
) -> None:
    """Check, before a motor moves, what is safe.

    Prints what is wrong, and its cure; with --verbose also what is ok. Opens no device. Exit 1 if something is unsafe.
    With --fix, the cures are tried, and a file with the necessary ones is written; if they are not enough, no file is,
    and the exit is 1.
    """
    from tangible_core.files import without_folders
    from tangible_core.pipeline import Feeling
    from tangible_core.preflight import Hand, Loop, judge

    hand, loop = Hand(speed, press), Loop(rate, seconds)
    if fix is not None and fix.exists() and not force:
        raise OutputError(f"{fix}: is there already; name another file, or --force writes over it")
    pipeline = open_pipeline(config, sets or [], not no_cache)
    device = configured_device(pipeline)
    if fix is None:
        flight = Feeling(pipeline).flight(hand=hand, loop=loop)
        verdicts, changes = judge(flight), {}
    else:
        flight, verdicts, changes = _fix(config, sets or [], hand, loop, fix, not no_cache, as_json)
    if as_json:
        _print_json(pipeline.scene.name, device.name, flight, verdicts, changes)
    else:
        _print(without_folders(pipeline.scene.name), device.name, verdicts, verbose)
    if not verdicts.safe:
        raise typer.Exit(FAILED)


def _fix(
    config: Path, sets: Sequence[str], hand: Hand, loop: Loop, out: Path, with_cache: bool, as_json: bool
) -> tuple[Flight, Preflight, dict[str, Any]]:
    """Try the cures and write the file if they are enough; return the state after them, and the file and changes."""
    from tangible_core.files import write_text

    from ..fixing import fix

    result = fix(config, sets, hand, loop, out, with_cache)
    if result.verdicts.safe:
        write_text(out, result.text)
    if not as_json:
        show.plain(_heading_of_fix(out, result))
        for loss in result.losses:
            show.plain(f"  {loss}")
        show.plain("")
    return (
        result.flight,
        result.verdicts,
        {"file": str(out) if result.verdicts.safe else None, "changes": result.changes},
    )


def _heading_of_fix(out: Path, result: Fixed) -> str:
    if result.verdicts.safe:
        return f"Written: {out}, in which the surface" if result.losses else f"Written: {out}; nothing had to change"
    return "Nothing was written: no cure is enough" + (", not even a surface that" if result.losses else "")


def _print(scene: str, device: str, verdicts: Preflight, verbose: bool) -> None:
    sentence = f"[{COLOURS[verdicts.grade]}]{show.escape(verdicts.sentence)}[/]"
    show.verdicts(f"{show.escape(scene)} on {show.escape(device)}: {sentence}", verdicts, COLOURS, WIDTHS, verbose)


def _print_json(scene: str, device: str, flight: Flight, verdicts: Preflight, changes: Mapping[str, Any]) -> None:
    head = {"scene": scene, "device": device, "sentence": verdicts.sentence, "grade": verdicts.grade}
    rows = [
        {**asdict(verdict), "changes": {change.key: change.value for change in verdict.changes}} for verdict in verdicts
    ]
    show.print_json({**head, **changes, **_figures(flight), "verdicts": rows})


def _figures(flight: Flight) -> dict[str, Any]:
    from tangible_core.preflight import PERCENTILES

    late, cost = flight.lateness, flight.cost
    return {
        "spec": asdict(flight.spec),
        "hand": asdict(flight.hand),
        "period_s": flight.period_s,
        "jitter": {
            **{f"{name}_s": late.at(percent) for name, percent in PERCENTILES.items()},
            "ticks": late.late_s.size,
            "overruns": late.overruns,
            "real_time": late.real_time,
        },
        "tick": {f"{name}_s": cost.at(percent) for name, percent in PERCENTILES.items()}
        | {"compiled_s": cost.kernel_s if cost.is_compiled else None},
    }
