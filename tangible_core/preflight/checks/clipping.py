"""Where the device is too weak for the force, and where the force comes all at once."""

import math
from collections.abc import Iterator

import numpy as np

from ..flight import Flight
from ..verdict import FEW, Verdict, held, under
from .cures import flatten


def clipping(flight: Flight) -> Iterator[Verdict]:
    """Share of the surface where a hand that presses down is owed more than the device can give.

    Under a law without friction it is P sqrt(1 + g^2) on a slope g, for a press P: sideways too the hand is held.
    """
    strength_n, most_n, press_n = flight.probes.strength_n, flight.max_force_n, flight.hand.press_n
    share = float(np.mean(~(strength_n <= most_n)))
    reached_n = float(np.quantile(strength_n, 1 - FEW, method="higher"))
    cure = f"press with no more than {under(press_n * most_n / max(reached_n, most_n))} N"
    if most_n > press_n and flight.stiffness_n_per_m > 0 and reached_n > most_n:
        gentler = math.sqrt((most_n**2 - press_n**2) / (reached_n**2 - press_n**2))
        cure = f"{flatten(flight, gentler)}, or {cure}"
    yield held(
        *("clipping", "the surface", share, "<=", FEW, "share", f"the greatest force, {most_n:g} N"),
        note=f"at a press of {press_n:g} N, up to {strength_n.max():.3g} N",
        cure=cure,
    )


def contact(flight: Flight) -> Iterator[Verdict]:
    """The greatest force on first contact: a spring's is none, that of a law that is no spring comes in one tick."""
    options = [name for name in type(flight.law).model_fields if name.startswith("force_") and name.endswith("_n")]
    greatest_n = float(flight.probes.onset_n.max())
    most_n = flight.max_step_n
    share = most_n / max(greatest_n, most_n)
    softer = [f"`render.{name}: {under(getattr(flight.law, name) * share)}`" for name in options]
    yield held(
        *("contact", "the law", greatest_n, "<=", most_n, "N", "`safety.max_step_n`"),
        note="1 um under the surface",
        cure=", ".join([*softer, "or a law that is a spring, `render.use: proxy`"]),
    )
