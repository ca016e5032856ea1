"""A handle under a force law, tick by tick, compiled. Imports numba: `simulated_handle` imports it late."""


# pyright: basic

from inspect import unwrap

import numpy as np
from numba import float64, njit, types

from tangible_bench.metrics.stability import advance
from tangible_core.compiled import compiling as compiling
from tangible_core.compiled.touch import RISE_M
from tangible_core.servo.guard import layout
from tangible_core.servo.guard.guard import couple, guard

_advance = njit(cache=True, nogil=True, error_model="numpy")(unwrap(advance))  # without the checks of tests


@njit(types.UniTuple(float64, 3)(float64, *[float64] * 6), cache=True, nogil=True, error_model="numpy")
def wall(stiffness_n_per_m, x, y, z, vx, vy, vz):
    """Return the force of a spring below z = 0, and none above it."""
    return 0.0, 0.0, -stiffness_n_per_m * min(z, 0.0)


@njit(cache=True, nogil=True, error_model="numpy")
def _move(at, speed, force, mass, damping, period_s):
    """Return place and speed after a period under a constant force, and the energy lost in the damper; exact."""
    steady, decay = force / damping, np.exp(-damping * period_s / mass)
    settling_s, off = (1.0 - decay) * mass / damping, speed - steady
    lost = damping * (
        steady * steady * period_s + 2.0 * steady * off * settling_s + off * off * settling_s * (1.0 + decay) / 2.0
    )
    place, later = _advance(at, speed, force, damping, period_s, decay, settling_s)
    return place, later, lost


@njit(cache=True, nogil=True, error_model="numpy")
def _measure(resolution_m, at):
    return np.rint(at / resolution_m) * resolution_m if resolution_m > 0.0 else at


@njit(cache=True, nogil=True, error_model="numpy")
def ride(
    tick,
    fixed,
    moving,
    settings,
    memory,
    periods_s,
    body,
    push_n,
    delay,
    resolution_m,
    state,
    place,
    sent,
    work_j,
    lost_j,
):
    """Fill a row a tick: the place that the encoder reports, the force sent, and the energies until then.

    body: mass and damping. state: (6,), position and velocity at the start, overwritten by those at the end. settings:
    empty for no guard. The force of a tick acts from `delay` ticks later on, the first one at once as well.
    """
    work = lost = 0.0
    for i in range(periods_s.size):
        for axis in range(3):
            place[i, axis] = _measure(resolution_m, state[axis])
        before, period_s = max(i - 1, 0), periods_s[max(i - 1, 0)]
        x, y, z = place[i, 0], place[i, 1], place[i, 2]
        vx, vy, vz = (
            (x - place[before, 0]) / period_s,
            (y - place[before, 1]) / period_s,
            (z - place[before, 2]) / period_s,
        )
        if settings.size:
            at = couple(settings, memory, period_s, x, y, z, vx, vy, vz)
            fx, fy, fz = tick(*fixed, *at)
            memory[layout.RISE_M] = moving[RISE_M]
            fx, fy, fz, _ = guard(settings, memory, period_s, x, y, z, vx, vy, vz, fx, fy, fz)
        else:
            fx, fy, fz = tick(*fixed, x, y, z, vx, vy, vz)
        sent[i, 0], sent[i, 1], sent[i, 2] = fx, fy, fz
        work_j[i], lost_j[i] = work, lost
        for axis in range(3):
            acting = sent[max(i - delay, 0), axis]
            at_axis, speed, taken = _move(
                state[axis], state[3 + axis], acting + push_n[axis], body[0], body[1], periods_s[i]
            )
            work += acting * (at_axis - state[axis])
            lost += taken
            state[axis], state[3 + axis] = at_axis, speed
