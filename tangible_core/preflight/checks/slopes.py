"""Checks of slopes: places where the force law is stiffer than on level ground, and walls."""

import math
from collections.abc import Iterator

import numpy as np
from jaxtyping import Float32

from ...data import Relief
from ..flight import Flight
from ..verdict import FEW, Cure, Verdict, check_bound
from .cures import COUPLE, FIT, SOFTEST_N_PER_M, flatten, join_cures, round_off, soften
from .stiffness import TOO_STIFF

MEASURED = 1.01
"""Ratio of a measured stiffness to the true one that is allowed as an error."""
WALL = 1.0
"""Slope of a wall: above 45 degrees a hand must push harder sideways than it presses down."""
WALLS = 0.1
"""Share of the surface up to which walls count as its outlines."""
PROXY = "proxy"
"""Name of the force law whose stiffness is that of level ground everywhere."""
LEVEL = 1.1
"""Ratio to the stiffness on level ground up to which slopes are not at fault."""
RARE = 0.001
"""Share of the surface that may be too stiff: the passivity controller brakes there."""

Slopes = Float32[np.ndarray, "h w"]


def slope_stiffness(flight: Flight) -> Iterator[Verdict]:
    """Check the share of the surface where the force law, along its force, is stiffer than the device renders stably.

    The stiffness of a penalty along the gradient grows by 1 + |g|^2 with the slope g, that of a texture by its
    curvature times the force; that of a proxy does not grow with slopes. The guard does not see it.
    """
    limit, _, source = flight.ceilings[0]
    felt = np.array([flight.felt_n_per_m(each) for each in flight.probes.stiffness_n_per_m.tolist()])
    share, most = float(np.mean(~(felt <= MEASURED * limit))), float(felt.max())
    yield check_bound(
        *("slope", "too stiff", share, "<=", RARE, "share", source),
        worse="unsafe" if share > FEW else "warn",
        says=TOO_STIFF if most <= LEVEL * flight.stiffness_n_per_m else f"on slopes and textures {TOO_STIFF}",
        note=f"over {limit:.4g} N/m; up to {most:.4g} N/m, the median {np.median(felt):.4g} N/m",
        cure=_less_stiff(flight, limit, most),
    )


def _less_stiff(flight: Flight, limit: float, most: float) -> Cure:
    """Return the cures that are not yet applied, the least intrusive first."""
    level = flight.stiffness_n_per_m
    if most <= LEVEL * level:
        return soften(flight, limit)
    ways: list[Cure] = []
    if flight.present_materials and not flight.fitted:
        ways.append([FIT])
    if flight.safety.coupling is None:
        ways.append([COUPLE])
    if level > 0 and not flight.present_materials:
        softer = level * limit / most
        ways += [soften(flight, softer)] if softer >= SOFTEST_N_PER_M else _rounder(flight, limit / level)
    if flight.law_name != PROXY:
        ways.append(f"a force law that slopes do not stiffen, `render.use: {PROXY}`")
    if not ways:
        ways.append([flatten(flight, limit / most)])
    return join_cures(ways[0], *(part for way in ways[1:] for part in ("; or ", way)))


def _rounder(flight: Flight, times: float) -> list[Cure]:
    """Return the smoothing after which slopes make a penalty at most `times` as stiff as level ground, if any."""
    steepest = math.sqrt(max(times - 1, 0.0))
    change = round_off(flight, lambda relief: float(np.mean(slopes(relief) > steepest)) <= RARE)
    return [[change]] if change else []


def cliffs(flight: Flight) -> Iterator[Verdict]:
    """Check the shares of the surface that are walls, and that a stroke meets faster than a force may grow."""
    steep = slopes(flight.surface.relief)
    source = "over 45 degrees a hand pushes harder sideways than down"
    yield _gentle(flight, steep, "a wall", WALL, WALLS, source, "much of the surface is as steep as a wall")
    if flight.stiffness_n_per_m > 0:
        per_tick_n = flight.stiffness_n_per_m * flight.hand.speed_m_per_s * flight.period_s
        source = f"`safety.max_step_n`, {flight.max_step_n:.3g} N, at this speed"
        says = "a stroke meets slopes at which the force has to grow too fast"
        yield _gentle(flight, steep, "too sudden", flight.max_step_n / per_tick_n, FEW, source, says)


def _gentle(flight: Flight, steep: Slopes, of: str, bound: float, few: float, source: str, says: str) -> Verdict:
    """Check that only a few places are steeper than a bound."""
    share = float(np.mean(steep > np.float64(bound)))
    return check_bound(
        *("slope", of, share, "<=", few, "share", source),
        note=f"slope over {bound:.3g}; the steepest is {steep.max():.3g}",
        says=says,
        cure="" if share <= few else _gentler(flight, steep, bound, few),
    )


def _gentler(flight: Flight, steep: Slopes, bound: float, few: float) -> Cure:
    lower = flatten(flight, bound / float(np.quantile(steep, 1 - few, method="higher")))
    rounder = round_off(flight, lambda relief: float(np.mean(slopes(relief) > bound)) <= few)
    if rounder is None:
        return [lower]
    return [rounder, f", or {lower}" if isinstance(lower, str) else f", or a lower `{lower.key}`"]


def slopes(relief: Relief) -> Slopes:
    """Return the slope from each cell to its neighbours, the greater one of both sides; 0 for a single cell."""
    across, along = relief.pitch_m
    return np.hypot(_rise(relief.height_m.T).T / np.float32(across), _rise(relief.height_m) / np.float32(along))


def _rise(heights: Slopes) -> Slopes:
    """Return the greater step to the row before or after."""
    rise = np.zeros_like(heights)
    steps = np.abs(np.diff(heights, axis=0))
    rise[1:] = steps
    rise[:-1] = np.maximum(rise[:-1], steps)
    return rise
