"""`preflight`: what is to be known before a motor moves."""

from collections.abc import Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from rich.markup import escape

from ..preflight import PERCENTILES, Flight, Hand, Loop, Verdict, judge, survey
from . import show
from .run import device_of, open_pipeline

COLOURS = {"ok": "green", "warn": "yellow", "unsafe": "bold red"}
PREFIXES = ((1.0, ""), (1e-3, "m"), (1e-6, "u"))


def preflight(config: Path, sets: Sequence[str], hand: Hand, loop: Loop, as_json: bool, cached: bool) -> bool:
    """Make the touch, feel it all over, time it and this machine, and say what is ok, and what is not and its cure.

    Opens no device. Returns: whether no verdict is unsafe.
    """
    pipeline = open_pipeline(config, sets, cached)
    device = device_of(pipeline)
    touch = pipeline.make("touch")
    flight = survey(pipeline.config, pipeline.make("surface"), touch, hand, loop)
    verdicts = judge(flight)
    if as_json:
        show.print_json(
            {
                **{"scene": pipeline.scene.name, "device": device.name},
                **_figures(flight),
                "verdicts": [asdict(each) for each in verdicts],
            }
        )
    else:
        for verdict in verdicts:
            show.say(line(verdict))
        counts = {grade: sum(each.verdict == grade for each in verdicts) for grade in COLOURS}
        show.say(f"\n{pipeline.scene.name} on {device.name}: " + ", ".join(f"{n} {name}" for name, n in counts.items()))
    return all(each.verdict != "unsafe" for each in verdicts)


def line(verdict: Verdict) -> str:
    """A verdict as text, its cure on a line of its own, with rich's marks."""
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
