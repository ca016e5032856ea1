"""A law and its guard, for loops that are Python's."""

from collections.abc import Callable
from typing import Any, cast

import numpy as np

from ...compiled.touch import RISE_M, moving_of
from ...data import Force, HapticState
from ...plugins.interfaces import Touch
from . import layout

Guarded = Callable[[HapticState, float], tuple[Force, int]]
"""(state, seconds since the one before) -> the force that may leave, and the sum of its `TickFlag`s."""


def guarded(
    touch: Touch,
    settings: np.ndarray,
    memory: np.ndarray,
    pull: Callable[[float, float, float, float, float, int], int] | None = None,
) -> Guarded:
    """What asks a law for its force and lets through what its guard, with the arrays of `Safety.arrays`, allows.

    pull: what a beacon does in a tick (`pulling`), whose force joins the law's.
    """
    from . import guard

    couple, allow = cast(Any, guard).couple, cast(Any, guard).guard
    moving = moving_of(touch)

    def allowed(state: HapticState, period_s: float) -> tuple[Force, int]:
        device = *state.position_m, *state.velocity_m_per_s
        x, y, z, vx, vy, vz = couple(settings, memory, period_s, *device)
        wanted = touch.force(HapticState((x, y, z), (vx, vy, vz), state.time_s, state.buttons))
        memory[layout.RISE_M] = moving[RISE_M]
        pulled = pull(period_s, x, y, vx, vy, state.buttons) if pull is not None else 0
        fx, fy, fz, flags = allow(settings, memory, period_s, *device, *wanted)
        return Force(fx, fy, fz), flags | pulled

    return allowed
