"""Cures that several checks share: the key to change, and its new value."""

import math
from collections.abc import Callable, Iterable

import numpy as np
from jaxtyping import Float32

from ...data import Material, Relief
from ...scene.geometry import smooth
from ...servo.guard.safety import NOMINAL_S
from ..bumps import reduce_relief
from ..flight import Flight
from ..verdict import Change, Cure, over, under

CELLS = 512  # cells along a side on which smoothing is tried: few, for speed
# Smallest stiffness of a cure: an exploring hand of 1 N sinks in by 20 mm, as deep as most reliefs are high.
SOFTEST_N_PER_M = 50.0
FIT = Change("materials.fit", "device", "is")
COUPLE = Change("safety.coupling", "auto", "is")

Slopes = Float32[np.ndarray, "h w"]


def join_cures(*cures: Cure) -> Cure:
    """Join cures one after the other."""
    return [part for cure in cures for part in ((cure,) if isinstance(cure, str) else cure)]


def soften(flight: Flight, most_n_per_m: float) -> Cure:
    """Return the cure that makes the force law at most this stiff."""
    materials = flight.surface.materials or ()  # absent materials count in the stiffness that the force law states
    stiffer = [material for material in materials if material.stiffness_n_per_m > most_n_per_m]
    if stiffer:
        return soften_materials(flight, stiffer, most_n_per_m)
    if "stiffness_n_per_m" in type(flight.law).model_fields and most_n_per_m >= SOFTEST_N_PER_M:
        return [Change("render.stiffness_n_per_m", under(most_n_per_m), "at most")]
    return "a softer force law, `render.use: ...`"


def soften_materials(flight: Flight, materials: Iterable[Material], most_n_per_m: float) -> Cure:
    """Return the cure that makes materials at most this stiff: fit them to the device, or use a custom library."""
    if not flight.settings.fitted:
        return [FIT]
    margin = flight.settings.safety.stiffness_margin
    stable = margin * flight.nominal_n_per_m
    if flight.period_s <= NOMINAL_S and most_n_per_m < stable:  # a slower loop's limits come down with the margin
        return [Change("safety.stiffness_margin", under(margin * most_n_per_m / stable), "at most")]
    softer = (f"`{material.name}: {{stiffness_n_per_m: {under(most_n_per_m)}}}`" for material in materials)
    return f"in a file for `materials.library`, {', '.join(softer)}"


def flatten(flight: Flight, share: float) -> Change | str:
    """Return the cure that scales all slopes by this share."""
    if not flight.settings.relief_key:
        return "lower parts (`height_m` under `parts:`)"
    return Change(flight.settings.relief_key, under(flight.settings.relief_m * share), "at most")


def heighten(flight: Flight, times: float) -> Change | str:
    """Return the cure that makes the relief `times` as high."""
    if not flight.settings.relief_key:
        return "higher parts (`height_m` under `parts:`)"
    return Change(flight.settings.relief_key, over(flight.settings.relief_m * times), "at least")


def narrow(flight: Flight, width_m: str) -> Change:
    """Return the cure that makes the surface at most this wide."""
    rise = flight.settings.size.rise.m_per_m
    if rise is None:
        return Change("workspace.width_m", width_m, "at most")
    times = flight.settings.relief_m / rise * flight.settings.size.width_m / float(width_m)
    return Change("workspace.scale", f"1:{math.ceil(times)}", "is")


def gentler(flight: Flight, steepest: float, few: float) -> Cure:
    """Return the cures after which at most `few` of the surface is steeper than this: slope, rounding, height."""
    slope = flight.settings.slope
    if slope is not None and (not slope or slope > steepest):
        return [Change("relief.slope", under(steepest), "at most")]

    def gentle(relief: Relief) -> bool:
        return float(np.mean(slopes(relief) > steepest)) <= few

    lower = flatten(flight, steepest / float(np.quantile(slopes(flight.surface.relief), 1 - few, method="higher")))
    rounder = round_off(flight, gentle)
    if rounder is None:
        return [lower]
    return [rounder, f", or {lower}" if isinstance(lower, str) else f", or a lower `{lower.key}`"]


def slopes(relief: Relief) -> Slopes:
    """Return the slope from each cell to its neighbours, the greater one of both sides; 0 for a single cell."""
    across, along = relief.pitch_m
    return np.hypot(_rise(relief.height_m.T).T / np.float32(across), _rise(relief.height_m) / np.float32(along))


def _rise(heights: Slopes) -> Slopes:
    rise = np.zeros_like(heights)
    steps = np.abs(np.diff(heights, axis=0))
    rise[1:] = steps
    rise[:-1] = np.maximum(rise[:-1], steps)
    return rise


def round_off(flight: Flight, gentle: Callable[[Relief], bool]) -> Change | None:
    """Return the smoothing that makes the relief gentle; None if it is not smoothed or no smoothing suffices."""
    longest_m, before_m = max(flight.surface.extent_m), flight.settings.size.smooth_m
    relief = reduce_relief(flight.surface.relief, longest_m / CELLS)
    sigma_m = 2 * longest_m / CELLS
    while flight.settings.smoothed and sigma_m < longest_m / 8:
        if gentle(smooth(relief, sigma_m)):
            return Change("workspace.smooth_m", over(math.hypot(before_m, sigma_m)), "at least")
        sigma_m *= math.sqrt(2)
    return None
