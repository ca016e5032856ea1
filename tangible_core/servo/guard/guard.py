"""The compiled guard of every tick between force law and device: docs/explanation/safety.md. Imports numba.

A tick is `couple`, then the force law at the place it returns, then `guard`, whose force goes to the device. A tick
without a fresh position is `wait` instead of all three. The arrays are those of `Safety.arrays`.
"""

# pyright: basic

import numpy as np
from numba import float64, int64, types, void

from ...compiled.compiling import KERNEL, inner, njit
from ...data import TickFlag
from . import layout as at
from .coupling import READ, WRITTEN, tool_force
from .coupling import couple as couple
from .passivity import make_passive, rise_m
from .vectors import clip, zero_or_nan

TOUCHING, FORCE_LIMITED, SLEW_LIMITED, STIFFNESS_LIMITED, RAMPING, NOT_FINITE, DAMPED, STALE = map(
    int, [*TickFlag][: at.FLAGS]
)
# Shortest period that is used; a shorter one counts as this, as the clock stood still or went back.
SHORTEST_S = 1e-5
REMEMBERED = 128  # number of ticks over which the period is averaged
# Times in which the gain falls from 1 to 0 and rises back: a spring that stiffens under the hand does work on it.
SOFTER_IN_S, HARDER_IN_S = 0.05, 1.0
ENOUGH = 1.1  # hysteresis of the gain: it rises only if at least 10 % more is allowed

NEWTONS_AND_FLAGS = types.Tuple((float64, float64, float64, int64))


@inner(forceinline=True)
def _count(memory, flags):
    memory[at.COUNTS] += flags & TOUCHING
    if flags > TOUCHING:
        for bit in range(1, at.FLAGS):
            memory[at.COUNTS + bit] += (flags >> bit) & 1
    return flags


@inner(forceinline=True)
def _stop(memory, flag):
    """Return zero force and clear all memory that a fault may have corrupted; afterwards the force fades in again."""
    for i in range(3 * (at.MAX_DELAY + 1)):
        memory[at.HELD + i] = 0.0
    memory[at.FORCE] = memory[at.FORCE + 1] = memory[at.FORCE + 2] = 0.0
    _forget(memory)
    return 0.0, 0.0, 0.0, _count(memory, flag)


@inner(forceinline=True)
def _forget(memory):
    memory[at.PLACE] = memory[at.TOOL] = np.nan
    memory[at.RAMP] = memory[at.ENERGY_J] = 0.0
    memory[at.SURFACE_FORCE_N] = memory[at.LAST_RISE_M] = memory[at.GIVEN_J] = 0.0


@inner(forceinline=True)
def _gain(settings, memory, elapsed_s):
    """Return the gain at which the device renders the law's stiffness stably at the measured period.

    The period is E[T^2] / E[T], as a spring gains K v^2 T^2 / 2 of energy in a tick and damping takes b v^2 T. The gain
    changes slowly and rises only by a tenth or more, so that the stiffness neither jumps under the hand nor follows the
    jitter of the clock.
    """
    memory[at.MEAN_S] += (elapsed_s - memory[at.MEAN_S]) / REMEMBERED
    memory[at.MEAN_S2] += (elapsed_s * elapsed_s - memory[at.MEAN_S2]) / REMEMBERED
    stable = settings[at.STIFFNESS_TIMES_PERIOD] * memory[at.MEAN_S] / memory[at.MEAN_S2]
    stable = min(stable, settings[at.MAX_STIFFNESS])
    stiffness = settings[at.STIFFNESS] + memory[at.PULL_STIFFNESS]
    target = stable / stiffness if stiffness > stable else 1.0
    share = memory[at.GAIN]
    if target < share:
        memory[at.GAIN] = max(target, share - elapsed_s / SOFTER_IN_S)
    elif target >= 1.0 or target > ENOUGH * share:
        memory[at.GAIN] = min(target, share + elapsed_s / HARDER_IN_S)
    return memory[at.GAIN]


@inner(forceinline=True)
def _limit_slew(memory, step_n, fx, fy, fz):
    """Return the last force, moved towards this one by at most a step, and whether it falls short."""
    wx, wy, wz = memory[at.FORCE], memory[at.FORCE + 1], memory[at.FORCE + 2]
    dx, dy, dz, short = clip(fx - wx, fy - wy, fz - wz, step_n)
    return (wx + dx, wy + dy, wz + dz, True) if short else (fx, fy, fz, False)


@inner(forceinline=True)
def _surface_force(settings, law_n, before, fx, fy, fz):
    """Return the law's part along z of the limited force, by which a moving surface does work.

    before: the length of the force before it was limited. With a coupling, the force is that of the tool on the hand,
    but the surface moves under the tool and works by the law's force on it, of which the tool's leash passes on at most
    the greatest force.
    """
    if settings[at.COUPLING] <= 0.0:
        return fz
    if not before > 0.0:
        return 0.0
    most = settings[at.MAX_FORCE_N]
    return min(max(law_n * np.sqrt(fx * fx + fy * fy + fz * fz) / before, -most), most)


@inner(forceinline=True)
def _store_surface_force(memory, elapsed_s, surface_n, late, fz):
    """Store the law's part along z of the sent force: faded in, and at most the sent force if the slew was limited."""
    surface_n *= memory[at.RAMP]
    if late & SLEW_LIMITED:
        surface_n = min(max(fz, min(surface_n, 0.0)), max(surface_n, 0.0))
    memory[at.SURFACE_FORCE_N], memory[at.LAST_RISE_M] = surface_n, rise_m(memory, elapsed_s)


