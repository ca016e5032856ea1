"""Where the device is too weak for the force, and where the force comes all at once."""

import math
from collections.abc import Iterator, Sequence

import numpy as np

from ...data import Relief
from ..flight import Flight
from ..verdict import FEW, Change, Cure, Verdict, held, under
from .cures import FIT, flatten, round_off, soften
from .slopes import slopes


def clipping(flight: Flight) -> Iterator[Verdict]:
    """Share of the surface where a hand that presses down is owed more than the device can give.

    Under a law without friction it is P sqrt(1 + g^2) on a slope g, for a press P: sideways too the hand is held.
    """
    strength_n, most_n, press_n = flight.probes.strength_n, flight.max_force_n, flight.hand.press_n
    share = float(np.mean(~(strength_n <= most_n)))
    reached_n = float(np.quantile(strength_n, 1 - FEW, method="higher"))
    cure: Cure = [f"press with no more than {under(press_n * most_n / max(reached_n, most_n))} N"]
    if most_n > press_n and flight.stiffness_n_per_m > 0 and reached_n > most_n:
        cure = [*_gentler(flight, reached_n), ", or ", *cure]
    yield held(
        *("clipping", "the surface", share, "<=", FEW, "share", f"the greatest force, {most_n:g} N"),
        note=f"at a press of {press_n:g} N, up to {strength_n.max():.3g} N",
        says="the device is too weak for the steepest places",
        cure=cure,
    )


def _gentler(flight: Flight, reached_n: float) -> Sequence[str | Change]:
    """By smoothing, where that makes the slopes gentle enough and they are not yet; otherwise by a lower relief."""
    most_n, press_n = flight.max_force_n, flight.hand.press_n
    steepest = math.sqrt((most_n / press_n) ** 2 - 1)

    def gentle(relief: Relief) -> bool:
        return float(np.mean(slopes(relief) > steepest)) <= FEW

    if not gentle(flight.surface.relief) and (rounder := round_off(flight, gentle)):
        return [rounder]
    return [flatten(flight, math.sqrt((most_n**2 - press_n**2) / (reached_n**2 - press_n**2)))]


def contact(flight: Flight) -> Iterator[Verdict]:
    """The greatest force on first contact: a spring's is none, that of a law that is no spring comes in one tick."""
    options = [name for name in type(flight.law).model_fields if name.startswith("force_") and name.endswith("_n")]
    greatest_n = float(flight.probes.onset_n.max())
    most_n = flight.max_step_n
    share = most_n / max(greatest_n, most_n)
    softer = [Change(f"render.{name}", under(getattr(flight.law, name) * share), "at most") for name in options]
    yield held(
        *("contact", "the law", greatest_n, "<=", most_n, "N", "`safety.max_step_n`"),
        note="1 um under the surface",
        says="the force comes all at once where the hand touches the surface",
        cure=_softer(flight, softer, share),
    )


def _softer(flight: Flight, softer: Sequence[Change], share: float) -> Cure:
    """A spring's force begins at none but where a texture lifts it."""
    if softer:
        return [*softer, ", or a law that is a spring, `render.use: proxy`"]
    if flight.met and not flight.fitted:
        return [FIT]
    if flight.stiffness_n_per_m > 0:
        return soften(flight, share * flight.stiffness_n_per_m)
    return "a law that is a spring, `render.use: proxy`"
