"""Checks of the force: places where the device is too weak for it, and forces that step on contact."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from ..flight import Flight
from ..strokes import SIDEWAYS
from ..verdict import FEW, Change, Cure, Verdict, check_bound, under
from .cures import FIT, gentler, soften


def clipping(flight: Flight) -> Iterator[Verdict]:
    """Check the share of the surface where the force on a hand that presses down exceeds the device's.

    Under a force law without friction it is P sqrt(1 + s^2) on a slope s, for a press P and a hand held sideways. Walls
    that push the hand away more strongly than it pushes do not count: it does not stay there.
    """
    most_n, press_n = flight.max_force_n, flight.hand.press_n
    stays = np.linalg.norm(flight.probes.force_n[:, :2], axis=1) <= SIDEWAYS * press_n
    strength_n = np.where(stays, flight.probes.strength_n, 0.0)
    share = float(np.mean(~(strength_n <= most_n)))
    cure: Cure = ""
    if share > FEW:
        required_n = float(np.quantile(strength_n, 1 - FEW, method="higher"))
        cure = [f"press with no more than {under(press_n * most_n / required_n)} N"]
        if most_n > press_n and flight.stiffness_n_per_m > 0:
            cure = [*gentler(flight, math.sqrt((most_n / press_n) ** 2 - 1), FEW), ", or ", *cure]
    yield check_bound(
        *("clipping", "the surface", share, "<=", FEW, "share", f"the greatest force, {most_n:g} N"),
        note=f"at a press of {press_n:g} N, up to {strength_n.max():.3g} N",
        says="the device is too weak for the steepest places",
        cure=cure,
    )


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
    if flight.present_materials and not flight.settings.fitted:
        return [FIT]
    if flight.stiffness_n_per_m > 0:
        return soften(flight, share * flight.stiffness_n_per_m)
    return "a force law that is a spring, `render.use: proxy`"
