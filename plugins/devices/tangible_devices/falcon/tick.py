"""A Falcon's part in a tick of the servo: an answer becomes position and velocity, a force becomes a packet; compiled.

Both kernels take the same arrays first, those of `Buffers`. Imports numba: a method imports this module inside its
verb. numba's cache does not see a change made in another file: after an edit to one of the modules that this one
imports, remove `__pycache__` here.
"""

# ruff: noqa: ANN001, ANN201 -- the types are in the signatures that numba compiles

from typing import NamedTuple

import numpy as np
from numba import boolean, float64, int64, njit, void

from .framing import FRESH
from .kinematics import CENTRE_M, POINT, RAD_PER_COUNT, ROWS, forward, jacobian, solve, torques
from .packet import BYTES, COMPILED, HOMED, decode, encode, saturated
from .velocity import rate

ARMS, KNOWN, HEAD, SAMPLES, SUSPECTED, REFUSED, SEEKING, RUNNING, PRESSED = range(4, 13)
"""In `counts`: arms homed, as bits; whether the tip is known; newest row and number of rows in `history`; whether a
leap waits to be confirmed; answers not taken for a position; the byte of lights before and after homing; buttons."""
COUNTS = 13

NOW, SINCE, TIP, SLOPES, APPLIED, SUSPECT = 0, 1, 2, 5, 14, 17
"""In `held`: seconds at the newest answer, and when force was first allowed; the tip, in the device's frame; its
Jacobian, row by row; the force in the workspace frame; time and counts of a leap that waits to be confirmed."""
HELD = 21

RAMP_S = 0.5
"""Time over which force fades in after homing, or after a leap."""
LEAP_COUNTS_PER_S, LEAP_S = 1e5, 0.002
"""No hand moves the tip by 3 m/s: an answer that says so waits for the next one to agree, as there is no checksum.
The shortest time between two answers that is counted with."""


class Buffers(NamedTuple):
    """What read and write share, and what goes out and comes in between them."""

    answer: np.ndarray
    """uint8 (16,), the newest answer."""
    packet: np.ndarray
    """uint8 (16,), what is sent next."""
    counts: np.ndarray
    """int64 (COUNTS,)"""
    held: np.ndarray
    """float64 (HELD,)"""
    history: np.ndarray
    """float64 (n, 4), seconds and three encoders in counts, a ring."""
    arms: np.ndarray
    """float64 (3, 2): each arm's angle at 0 counts in radians, and counts of torque a newton metre."""
    frame: np.ndarray
    """float64 (3, 4): workspace = frame[:, :3] @ device + frame[:, 3], metres."""


FIXED = (BYTES, BYTES, int64[::1], float64[::1], float64[:, ::1], float64[:, ::1], float64[:, ::1])


@njit(void(int64[::1], float64[::1]), **COMPILED)
def seed(counts, held):
    """Forget where the tip was, and let force fade in from now on."""
    counts[SAMPLES], counts[SUSPECTED] = 0, 0
    held[TIP], held[TIP + 1], held[TIP + 2] = 0.0, 0.0, CENTRE_M
    held[SINCE] = held[NOW]


@njit(boolean(float64, int64, int64, int64, float64[::1]), **COMPILED)
def leaps(now, first, second, third, before):
    """Whether these encoders are farther from those before, a row of `history`, than a hand moves."""
    away = max(abs(first - before[1]), abs(second - before[2]), abs(third - before[3]))
    return away > LEAP_COUNTS_PER_S * max(now - before[0], LEAP_S)


@njit(boolean(int64[::1], float64[::1], float64[:, ::1], int64, int64, int64), **COMPILED)
def sample(counts, held, history, first, second, third):
    """Remember the encoders; False for a leap, until a second answer confirms it and all begins anew there."""
    now, head = held[NOW], counts[HEAD]
    if counts[SAMPLES] and leaps(now, first, second, third, history[head]):
        if not counts[SUSPECTED] or leaps(now, first, second, third, held[SUSPECT:]):
            counts[SUSPECTED] = 1
            held[SUSPECT], held[SUSPECT + 1], held[SUSPECT + 2], held[SUSPECT + 3] = now, first, second, third
            return False
        seed(counts, held)
    head = head + 1 if head + 1 < history.shape[0] else 0
    history[head, 0], history[head, 1], history[head, 2], history[head, 3] = now, first, second, third
    counts[HEAD], counts[SAMPLES], counts[SUSPECTED] = head, min(counts[SAMPLES] + 1, history.shape[0]), 0
    return True


