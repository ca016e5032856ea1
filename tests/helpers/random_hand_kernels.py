"""A random hand on a failing device, compiled. Imports numba: `test_every_law.py` imports it late."""


# ruff: noqa: NPY002 -- a generator would have to be handed in
# pyright: basic

import math

import numpy as np
from numba import njit

from tangible_core.compiled.compiling import KERNEL

PERIOD_S = 0.001
FASTEST_M = 0.0005
"""A tick's step at 0.5 m/s."""
LEAP, BREAK, TURN = 1 / 2000, 1 / 1000, 1 / 300
"""Probabilities a tick of a leap of the hand, of a broken state, and of another speed."""
SETTLED = 20
"""Ticks after a leap from which on the nearest point must be found again."""
NOT_FINITE, BROKEN_PUSHED, GREATEST_N, GAIN_J, LOST, TOUCHED = range(6)


@njit(**KERNEL)
def walk(fixed, law, ticks, seed, half_m, low_m, high_m, stiffness, ball, work, found):
    """Move the hand and fill `found`, in the order of NOT_FINITE to TOUCHED.

    half_m: half the width and length; ball: its radius and its centre's z, radius 0 without a ball; work: (5, 6).
    """
    np.random.seed(seed)
    hand, speed, step, was, state = work[0], work[1], work[2], work[3], work[4]
    fastest, since = FASTEST_M, -1
    for _ in range(ticks):
        if np.random.random() < TURN:
            fastest = FASTEST_M * 10.0 ** -np.random.randint(0, 4)
        since += 1
        if np.random.random() < LEAP:
            since = 0
            for i in range(2):
                hand[i] = 1.05 * half_m[i] * (2.0 * np.random.random() - 1.0)
            hand[2] = low_m + (high_m - low_m) * np.random.random()
        else:
            _move(hand, speed, step, fastest, half_m, low_m, high_m)
        broken = np.random.random() < BREAK
        if broken:
            since = -1
        fx, fy, fz = _feel(fixed, law, hand, step, broken, state)
        size = math.sqrt(_dot(fx, fy, fz, fx, fy, fz))
        if not np.isfinite(size):
            found[NOT_FINITE] += 1.0
            continue
        found[BROKEN_PUSHED] += broken and size > 0.0
        found[GREATEST_N] = max(found[GREATEST_N], size)
        found[TOUCHED] += size > 0.0
        if since > 0:
            found[GAIN_J] = max(found[GAIN_J], _gain(was, step, size, stiffness))
        if since > SETTLED and ball[0] > 0.0:
            found[LOST] += _off(hand, half_m, fx, fy, fz, stiffness, ball)
        was[0], was[1], was[2] = fx, fy, fz


@njit(**KERNEL)
def _dot(ax, ay, az, bx, by, bz):
    return ax * bx + ay * by + az * bz


@njit(**KERNEL)
def _gain(was, step, size, stiffness):
    """Return the energy that a spring gained over a step beyond the hand's work, under the force held in that step.

    A spring whose far end rests while the hand moves gains k |step|^2 / 2 by the servo's sampling alone, which is
    subtracted.
    """
    before = _dot(was[0], was[1], was[2], was[0], was[1], was[2])
    given = _dot(was[0], was[1], was[2], step[0], step[1], step[2])
    held = _dot(step[0], step[1], step[2], step[0], step[1], step[2])
    return (size * size - before) / (2.0 * stiffness) + given - 0.5 * stiffness * held


@njit(**KERNEL)
def _move(hand, speed, step, fastest, half_m, low_m, high_m):
    """Move the hand smoothly; it stops at the borders, a little over the sides, and between low_m and high_m."""
    for i in range(3):
        speed[i] = 0.97 * speed[i] + 0.06 * fastest * (2.0 * np.random.random() - 1.0)
        low, high = (low_m, high_m) if i == 2 else (-1.05 * half_m[i], 1.05 * half_m[i])
        if not low < hand[i] + speed[i] < high:
            speed[i] = 0.0
        step[i] = speed[i]
        hand[i] += step[i]


@njit(**KERNEL)
def _feel(fixed, law, hand, step, broken, state):
    """Return the force; the velocity is that of a clock that jitters fivefold either way."""
    rate = 5.0 ** (2.0 * np.random.random() - 1.0) / PERIOD_S
    for i in range(3):
        state[i], state[3 + i] = hand[i], rate * step[i]
    if broken:
        kind = np.random.randint(0, 3)
        bad = np.nan if kind == 0 else np.inf if kind == 1 else -np.inf
        state[np.random.randint(0, 6)] = bad
    return law(*fixed, state[0], state[1], state[2], state[3], state[4], state[5])


@njit(**KERNEL)
def _off(hand, half_m, fx, fy, fz, stiffness, ball):
    """Test whether the force differs from the spring to the ball by more than a micrometre, well inside the surface."""
    up = hand[2] - ball[1]
    away = math.sqrt(hand[0] * hand[0] + hand[1] * hand[1] + up * up)
    depth = ball[0] - away
    if not 1e-6 < depth < 0.002 or abs(hand[0]) > 0.8 * half_m[0] or abs(hand[1]) > 0.8 * half_m[1]:
        return False
    push = stiffness * depth / away
    off = math.sqrt((fx - push * hand[0]) ** 2 + (fy - push * hand[1]) ** 2 + (fz - push * up) ** 2)
    return off > 1e-6 * stiffness
