"""What several checks advise: the key to change, and to what."""

import math
from collections.abc import Callable, Iterable

from ...data import Material, Relief
from ...scene.geometry import smooth
from ...servo.guard.safety import NOMINAL_S
from ..bumps import reduced
from ..flight import Flight
from ..verdict import Change, Cure, over, under

CELLS = 512
"""A side: on so many, how much smoothing will do is soon tried."""
SOFTEST_N_PER_M = 50.0
"""A hand that explores with 1 N sinks 20 mm into a law so soft, as deep as most reliefs are high: no cure is softer."""
FIT = Change("materials.fit", "device", "is")
COUPLE = Change("safety.coupling", "auto", "is")


def joined(*cures: Cure) -> Cure:
    """One after the other."""
    return [part for cure in cures for part in ((cure,) if isinstance(cure, str) else cure)]


def soften(flight: Flight, most_n_per_m: float) -> Cure:
    """How the law becomes at most this stiff."""
    materials = flight.surface.materials or ()  # those that no hand meets count in what the law says of itself
    stiffer = [material for material in materials if material.stiffness_n_per_m > most_n_per_m]
    if stiffer:
        return soften_materials(flight, stiffer, most_n_per_m)
    if "stiffness_n_per_m" in type(flight.law).model_fields and most_n_per_m >= SOFTEST_N_PER_M:
        return [Change("render.stiffness_n_per_m", under(most_n_per_m), "at most")]
    return "a softer law, `render.use: ...`"


def soften_materials(flight: Flight, materials: Iterable[Material], most_n_per_m: float) -> Cure:
    """How materials become at most this stiff: by the device that they fit, or each in a library of one's own."""
    if not flight.fitted:
        return [FIT]
    held = flight.safety.stiffness_margin * flight.nominal_n_per_m
    if flight.period_s <= NOMINAL_S and most_n_per_m < held:  # a slower loop's limits come down with the margin
        return [
            Change("safety.stiffness_margin", under(flight.safety.stiffness_margin * most_n_per_m / held), "at most")
        ]
    softer = (f"`{each.name}: {{stiffness_n_per_m: {under(most_n_per_m)}}}`" for each in materials)
    return f"in a file for `materials.library`, {', '.join(softer)}"


def flatten(flight: Flight, share: float) -> Change | str:
    """How all slopes come down to this share of what they are."""
    if not flight.relief_key:
        return "lower parts (`height_m` under `parts:`)"
    return Change(flight.relief_key, under(flight.relief_m * share), "at most")


def heighten(flight: Flight, times: float) -> Change | str:
    """How the relief becomes so many times as high."""
    if not flight.relief_key:
        return "higher parts (`height_m` under `parts:`)"
    return Change(flight.relief_key, over(flight.relief_m * times), "at least")


def round_off(flight: Flight, gentle: Callable[[Relief], bool]) -> Change | None:
    """How the relief becomes gentle by smoothing; None where it is given and not smoothed, or no smoothing will do."""
    longest_m, before_m = max(flight.surface.extent_m), flight.size.smooth_m
    relief = reduced(flight.surface.relief, longest_m / CELLS)
    sigma_m = 2 * longest_m / CELLS
    while flight.smoothed and sigma_m < longest_m / 8:
        if gentle(smooth(relief, sigma_m)):
            return Change("workspace.smooth_m", over(math.hypot(before_m, sigma_m)), "at least")
        sigma_m *= math.sqrt(2)
    return None
