"""Gather the input of the checks: probe the touch, and time it and this machine. No device is opened."""

import math

import numpy as np
from jaxtyping import Float64

from ..data import HapticSurface
from ..errors import BrokenMethod
from ..plugins.interfaces import ForceRenderer, HapticDevice, Touch
from ..plugins.naming import plugin_name
from ..scene.geometry import workspace_to_picture
from ..servo.guard.stiffness import stiffness_of
from .flight import Flight, Hand, Loop, Settings
from .probes import Probes, probe
from .strokes import stroke
from .timing import TICKS, measure_lateness, measure_ticks


def survey(
    surface: HapticSurface,
    touch: Touch,
    law: ForceRenderer,
    device: HapticDevice,
    settings: Settings | None = None,
    *,
    hand: Hand | None = None,
    loop: Loop | None = None,
) -> Flight:
    """Gather facts and measurements of a surface and its touch under a force law, on a device that is not opened.

    Takes `loop.seconds`, in which this machine's lateness is measured, and a moment more.
    Raises: BrokenMethod if the touch gives a force that is not finite, as a bound cannot be computed then.
    """
    settings, hand, loop = settings or Settings(), hand or Hand(), loop or Loop()
    period_s, spec = loop.period_s, device.spec()
    stiffness = stiffness_of(touch, spec).n_per_m
    probes = probe(touch, surface, hand.press_n, stiffness, spec.workspace_m[2], period_s)
    _check_finite(law, probes)
    return Flight(
        surface=surface,
        law=law,
        stiffness_n_per_m=stiffness,
        spec=spec,
        settings=settings,
        hand=hand,
        period_s=period_s,
        probes=probes,
        strokes=stroke(touch, surface, hand.press_n, hand.speed_m_per_s, period_s),
        lateness=measure_lateness(loop.seconds, period_s),
        cost=measure_ticks(touch, _stroke(surface, probes, hand.speed_m_per_s * period_s), period_s),
    )


def _check_finite(law: ForceRenderer, probes: Probes) -> None:
    values = (probes.force_n.sum(axis=1), probes.onset_n, probes.stiffness_n_per_m, probes.damping_n_s_per_m)
    broken = ~np.isfinite(values).all(axis=0)
    if broken.any():
        who = plugin_name("render", type(law).__module__, type(law).__qualname__)
        raise BrokenMethod(
            f"{who}: force gave values that are not finite at {np.count_nonzero(broken)} of {broken.size} places of "
            "the surface; a force is always finite, as `tangible check` tests"
        )


def _stroke(surface: HapticSurface, probes: Probes, step_m: float) -> Float64[np.ndarray, "n 3"]:
    """Return a path to and fro over the surface, at the median depth of the probes."""
    (width_m, length_m), shape = surface.extent_m, surface.height_m.shape
    way_m = np.arange(TICKS) * step_m
    x, y = _to_and_fro(way_m, width_m), _to_and_fro(way_m / math.e, length_m)
    column, row = workspace_to_picture(x, y, shape, surface.extent_m)
    heights = surface.height_m[np.rint(row).astype(int), np.rint(column).astype(int)]
    return np.column_stack([x, y, heights - np.median(probes.depth_m)])


def _to_and_fro(way_m: np.ndarray, length_m: float) -> np.ndarray:
    """Return positions on a way to and fro, from the middle of a length, without its outermost thousandths."""
    turns = way_m / (2 * length_m) + 0.25
    return 0.999 * length_m * (np.abs(2 * (turns - np.floor(turns)) - 1) - 0.5)
