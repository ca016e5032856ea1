"""Replay of a recording: the same states, tick by tick, through any touch."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, cast

import numpy as np

from ...compiled.touch import CompiledTouch
from ...data import UNTOUCHED, HapticState, TickFlag
from ...metrics.forces import force_errors
from ...plugins.interfaces import Touch
from .recording import Recording
from .tick_arrays import ARRAYS

NOWHERE = (math.nan, math.nan, math.nan)
"""Place of a proxy that does not exist."""


def replay(touch: Touch, recording: Recording) -> Recording:
    """Return the recording of this touch for each recorded state, with recorded velocities and times.

    Forces are the law's own, without limits, as no device moves. Proxy and flags are the law's too.
    """
    proxy_m, force_n = np.full((2, len(recording.rows), 3), np.nan)
    if isinstance(touch, CompiledTouch):
        from ...compiled import kernels

        law = touch.address(), touch.fixed, touch.memory
        states = np.hstack([recording.position_m, recording.velocity_m_per_s])
        cast(Any, kernels).over_states(*law, states, proxy_m, force_n)
    else:
        for i, (time_s, _, x, y, z, vx, vy, vz, *_, buttons, _) in enumerate(recording.rows.tolist()):
            force_n[i] = touch.force(HapticState((x, y, z), (vx, vy, vz), time_s, int(buttons)))
    rows = recording.rows.copy()
    rows[:, ARRAYS["proxy_m"]], rows[:, ARRAYS["force_n"]] = proxy_m, force_n
    rows[:, ARRAYS["flags"]] = TickFlag.TOUCHING * force_n.any(axis=1)
    rows[:, ARRAYS["frame"]] = np.nan
    return replace(recording, rows=rows)


def proxy_of(touch: Touch) -> Callable[[], tuple[float, ...]]:
    """Return a function that returns the present place of a touch's proxy; NaN if there is none."""
    if not isinstance(touch, CompiledTouch):
        return lambda: NOWHERE
    at = touch.memory[:3]

    def proxy() -> tuple[float, ...]:
        place = tuple(at.tolist())
        return NOWHERE if math.isnan(place[2]) else place

    return proxy


def unaltered_forces(recording: Recording) -> np.ndarray:
    """Return the recorded forces, NaN where a force was not the law's own on the surface at its start.

    Such forces were limited, faded in, damped or zero for a fault; or the surface had moved.
    """
    changed = (recording.flags & ~int(UNTOUCHED) != 0) | (recording.frame > 0)
    return np.where(changed[:, None], np.nan, recording.force_n)


def compare_replay(before: Recording, after: Recording) -> dict[str, float]:
    """Compare replayed forces with recorded ones of the same states, in figures by name."""
    truth_n = unaltered_forces(before)
    then, now = before.figures(), after.figures()
    worst_n = np.linalg.norm(after.force_n - truth_n, axis=1)
    return {
        "ticks": then["ticks"],
        "compared": int(np.isfinite(worst_n).sum()),
        **force_errors(after.force_n, truth_n),
        "worst_error_n": float(np.nanmax(worst_n, initial=0.0)),
        "recorded_peak_force_n": then["peak_force_n"],
        "peak_force_n": now["peak_force_n"],
        "recorded_contact_share": then["contact_share"],
        "contact_share": now["contact_share"],
    }
