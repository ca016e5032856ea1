"""The force of a texture at a point, compiled. Imports numba, so import this module inside the verb that needs it."""

import math

import numpy as np
from numba import float64, int64, types

from tangible_core.compiled import KERNEL, inner, njit

from .heights import COSINE, SINE, TEXTURES, remaining, series, texture_height
from .table import DRAG, DYNAMIC, PER_M, STIFFNESS, SWING

STATE = 7  # length of a contact's state, which starts as zeros for each contact point
_TURNS = np.arange(1, 5)
_SHAPE = np.sinc(_TURNS / 5) / _TURNS
_REACH = float(np.max(np.einsum("n,ni->i", _SHAPE, np.sin(np.outer(_TURNS, np.linspace(0, math.pi, 1000))))))
HARMONICS = tuple(float(amplitude) / _REACH for amplitude in _SHAPE)
"""Amplitudes of a sawtooth from -1 to 1, with Lanczos' factors against overshoot."""

_X, _Y, _BRISTLE_X, _BRISTLE_Y, _PHASE, _LEVEL, _OWNER = range(STATE)


@inner()
def _sawtooth(phase, turns):
    """Return a sawtooth, from -1 to 1 over a turn, of a few harmonics, each attenuated where it is undersampled."""
    half = phase - math.floor(phase + 0.5)
    half_sine, half_cosine = half * series(SINE, half * half), series(COSINE, half * half)
    sine, cosine = 2.0 * half_sine * half_cosine, 1.0 - 2.0 * half_sine * half_sine
    before, total = 0.0, 0.0
    for n in range(len(HARMONICS)):
        total -= HARMONICS[n] * remaining((n + 1) * turns) * sine
        before, sine = sine, 2.0 * cosine * sine - before
    return total


@inner()
def _stretch(row, state, x, y, normal_n):
    """Stretch the bristle, and let it slip beyond its greatest length."""
    bristle_x = state[_BRISTLE_X] + x - state[_X]
    bristle_y = state[_BRISTLE_Y] + y - state[_Y]
    length = math.sqrt(bristle_x * bristle_x + bristle_y * bristle_y)
    # The bristle z gives F = -k m z and slips at |z| = mu_d N / k (an elasto-plastic Dahl model; Hayward & Armstrong,
    # Experimental Robotics VI, 2000). While it slips, its level m follows a sawtooth of one grain in length, from the
    # static friction, m = mu_s / mu_d, to as far below 1; the mean is the dynamic friction. It is passive for any path
    # and N: over a tick from z to z', E = k m |z|^2 / 2 grows by no more than the hand puts in, -F'.dx, if and only if
    # m' / m <= 1 + 2 s / |z'| for a slip by s. The level rises no faster.
    most = row[DYNAMIC] * normal_n / row[STIFFNESS]
    slip = length - most
    if slip > 0.0:
        bristle_x *= most / length
        bristle_y *= most / length
        turns = slip * row[PER_M]
        phase = state[_PHASE] + turns
        state[_PHASE] = phase - math.floor(phase)
        level = 1.0 + row[SWING] * _sawtooth(state[_PHASE], turns)
        state[_LEVEL] = min(level, state[_LEVEL] * (1.0 + 2.0 * slip / most))
    state[_X], state[_Y], state[_BRISTLE_X], state[_BRISTLE_Y] = x, y, bristle_x, bristle_y


@njit(types.UniTuple(float64, 2)(TEXTURES, int64, float64[::1], *[float64] * 5), **KERNEL)
def texture_force(textures, material, state, x, y, vx, vy, normal_n):
    """Return the lateral force (Fx, Fy), newtons, of drag and stick-slip friction; state: STATE zeros at first."""
    if not (normal_n > 0.0 and np.isfinite(x + y + vx + vy + normal_n)):
        state[_OWNER] = 0.0
        return 0.0, 0.0
    row = textures[material]
    fx, fy = -row[DRAG] * vx, -row[DRAG] * vy
    if row[STIFFNESS] == 0.0:
        state[_OWNER] = 0.0
    else:
        # A bristle belongs to one material: on another it begins anew where the hand is, unstretched, and so without a
        # jump.
        if state[_OWNER] != material + 1.0:
            state[_X], state[_Y], state[_LEVEL], state[_OWNER] = x, y, 1.0 + row[SWING], material + 1.0
            state[_BRISTLE_X] = state[_BRISTLE_Y] = state[_PHASE] = 0.0
        _stretch(row, state, x, y, normal_n)
        pull = row[STIFFNESS] * state[_LEVEL]
        fx -= pull * state[_BRISTLE_X]
        fy -= pull * state[_BRISTLE_Y]
    if not np.isfinite(fx + fy):
        state[_OWNER] = 0.0
        return 0.0, 0.0
    return fx, fy


@njit(**KERNEL)
def along(textures, material, state, positions_m, period_s, normal_n, result):
    """Compute h, dh/dx, dh/dy, Fx and Fy (n, 5), in metres and newtons, along a path, its places a period apart."""
    for i in range(positions_m.shape[0]):
        x, y, before = positions_m[i, 0], positions_m[i, 1], positions_m[max(i - 1, 0)]
        vx, vy = (x - before[0]) / period_s, (y - before[1]) / period_s
        result[i, 0], result[i, 1], result[i, 2] = texture_height(textures, material, x, y, vx, vy, period_s)
        result[i, 3], result[i, 4] = texture_force(textures, material, state, x, y, vx, vy, normal_n)
