"""What every tick passes between a law and a device, compiled; docs/safety.md says why. Imports numba.

A tick is `couple`, then the law at the place that came out, then `guard`, whose force goes to the device. A tick
without a fresh position is `wait` instead of all three. The arrays are those of `Safety.arrays`.
"""

# ruff: noqa: ANN001, ANN201, ANN202 -- the types are in the signatures that numba compiles
# pyright: basic

import numpy as np
from numba import float64, int64, njit, types, void

from ...compiled.compiling import KERNEL, inner
from ...data import TickFlag
from . import layout as at
from .coupling import READ, WRITTEN, pull
from .coupling import couple as couple
from .passivity import passive, rise_m
from .vectors import nought, shortened

TOUCHING, FORCE_LIMITED, SLEW_LIMITED, STIFFNESS_LIMITED, RAMPING, NOT_FINITE, DAMPED, STALE = map(
    int, [*TickFlag][: at.FLAGS]
)
SHORTEST_S = 1e-5
"""A period below this counts as this."""
REMEMBERED = 128
"""Ticks over which the period is averaged."""
SOFTER_IN_S, HARDER_IN_S = 0.05, 1.0
"""How long the softening takes from none to all, and back: making a spring harder under the hand does work on it."""
ENOUGH = 1.1
"""Times the share that must be allowed before it rises."""

NEWTONS_AND_FLAGS = types.Tuple((float64, float64, float64, int64))


@inner(forceinline=True)
def _count(memory, flags):
    """The flags, each counted."""
    memory[at.COUNTS] += flags & TOUCHING
    if flags > TOUCHING:
        for bit in range(1, at.FLAGS):
            memory[at.COUNTS + bit] += (flags >> bit) & 1
    return flags


@inner(forceinline=True)
def _stop(memory, flag):
    """Zero at once, and nothing remembered that a fault may have touched; the force fades in again."""
    for i in range(3 * (at.MOST_DELAY + 1)):
        memory[at.HELD + i] = 0.0
    memory[at.FORCE] = memory[at.FORCE + 1] = memory[at.FORCE + 2] = 0.0
    _forget(memory)
    return 0.0, 0.0, 0.0, _count(memory, flag)


@inner(forceinline=True)
def _forget(memory):
    memory[at.PLACE] = memory[at.TOOL] = np.nan
    memory[at.RAMP] = memory[at.ENERGY_J] = 0.0
    memory[at.LIFT_N] = memory[at.ROSE_M] = memory[at.GIVEN_J] = 0.0


@inner(forceinline=True)
def _softness(settings, memory, elapsed_s):
    """Share of the law's force that makes its stiffness one which is held stably at the measured period.

    The period is E[T^2] / E[T]: what a spring gives away in one is K v^2 T^2 / 2, what damping takes b v^2 T. The share
    moves slowly, and not up for less than a tenth: no stiffness jumps under the hand, nor follows a restless clock.
    """
    memory[at.MEAN_S] += (elapsed_s - memory[at.MEAN_S]) / REMEMBERED
    memory[at.MEAN_S2] += (elapsed_s * elapsed_s - memory[at.MEAN_S2]) / REMEMBERED
    held = settings[at.STIFFNESS_TIMES_PERIOD] * memory[at.MEAN_S] / memory[at.MEAN_S2]
    held = min(held, settings[at.MAX_STIFFNESS])
    stiffness = settings[at.STIFFNESS] + memory[at.PULL_STIFFNESS]
    wanted = held / stiffness if stiffness > held else 1.0
    share = memory[at.SOFTNESS]
    if wanted < share:
        memory[at.SOFTNESS] = max(wanted, share - elapsed_s / SOFTER_IN_S)
    elif wanted >= 1.0 or wanted > ENOUGH * share:
        memory[at.SOFTNESS] = min(wanted, share + elapsed_s / HARDER_IN_S)
    return memory[at.SOFTNESS]


@inner(forceinline=True)
def _slewed(memory, step_n, fx, fy, fz):
    """From the last force towards this one by at most a step, and whether that is short of it."""
    wx, wy, wz = memory[at.FORCE], memory[at.FORCE + 1], memory[at.FORCE + 2]
    dx, dy, dz, short = shortened(fx - wx, fy - wy, fz - wz, step_n)
    return (wx + dx, wy + dy, wz + dz, True) if short else (fx, fy, fz, False)


@inner(forceinline=True)
def _lift(settings, law_n, before, fx, fy, fz):
    """The law's part along z of a force that is safe; before: the length that it had before it was.

    A coupling's force is the tool's on the hand; the surface moves under the tool, and works by the law's force on it,
    of which the tool's leash hands on no more than the greatest.
    """
    if settings[at.COUPLING] <= 0.0:
        return fz
    if not before > 0.0:
        return 0.0
    most = settings[at.MAX_FORCE_N]
    return min(max(law_n * np.sqrt(fx * fx + fy * fy + fz * fz) / before, -most), most)


