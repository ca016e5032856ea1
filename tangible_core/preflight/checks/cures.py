"""What several checks advise: the key to change, and to what."""

import math
from collections.abc import Callable, Iterable

from ...data import Material, Relief
from ...scene.geometry import smooth
from ..bumps import reduced
from ..flight import Flight
from ..verdict import over, under

CELLS = 512
"""A side: on so many, how much smoothing will do is soon tried."""


def soften(flight: Flight, most_n_per_m: float) -> str:
    """How the law becomes at most this stiff."""
    materials = flight.surface.materials or ()  # those that no hand meets count in what the law says of itself
    stiffer = [material for material in materials if material.stiffness_n_per_m > most_n_per_m]
    if stiffer:
        return soften_material(stiffer, most_n_per_m)
    if "stiffness_n_per_m" in type(flight.law).model_fields:
        return f"`render.stiffness_n_per_m: {under(most_n_per_m)}`"
    return "a softer law, `render.use: ...`"


def soften_material(materials: Iterable[Material], most_n_per_m: float) -> str:
    """How materials become at most this stiff."""
    softer = (f"`{each.name}: {{stiffness_n_per_m: {under(most_n_per_m)}}}`" for each in materials)
    return f"in a file for `materials.library`, {', '.join(softer)}"


def flatten(flight: Flight, share: float) -> str:
    """How all slopes come down to this share of what they are."""
    return f"`{flight.relief_key}: {under(flight.relief_m * share)}`"


def round_off(flight: Flight, gentle: Callable[[Relief], bool]) -> str:
    """How the relief becomes gentle by smoothing; empty where it is given and not smoothed, or no smoothing will do."""
    longest_m, before_m = max(flight.surface.extent_m), flight.workspace.smooth_m
    relief = reduced(flight.surface.relief, longest_m / CELLS)
    sigma_m = 2 * longest_m / CELLS
    while flight.smoothed and sigma_m < longest_m / 8:
        if gentle(smooth(relief, sigma_m)):
            return f"`workspace.smooth_m: {over(math.hypot(before_m, sigma_m))}`"
        sigma_m *= math.sqrt(2)
    return ""
