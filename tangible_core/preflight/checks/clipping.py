"""Checks of the force: places where the device is too weak for it, and forces that step on contact."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from ...data import Relief
from ..flight import Flight
from ..verdict import FEW, Change, Cure, Verdict, check_bound, under
from .cures import FIT, flatten, round_off, soften
from .slopes import slopes


def clipping(flight: Flight) -> Iterator[Verdict]:
    """Check the share of the surface where the force on a hand that presses down exceeds the device's.

    Under a force law without friction it is P sqrt(1 + g^2) on a slope g, for a press P and a hand held sideways.
    """
    strength_n, most_n, press_n = flight.probes.strength_n, flight.max_force_n, flight.hand.press_n
    share = float(np.mean(~(strength_n <= most_n)))
    required_n = float(np.quantile(strength_n, 1 - FEW, method="higher"))
    cure: Cure = [f"press with no more than {under(press_n * most_n / max(required_n, most_n))} N"]
    if most_n > press_n and flight.stiffness_n_per_m > 0 and required_n > most_n:
        cure = [*_gentler(flight, required_n), ", or ", *cure]
    yield check_bound(
        *("clipping", "the surface", share, "<=", FEW, "share", f"the greatest force, {most_n:g} N"),
        note=f"at a press of {press_n:g} N, up to {strength_n.max():.3g} N",
        says="the device is too weak for the steepest places",
        cure=cure,
    )


def _gentler(flight: Flight, required_n: float) -> Sequence[str | Change]:
    """Return smoothing if it makes the slopes gentle enough and is needed, otherwise a lower relief."""
    most_n, press_n = flight.max_force_n, flight.hand.press_n
    steepest = math.sqrt((most_n / press_n) ** 2 - 1)

    def gentle(relief: Relief) -> bool:
        return float(np.mean(slopes(relief) > steepest)) <= FEW

    if not gentle(flight.surface.relief) and (rounder := round_off(flight, gentle)):
        return [rounder]
    return [flatten(flight, math.sqrt((most_n**2 - press_n**2) / (required_n**2 - press_n**2)))]


def contact(flight: Flight) -> Iterator[Verdict]:
    """Check the greatest force on first contact: a spring has none; another force law's force comes in one tick."""
    options = [name for name in type(flight.law).model_fields if name.startswith("force_") and name.endswith("_n")]
    greatest_n = float(flight.probes.onset_n.max())
    most_n = flight.max_step_n
    share = most_n / max(greatest_n, most_n)
    softer = [Change(f"render.{name}", under(getattr(flight.law, name) * share), "at most") for name in options]
    yield check_bound(
        *("contact", "the law", greatest_n, "<=", most_n, "N", "`safety.max_step_n`"),
        note="1 um under the surface",
        says="the force comes all at once where the hand touches the surface",
        cure=_softer(flight, softer, share),
    )


def _softer(flight: Flight, softer: Sequence[Change], share: float) -> Cure:
    """Return the cure for a force that steps on contact; a spring's force does so only where a texture lifts it."""
    if softer:
        return [*softer, ", or a force law that is a spring, `render.use: proxy`"]
    if flight.present_materials and not flight.fitted:
        return [FIT]
    if flight.stiffness_n_per_m > 0:
        return soften(flight, share * flight.stiffness_n_per_m)
    return "a force law that is a spring, `render.use: proxy`"
