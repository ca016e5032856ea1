"""`preflight`: what is to be known before a motor moves."""

from __future__ import annotations

from typing import TYPE_CHECKING, Annotated, Any

import typer

from .options import FAILED, Config, Json, NoCache, Sets
from .run import device_of, open_pipeline

if TYPE_CHECKING:
    from ..preflight import Flight, Verdict

COLOURS = {"ok": "green", "warn": "yellow", "unsafe": "bold red"}
PREFIXES = ((1.0, ""), (1e-3, "m"), (1e-6, "u"))


def preflight(
    config: Config,
    sets: Sets = None,
    seconds: Annotated[float, typer.Option(help="How long to measure this machine's timing, s.")] = 2.0,
    rate: Annotated[float, typer.Option(help="Rate of the force loop, Hz.")] = 1000.0,
    speed: Annotated[float, typer.Option(help="Speed of the hand's stroke, m/s.")] = 0.12,
    press: Annotated[float, typer.Option(help="Pressing force of the hand, N.")] = 3.0,
    as_json: Json = False,
    no_cache: NoCache = False,
) -> None:
    """Check, before a motor moves, what is safe.

    Says what is ok, what is not, and its cure. Opens no device. Exit 1 if something is unsafe.
    """
    from dataclasses import asdict

    from ..preflight import Hand, Loop, judge
    from . import show

    hand, loop = Hand(speed, press), Loop(rate, seconds)
    pipeline = open_pipeline(config, sets or [], not no_cache)
    device, flight = device_of(pipeline), pipeline.flight(hand=hand, loop=loop)
    verdicts = judge(flight)
    if as_json:
        said = {"scene": pipeline.scene.name, "device": device.name, **_figures(flight)}
        show.print_json({**said, "verdicts": [asdict(each) for each in verdicts]})
    else:
        for verdict in verdicts:
            show.say(line(verdict))
        counts = {grade: sum(each.verdict == grade for each in verdicts) for grade in COLOURS}
        show.say(f"\n{pipeline.scene.name} on {device.name}: " + ", ".join(f"{n} {name}" for name, n in counts.items()))
    if any(each.verdict == "unsafe" for each in verdicts):
        raise typer.Exit(FAILED)


def line(verdict: Verdict) -> str:
    """A verdict as text, its cure on a line of its own, with rich's marks."""
    from rich.markup import escape

    found = quantity(verdict.value, verdict.unit)
    if verdict.relation:
        found += f" {verdict.relation} {quantity(verdict.bound, verdict.unit)}"
    said = "; ".join(filter(None, (f"{verdict.of}: {found}", verdict.note, verdict.source)))
    cure = f"\n{'':>20}cure: {verdict.cure}" if verdict.cure else ""
    return f"[{COLOURS[verdict.verdict]}]{verdict.verdict:<6}[/] {verdict.check:<12} {escape(said + cure)}"


def quantity(value: float, unit: str) -> str:
    """A value for people.

    >>> quantity(2.9e-5, "m"), quantity(800.0, "N/m"), quantity(0.125, "share"), quantity(0.0, "s")
    ('29 um', '800 N/m', '12.5 %', '0 s')
    """
    if unit == "share":
        return f"{100 * value:.3g} %"
    if unit not in ("m", "s"):
        return f"{float(f'{value:.4g}'):.15g} {unit}"
    scale, prefix = next((each for each in PREFIXES if abs(value) >= each[0]), PREFIXES[-1] if value else PREFIXES[0])
    return f"{value / scale:.3g} {prefix}{unit}"


def _figures(flight: Flight) -> dict[str, Any]:
    from dataclasses import asdict

    from ..preflight import PERCENTILES

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
        | {"compiled_s": cost.kernel_s},
    }
