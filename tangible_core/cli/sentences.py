"""What a command found out, in a plain sentence, above the tables, which say the same in the field's words."""

from __future__ import annotations

from math import isfinite
from typing import TYPE_CHECKING, Any

if TYPE_CHECKING:
    from collections.abc import Mapping, Sequence

    from ..data import Outcome
    from ..pipeline.output.exporting import Export
    from ..pipeline.output.runs import Run
    from ..testing import CheckResult


def made(run: Run) -> str:
    """What a run made, how large it is, and what a hand felt."""
    products = [name for name, value in run.products.items() if value is not None]
    felt = "touch" in products
    said = f"{run.scene} can now be felt" if felt else f"{run.scene} is done: {_are_made(products)}"
    if (surface := run.products.get("surface")) is not None:
        width_m, length_m = surface.extent_m
        height_m = float(surface.height_m.max())
        said += f", as a surface of {1e3 * width_m:.0f} x {1e3 * length_m:.0f} mm, {1e3 * height_m:.3g} mm high"
    if (force := run.figures.get("force")) is not None:
        said += f". A simulated hand felt it for {force['seconds']:.1f} s, with forces of up to "
        said += f"{force['peak_force_n']:.1f} N"
    return f"{said}."


def _are_made(products: Sequence[str]) -> str:
    if not products:
        return "nothing of it had to be made"
    return f"its {_and(products)} {'is' if len(products) == 1 else 'are'} made"


def exported(scene: str, done: Export) -> str:
    """What a scene was written as, what could not be, and what fingers will not read of it."""
    written = [each.name for each in done.exports if each.files]
    left = [each.name for each in done.exports if not each.files]
    said = f"{scene} is written as {_and(written)}." if written else f"Nothing of {scene} was written."
    if written and left:
        said += f" {_and(left)} could not be written."
    unread = [each for each in done.exports if each.files and each.legible is not None and not each.legible.readable]
    return " ".join([said, *(f"{each.name}: {each.legible.sentence}" for each in unread if each.legible)])


def divided(name: str, parts: int) -> str:
    """Into how many parts a picture is divided."""
    return f"{name} is one part." if parts == 1 else f"{name} is divided into {parts} parts."


def planned(steps: Sequence[Outcome]) -> str:
    """How much of a plan is still to be run."""
    to_run = [each.product for each in steps if each.outcome == "ran"]
    kept = sum(each.outcome == "cached" for each in steps)
    if not to_run:
        return "Nothing is left to run: all of it is kept from earlier runs, or comes with the scene."
    said = f"`run` would make {_and(to_run)}"
    if kept:
        said += f", and take {kept} {'result' if kept == 1 else 'results'} of earlier runs as they are"
    return f"{said}. Nothing is run now."


def felt(device: str, figures: Mapping[str, Any]) -> str:
    """How long a device was felt, how hard, and whether the machine kept time."""
    missed = figures["overruns"]
    due = figures["ticks"] + missed
    in_time = "every tick came in time" if not missed else f"the loop was late, and left out {missed} of {due} ticks"
    return (
        f"{device} was felt for {figures['seconds']:.1f} s, {100 * figures['contact_share']:.0f} % of it in contact, "
        f"with forces of up to {figures['peak_force_n']:.1f} N; {in_time}."
    )


def checked(name: str, results: Sequence[CheckResult]) -> str:
    """Whether a method keeps what its kind promises."""
    broken = sum(not each.as_declared for each in results)
    if not broken:
        return f"{name} does what a method of its kind must: none of {len(results)} checks speaks against it."
    return f"{name} does not do what a method of its kind must: {broken} of {len(results)} checks speak against it."


def diagnosed(name: str | None, verdicts: Sequence[str]) -> str:
    """Whether anything keeps a device, or any of all, from working."""
    failed, unasked = verdicts.count("failed"), verdicts.count("not asked")
    if failed:
        return f"{_number(failed, 'check')} failed; the cure is said beside it."
    found = f"Nothing was found that keeps {name or 'a device'} from working"
    return f"{found}, but {_number(unasked, 'question')} could not be asked." if unasked else f"{found}."


def stressed(figures: Mapping[str, Any]) -> str:
    """How often a device can be read and written, and how often a force loop does."""
    rate = f"{figures['device']} can be read and written {figures['rate_hz']:.0f} times a second"
    return f"{rate}; a force loop does so 1000 times."


def _number(count: int, what: str) -> str:
    return f"{count} {what}{'' if count == 1 else 's'}"


def replayed(law: str, figures: Mapping[str, float]) -> str:
    """How far the forces of another law are from those that were recorded."""
    if not (figures["compared"] and isfinite(figures["error_percent"])):
        return f"Nothing was felt in this recording that the forces of {law} could be compared with."
    return (
        f"The forces of {law} differ by {figures['error_percent']:.0f} % from those that were recorded; a hand would "
        f"notice it in {figures['noticed_percent']:.0f} % of the time in contact."
    )


def approximately(seconds: float) -> str:
    """Say a time that is a guess.

    >>> approximately(0.4), approximately(42), approximately(150), approximately(9000)
    ('a few seconds', 'about 40 s', 'about 2 min', 'about 2 h 30 min')
    """
    if seconds < 7.5:
        return "a few seconds"
    if seconds < 90:
        return f"about {5 * round(seconds / 5)} s"
    minutes = round(seconds / 60)
    return f"about {minutes} min" if minutes < 90 else f"about {minutes // 60} h {10 * round(minutes % 60 / 10)} min"


def connected(rows: Sequence[Mapping[str, Any]]) -> str:
    """Which devices can be felt now."""
    real = [row["name"] for row in rows if row["units"]]
    simulated = [row["name"] for row in rows if row["simulated"]]
    there = f"{_and(real)} {'is' if len(real) == 1 else 'are'} connected" if real else "No real device is connected"
    return f"{there}; {_and(simulated)} need none." if simulated else f"{there}."


def _and(words: Sequence[str]) -> str:
    *most, last = words
    return f"{', '.join(most)} and {last}" if most else last
