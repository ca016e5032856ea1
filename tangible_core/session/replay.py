"""A recording felt again: the same states, tick by tick, through any touch."""

import math
from collections.abc import Callable
from dataclasses import replace
from typing import Any, cast

import numpy as np

from ..compiled.touch import CompiledTouch
from ..data import UNTOUCHED, HapticState, TickFlag
from ..metrics.forces import force_errors
from ..plugins.interfaces import Touch
from .recording import Recording
from .tick_arrays import ARRAYS

NOWHERE = (math.nan, math.nan, math.nan)


def replay(touch: Touch, recording: Recording) -> Recording:
    """What this touch gives for each recorded state, velocity and time as they were recorded.

    Forces are the law's own: nothing limits them, as nothing is pushed. Proxy and flags are the law's too.
    """
    proxy_m, force_n = np.full((2, len(recording.rows), 3), np.nan)
    if isinstance(touch, CompiledTouch):
        from ..compiled import kernels

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
    """What tells where the proxy of a touch is, whenever it is asked: NaN where there is none."""
    if not isinstance(touch, CompiledTouch):
        return lambda: NOWHERE
    at = touch.memory[:3]

    def proxy() -> tuple[float, ...]:
        place = tuple(at.tolist())
        return NOWHERE if math.isnan(place[2]) else place

    return proxy


def undisturbed(recording: Recording) -> np.ndarray:
    """Recorded forces, NaN at ticks whose force was not the law's own on the surface as it was at first.

    That is limited, faded in, damped, none for a fault; or on a surface that had moved.
    """
    changed = (recording.flags & ~int(UNTOUCHED) != 0) | (recording.frame > 0)
    return np.where(changed[:, None], np.nan, recording.force_n)


def compared(before: Recording, after: Recording) -> dict[str, float]:
    """How far replayed forces are from the recorded ones, in numbers, by name; both have the same states."""
    truth_n = undisturbed(before)
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
