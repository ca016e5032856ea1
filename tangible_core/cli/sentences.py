"""Summaries of results, one plain sentence each, which commands print above their tables."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from math import isfinite
from pathlib import Path
from typing import TYPE_CHECKING, Any

from ..files.paths import without_folders

if TYPE_CHECKING:
    from ..data import HapticSurface, Outcome
    from ..pipeline.output.export_result import Export
    from ..pipeline.output.runs import Run
    from ..testing import CheckResult


def run_summary(run: Run) -> str:
    """Return what a run made, the size of the surface, and the forces on a simulated hand."""
    scene, products = without_folders(run.scene), [name for name, value in run.products.items() if value is not None]
    if made_simpler(run.outcomes):
        scene += ", its parts simplified,"
    size, touch, flat = "", "", ""
    if (surface := run.products.get("surface")) is not None:
        width_m, length_m = surface.extent_m
        height_m, flat = float(surface.height_m.max()), _flat(surface)
        size = f", as a surface of {1e3 * width_m:.0f} x {1e3 * length_m:.0f} mm, {1e3 * height_m:.3g} mm high"
    if (force := run.figures.get("force")) is not None:
        peak_n = f"{force['peak_force_n']:.1f}"
        touch = f" A simulated hand felt it for {force['seconds']:.1f} s, with forces of up to {peak_n} N."
    if "touch" in products and flat:
        return f"{scene} has come out flat, {flat}{size}.{touch}"
    if "touch" in products:
        return f"{scene} can now be felt{size}.{touch}"
    if products:
        several = len(products) > 1 or products[0].endswith("s")  # materials, segments, views
        return f"{scene} is done: its {listing(products)} {'are' if several else 'is'} made{size}.{touch}"
    return f"{scene} is done: nothing of it had to be made{size}.{touch}"


def _flat(surface: HapticSurface) -> str:
    if not surface.relief.is_flat:
        return ""
    return "only its materials can be felt" if len(surface.materials or ()) > 1 else "there is nothing to feel"


def where(files: Sequence[Path]) -> str:
    """Return the folder of a run's files, and the sheet to look at."""
    sheets = [path for path in files if path.stem == "sheet"]
    return f"Results: {files[0].parent}" + (f"; look at {sheets[0]}" if sheets else "")


def export_summary(scene: str, done: Export) -> str:
    """Return what a scene was exported as, and which exports failed; a warning tells what fingers cannot read."""
    written = [export.name for export in done.exports if export.files]
    simple = any(made_simpler(export.made) for export in done.exports if export.files)
    failed = [export.name for export in done.exports if not export.files]
    if not written:
        return f"Nothing of {scene} was written."
    return (
        f"{scene} is written as {_typed(written)}"
        f"{'; parts are simplified' if simple else ''}"
        f"{f'; {_typed(failed)} could not be written' if failed else ''}."
    )


def _typed(names: Sequence[str]) -> str:
    """Return the names of exporters as they are typed, in every language."""
    return ", ".join(f"`{name}`" for name in names)


def made_simpler(outcomes: Sequence[Outcome]) -> bool:
    """Return True if the parts were simplified on the way to a product."""
    return any(outcome.product == "simplified" and outcome.outcome in ("ran", "cached") for outcome in outcomes)


def plan_summary(steps: Sequence[Outcome]) -> str:
    """Return which products of a plan have yet to be made."""
    to_run = [step.product for step in steps if step.outcome == "ran"]
    cached = sum(step.outcome == "cached" for step in steps)
    if not to_run:
        return "Nothing is left to run: all products are cached from earlier runs, or come with the scene."
    text = f"`run` would make {listing(to_run)}"
    if cached:
        text += f", and take {cached} {'result' if cached == 1 else 'results'} of earlier runs from the cache"
    return f"{text}. Nothing is run now."


def touch_summary(device: str, figures: Mapping[str, Any]) -> str:
    """Return how long and with which forces a device was felt, and whether the loop was on time."""
    missed = figures["overruns"]
    due = figures["ticks"] + missed
    on_time = "every tick came in time" if not missed else f"the loop was late, and left out {missed} of {due} ticks"
    return (
        f"{device} was felt for {figures['seconds']:.1f} s, {100 * figures['contact_share']:.0f} % of it in contact, "
        f"with forces of up to {figures['peak_force_n']:.1f} N; {on_time}."
    )


def check_summary(name: str, results: Sequence[CheckResult]) -> str:
    """Return the number of conformance checks that a method passes or fails."""
    broken = sum(not result.as_declared for result in results)
    if not broken:
        return f"{name} passes all {len(results)} conformance checks."
    return f"{name} fails {broken} of {len(results)} conformance checks."


def replay_summary(law: str, figures: Mapping[str, float]) -> str:
    """Return how far the forces of another force law are from the recorded ones."""
    if not (figures["compared"] and isfinite(figures["error_percent"])):
        return f"Nothing was felt in this recording that the forces of {law} could be compared with."
    return (
        f"The forces of {law} differ by {figures['error_percent']:.0f} % from those that were recorded; a hand would "
        f"notice it in {figures['noticed_percent']:.0f} % of the time in contact."
    )


def approximately(seconds: float) -> str:
    """Return an estimated time in words.

    >>> approximately(0.4), approximately(42), approximately(150), approximately(9000)
    ('a few seconds', 'about 40 s', 'about 2 min', 'about 2 h 30 min')
    """
    if seconds < 7.5:
        return "a few seconds"
    if seconds < 90:
        return f"about {5 * round(seconds / 5)} s"
    minutes = round(seconds / 60)
    return f"about {minutes} min" if minutes < 90 else f"about {minutes // 60} h {10 * round(minutes % 60 / 10)} min"


def listing(words: Sequence[str]) -> str:
    """Return the words with commas, and 'and' before the last."""
    *most, last = words
    return f"{', '.join(most)} and {last}" if most else last