@inner(forceinline=True)
def _keep_lift(memory, elapsed_s, lift, late, fz):
    """The law's part along z of the force that leaves, faded in as that; of one held back, no more than what left."""
    lift *= memory[at.RAMP]
    if late & SLEW_LIMITED:
        lift = min(max(fz, min(lift, 0.0)), max(lift, 0.0))
    memory[at.LIFT_N], memory[at.ROSE_M] = lift, rise_m(memory, elapsed_s)


@inner(forceinline=True)
def _keep(settings, memory, fx, fy, fz):
    """This force is the last one, and on its way."""
    memory[at.FORCE], memory[at.FORCE + 1], memory[at.FORCE + 2] = fx, fy, fz
    slot = at.HELD + 3 * int(memory[at.SLOT])
    memory[slot], memory[slot + 1], memory[slot + 2] = fx, fy, fz
    memory[at.SLOT] = 0.0 if memory[at.SLOT] >= settings[at.DELAY] else memory[at.SLOT] + 1.0


@inner(forceinline=True)
def _safe(settings, memory, elapsed_s, touching, fx, fy, fz):
    """Soft enough to be held stably, and not over the maximum; with flags."""
    flags = 0
    share = _softness(settings, memory, elapsed_s)
    if share < 1.0 and touching:
        fx, fy, fz, flags = share * fx, share * fy, share * fz, STIFFNESS_LIMITED
    fx, fy, fz, over = shortened(fx, fy, fz, settings[at.MAX_FORCE_N])
    return fx, fy, fz, flags | FORCE_LIMITED if over else flags


@inner(forceinline=True)
def _gentle(settings, memory, elapsed_s, fx, fy, fz):
    """Faded in, and at most a step from the last force; with flags."""
    flags = 0
    share = min(memory[at.RAMP] + elapsed_s * settings[at.RAMP_PER_S], 1.0)
    memory[at.RAMP] = share
    if share < 1.0:
        fx, fy, fz, flags = share * fx, share * fy, share * fz, RAMPING
    fx, fy, fz, short = _slewed(memory, settings[at.MAX_STEP_N] * min(1000.0 * elapsed_s, 1.0), fx, fy, fz)
    return fx, fy, fz, flags | SLEW_LIMITED if short else flags


@njit(NEWTONS_AND_FLAGS(READ, WRITTEN, *[float64] * 10), **KERNEL)
def guard(settings, memory, period_s, x, y, z, vx, vy, vz, fx, fy, fz):
    """What may leave of the law's force at a fresh position of the device, and the flags of this tick.

    period_s: since the last `guard` or `wait`. Always finite, never over the maximum, and never more than a step from
    the last force, except that a state that is not finite or came too late is zero force at once. A beacon's pull,
    which `beacon_kernels.pull` left in the memory, joins the law's force; TOUCHING tells of the law alone.
    """
    elapsed_s = memory[at.AGE_S] + period_s
    memory[at.AGE_S] = 0.0
    if nought(x, y, z) + nought(vx, vy, vz) + nought(fx, fy, fz) + 0.0 * elapsed_s != 0.0:
        return _stop(memory, NOT_FINITE)
    if elapsed_s > settings[at.STALE_S]:
        return _stop(memory, STALE)
    elapsed_s = max(elapsed_s, SHORTEST_S)
    touching = fx != 0.0 or fy != 0.0 or fz != 0.0
    acts = touching
    if memory[at.PULL] != 0.0 or memory[at.PULL + 1] != 0.0:
        fx, fy, acts = fx + memory[at.PULL], fy + memory[at.PULL + 1], True
    law_n, before = fz, 0.0
    if settings[at.COUPLING] > 0.0:
        fx, fy, fz = pull(settings, memory, x, y, z, vx, vy, vz, fx, fy, fz)
        before = np.sqrt(fx * fx + fy * fy + fz * fz)
    fx, fy, fz, soft = _safe(settings, memory, elapsed_s, acts, fx, fy, fz)
    lift = _lift(settings, law_n, before, fx, fy, fz)
    braked = False
    if settings[at.BRAKE] > 0.0:
        fx, fy, fz, braked = passive(settings, memory, elapsed_s, acts, lift, x, y, z, vx, vy, vz, fx, fy, fz)
    fx, fy, fz, late = _gentle(settings, memory, elapsed_s, fx, fy, fz)
    _keep_lift(memory, elapsed_s, lift, late, fz)
    _keep(settings, memory, fx, fy, fz)
    return fx, fy, fz, _count(memory, touching * TOUCHING | soft | braked * DAMPED | late)


@njit(NEWTONS_AND_FLAGS(READ, WRITTEN, float64), **KERNEL)
def wait(settings, memory, period_s):
    """A tick that found no fresh position: the last force, or zero from `stale_s` on or by a clock that is broken."""
    memory[at.AGE_S] += period_s if period_s >= 0.0 else np.inf
    if not memory[at.AGE_S] <= settings[at.STALE_S]:
        return _stop(memory, STALE)
    return memory[at.FORCE], memory[at.FORCE + 1], memory[at.FORCE + 2], 0


@njit(void(WRITTEN), **KERNEL)
def restart(memory):
    """For the first tick on another scene, or after homing: the force fades in again, from what it is."""
    _forget(memory)
