"""A force law behind its guard, for loops in Python."""

from collections.abc import Callable
from typing import Any, cast

import numpy as np

from ...compiled.touch import RISE_M, moving_of
from ...data import Force, HapticState
from ...plugins.interfaces import Touch
from . import layout

Guarded = Callable[[HapticState, float], tuple[Force, int]]
"""(state, seconds since the state before) -> the allowed force, and the sum of its `TickFlag`s."""


def guarded(
    touch: Touch,
    settings: np.ndarray,
    memory: np.ndarray,
    pull: Callable[[float, float, float, float, float, int], int] | None = None,
) -> Guarded:
    """Return a function that asks the force law for its force and passes on what the guard allows.

    settings, memory: the arrays of `Safety.arrays`. pull: a beacon's tick (`pulling`), whose force is added to the
    law's.
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
