"""The force of a tick behind its guard, for loops in Python."""

from collections.abc import Callable
from typing import Any, cast

import numpy as np

from ...compiled.touch import RISE_M, motion_array
from ...data import Force, HapticState
from ...plugins.interfaces import Touch
from ..guard import layout

# (state, seconds since the state before) -> the allowed force, and the sum of its `TickFlag`s.
GuardedForce = Callable[[HapticState, float], tuple[Force, int]]
# (seconds since the tick before) -> the force of a tick without a fresh state, and its flags.
HeldForce = Callable[[float], tuple[Force, int]]


def guard_touch(
    touch: Touch, settings: np.ndarray, memory: np.ndarray, beacon: tuple[np.ndarray, ...] | None = None
) -> GuardedForce:
    """Return a function that asks the touch for its force and passes on what the guard allows."""
    from ..guard import guard

    couple, allow = cast(Any, guard).couple, cast(Any, guard).guard
    moving = motion_array(touch)
    pull: Any = None
    if beacon is not None:
        from .. import beacon_kernels

        pull = cast(Any, beacon_kernels).pull

    def allowed_force(state: HapticState, period_s: float) -> tuple[Force, int]:
        device = *state.position_m, *state.velocity_m_per_s
        x, y, z, vx, vy, vz = couple(settings, memory, period_s, *device)
        law_force = touch.force(HapticState((x, y, z), (vx, vy, vz), state.time_s, state.buttons))
        memory[layout.RISE_M] = moving[RISE_M]
        flags = 0 if beacon is None else pull(*beacon, memory, period_s, x, y, vx, vy, state.buttons)
        fx, fy, fz, guard_flags = allow(settings, memory, period_s, *device, *law_force)
        return Force(fx, fy, fz), flags | guard_flags

    return allowed_force


def hold_force(settings: np.ndarray, memory: np.ndarray) -> HeldForce:
    """Return a function that passes on the last force of the same guard, and zero from `stale_s` on."""
    from ..guard import guard

    wait = cast(Any, guard).wait

    def held_force(period_s: float) -> tuple[Force, int]:
        fx, fy, fz, flags = wait(settings, memory, period_s)
        return Force(fx, fy, fz), flags

    return held_force