@inner(forceinline=True)
def _store(settings, memory, fx, fy, fz):
    """Store this force as the last one, and among the delayed ones."""
    memory[at.FORCE], memory[at.FORCE + 1], memory[at.FORCE + 2] = fx, fy, fz
    slot = at.HELD + 3 * int(memory[at.SLOT])
    memory[slot], memory[slot + 1], memory[slot + 2] = fx, fy, fz
    memory[at.SLOT] = 0.0 if memory[at.SLOT] >= settings[at.DELAY] else memory[at.SLOT] + 1.0


@inner(forceinline=True)
def _limit(settings, memory, elapsed_s, touching, fx, fy, fz):
    """Return the force, scaled to a stable stiffness and clipped to the maximum, and its flags."""
    flags = 0
    share = _gain(settings, memory, elapsed_s)
    if share < 1.0 and touching:
        fx, fy, fz, flags = share * fx, share * fy, share * fz, STIFFNESS_LIMITED
    fx, fy, fz, over = clip(fx, fy, fz, settings[at.MAX_FORCE_N])
    return fx, fy, fz, flags | FORCE_LIMITED if over else flags


@inner(forceinline=True)
def _fade_in(settings, memory, elapsed_s, fx, fy, fz):
    """Return the force, faded in and at most a step from the last force, and its flags."""
    flags = 0
    share = min(memory[at.RAMP] + elapsed_s * settings[at.RAMP_PER_S], 1.0)
    memory[at.RAMP] = share
    if share < 1.0:
        fx, fy, fz, flags = share * fx, share * fy, share * fz, RAMPING
    fx, fy, fz, short = _limit_slew(memory, settings[at.MAX_STEP_N] * min(1000.0 * elapsed_s, 1.0), fx, fy, fz)
    return fx, fy, fz, flags | SLEW_LIMITED if short else flags


@njit(NEWTONS_AND_FLAGS(READ, WRITTEN, *[float64] * 10), **KERNEL)
def guard(settings, memory, period_s, x, y, z, vx, vy, vz, fx, fy, fz):
    """Return the allowed part of the law's force at a fresh position of the device, and the flags of this tick.

    The force is always finite, never over the maximum, and never more than a step from the last one; but it is zero at
    once if the state is not finite or came too late. The pull of a beacon, which `beacon_kernels.pull` left in the
    memory, is added to the law's force; the flag TOUCHING is about the law alone.
    period_s: time since the last `guard` or `wait`.
    """
    elapsed_s = memory[at.AGE_S] + period_s
    memory[at.AGE_S] = 0.0
    # Zero times a number is zero, or NaN if the number is not finite: one test for ten numbers. None of the comparisons
    # below would stop a NaN.
    if zero_or_nan(x, y, z) + zero_or_nan(vx, vy, vz) + zero_or_nan(fx, fy, fz) + 0.0 * elapsed_s != 0.0:
        return _stop(memory, NOT_FINITE)
    if elapsed_s > settings[at.STALE_S]:
        return _stop(memory, STALE)
    elapsed_s = max(elapsed_s, SHORTEST_S)
    touching = fx != 0.0 or fy != 0.0 or fz != 0.0
    acts = touching
    if memory[at.PULL] != 0.0 or memory[at.PULL + 1] != 0.0:
        fx, fy, acts = fx + memory[at.PULL], fy + memory[at.PULL + 1], True
    law_n, before = fz, 0.0
    # The order matters: the coupling replaces the law's force, the limits bound it, passivity judges what is left, and
    # the fade-in comes last, since it only takes away.
    if settings[at.COUPLING] > 0.0:
        fx, fy, fz = tool_force(settings, memory, x, y, z, vx, vy, vz, fx, fy, fz)
        before = np.sqrt(fx * fx + fy * fy + fz * fz)
    fx, fy, fz, soft = _limit(settings, memory, elapsed_s, acts, fx, fy, fz)
    surface_n = _surface_force(settings, law_n, before, fx, fy, fz)
    brakes = False
    if settings[at.BRAKE] > 0.0:
        fx, fy, fz, brakes = make_passive(settings, memory, elapsed_s, acts, surface_n, x, y, z, vx, vy, vz, fx, fy, fz)
    fx, fy, fz, late = _fade_in(settings, memory, elapsed_s, fx, fy, fz)
    _store_surface_force(memory, elapsed_s, surface_n, late, fz)
    _store(settings, memory, fx, fy, fz)
    return fx, fy, fz, _count(memory, touching * TOUCHING | soft | brakes * DAMPED | late)


@njit(NEWTONS_AND_FLAGS(READ, WRITTEN, float64), **KERNEL)
def wait(settings, memory, period_s):
    """Return the last force for a tick without a fresh position; zero from `stale_s` on, or if the clock is broken."""
    memory[at.AGE_S] += period_s if period_s >= 0.0 else np.inf
    if not memory[at.AGE_S] <= settings[at.STALE_S]:
        return _stop(memory, STALE)
    return memory[at.FORCE], memory[at.FORCE + 1], memory[at.FORCE + 2], 0


@njit(void(WRITTEN), **KERNEL)
def restart(memory):
    """Fade the force in again from its last value, on another scene or after homing."""
    _forget(memory)