@njit(POINT(int64[::1], float64[:, ::1]), **COMPILED)
def turning(counts, history):
    """How fast the three arms turn, in rad/s."""
    head, samples = counts[HEAD], counts[SAMPLES]
    return (
        RAD_PER_COUNT * rate(history, head, samples, 1),
        RAD_PER_COUNT * rate(history, head, samples, 2),
        RAD_PER_COUNT * rate(history, head, samples, 3),
    )


@njit(POINT(float64[:, ::1], float64, float64, float64), **COMPILED)
def turned(frame, x, y, z):
    """A direction of the device in the workspace frame."""
    return (
        frame[0, 0] * x + frame[0, 1] * y + frame[0, 2] * z,
        frame[1, 0] * x + frame[1, 1] * y + frame[1, 2] * z,
        frame[2, 0] * x + frame[2, 1] * y + frame[2, 2] * z,
    )


@njit(ROWS(float64[::1]), **COMPILED)
def slopes(held):
    """The Jacobian at the tip, d angle / d tip."""
    return (
        (held[SLOPES], held[SLOPES + 1], held[SLOPES + 2]),
        (held[SLOPES + 3], held[SLOPES + 4], held[SLOPES + 5]),
        (held[SLOPES + 6], held[SLOPES + 7], held[SLOPES + 8]),
    )


@njit(int64(*FIXED, float64[::1]), **COMPILED)
def read(answer, packet, counts, held, history, arms, frame, state):
    """Write position, velocity and buttons of a new answer to state, float64 (7,); 0 if there is none to be trusted.

    Until all arms are homed the encoders mean nothing. An answer whose angles no tip has takes the force away.
    """
    if not counts[FRESH]:
        return 0
    counts[FRESH] = 0
    first, second, third, info = decode(answer)
    homed, before = info & HOMED, counts[ARMS]
    counts[ARMS], counts[PRESSED] = homed, info & 15
    if homed != HOMED:
        counts[KNOWN] = 0
        return 0
    if before != HOMED:
        seed(counts, held)
    if not sample(counts, held, history, first, second, third):
        counts[REFUSED] += 1
        return 0
    angles = arms[0, 0] + RAD_PER_COUNT * first, arms[1, 0] + RAD_PER_COUNT * second, arms[2, 0] + RAD_PER_COUNT * third
    x, y, z, found = forward(*angles, held[TIP], held[TIP + 1], held[TIP + 2])
    counts[KNOWN] = found
    if not found:
        counts[REFUSED] += 1
        return 0
    held[TIP], held[TIP + 1], held[TIP + 2] = x, y, z
    rows = jacobian(*angles, x, y, z)
    for i in range(3):
        held[SLOPES + 3 * i], held[SLOPES + 3 * i + 1], held[SLOPES + 3 * i + 2] = rows[i]
    velocity = solve(rows, turning(counts, history))
    state[0], state[1], state[2] = turned(frame, x, y, z)
    state[0], state[1], state[2] = state[0] + frame[0, 3], state[1] + frame[1, 3], state[2] + frame[2, 3]
    state[3], state[4], state[5] = turned(frame, *velocity)
    state[6] = counts[PRESSED]
    return 1


@njit(void(*FIXED, float64, float64, float64), **COMPILED)
def write(answer, packet, counts, held, history, arms, frame, x, y, z):
    """Make the packet that gives this force, in newtons; none while the tip is not known, less while it fades in.

    Torques too great are scaled down, all three alike. `held` keeps the force that comes of it.
    """
    share = 0.0
    if counts[KNOWN]:
        share = min(max((held[NOW] - held[SINCE]) / RAMP_S, 0.0), 1.0)
    back = (
        frame[0, 0] * x + frame[1, 0] * y + frame[2, 0] * z,
        frame[0, 1] * x + frame[1, 1] * y + frame[2, 1] * z,
        frame[0, 2] * x + frame[1, 2] * y + frame[2, 2] * z,
    )
    turn = torques(slopes(held), back)
    # A motor turns its arm against its counts: positive counts pull the tip in.
    first, second, third, factor = saturated(
        -share * arms[0, 1] * turn[0], -share * arms[1, 1] * turn[1], -share * arms[2, 1] * turn[2]
    )
    pushes = first != 0 or second != 0 or third != 0
    held[APPLIED], held[APPLIED + 1], held[APPLIED + 2] = 0.0, 0.0, 0.0
    if pushes:
        factor *= share
        held[APPLIED], held[APPLIED + 1], held[APPLIED + 2] = factor * x, factor * y, factor * z
    encode(first, second, third, counts[RUNNING] if counts[ARMS] == HOMED else counts[SEEKING], packet)
