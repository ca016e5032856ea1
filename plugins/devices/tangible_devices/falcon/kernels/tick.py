"""A Falcon's part in a tick of the force loop, on the arrays of `Buffers`; compiled, so imported in verbs."""

from typing import NamedTuple

import numpy as np
from numba import boolean, float64, int64, types, void

from tangible_core.compiled import KERNEL, njit

from . import framing
from .framing import DOUBTFUL, FRESH
from .kinematics import CENTRE_M, POINT, RAD_PER_COUNT, ROWS, forward, jacobian, solve, torques
from .packet import BYTES, HOMED, decode, encode, saturate

ARMS, KNOWN, HEAD, SAMPLES, SUSPECTED, REFUSED, SEEKING, RUNNING, PRESSED = range(framing.COUNTS, framing.COUNTS + 9)
COUNTS = framing.COUNTS + 9
"""Elements of `counts`: homed arms, as bits; 1 if the tip is known; newest row and number of rows in `history`; 1 if an
answer waits to be confirmed; refused answers; the byte of lights before and after homing; buttons."""

NOW, SINCE, TIP, SLOPES, APPLIED, RATES, SUSPECT = 0, 1, 2, 5, 14, 17, 20
HELD = 24
"""Elements of `held`: seconds at the newest answer, and when force was first allowed; the tip, in the device's frame;
its Jacobian, row by row; the force in the workspace frame; velocity of the encoders, counts a second; time and counts
of the answer that waits to be confirmed."""

RAMP_S = 0.5  # time over which force fades in after homing, or after a leap
NEAR_COUNTS, BEND_COUNTS_PER_S2, STRAY_COUNTS = 8.0, 1e7, 24.0
"""Limits of an answer's distance from the extrapolated motion: noise, 340 m/s^2 of the tip, and 0.8 mm in any case. An
answer farther away waits until the next one confirms it, as there is no checksum."""
# Limits of the confirming answer's distance: 1.7 m/s of the tip, over at least 1 ms, and a limit in any case.
FAST_COUNTS_PER_S, SHORT_S, FAR_COUNTS = 5e4, 0.001, 128.0
# Largest distance of a sample from the line, as an encoder rounds to whole counts.
BAND_COUNTS = 1.0


class Buffers(NamedTuple):
    """The arrays that read and write share, the incoming answer and the outgoing packet."""

    answer: np.ndarray  # uint8 (16,), the newest answer
    packet: np.ndarray  # uint8 (16,), the next packet to send
    counts: np.ndarray  # int64 (COUNTS,)
    held: np.ndarray  # float64 (HELD,)
    history: np.ndarray  # float64 (n, 4), seconds and three encoders in counts, a ring
    # float64 (3, 2): each arm's angle at 0 counts in radians, and counts of torque per newton metre.
    arms: np.ndarray
    frame: np.ndarray  # float64 (3, 4): workspace = frame[:, :3] @ device + frame[:, 3], metres


FIXED = (BYTES, BYTES, int64[::1], float64[::1], float64[:, ::1], float64[:, ::1], float64[:, ::1])


@njit(void(int64[::1], float64[::1]), **KERNEL)
def seed(counts, held):
    """Forget the motion so far, and let force fade in from now on."""
    counts[SAMPLES] = 0
    held[TIP], held[TIP + 1], held[TIP + 2] = 0.0, 0.0, CENTRE_M
    held[SINCE] = held[NOW]


@njit(boolean(int64[::1], float64[::1], float64[:, ::1], int64, int64, int64), **KERNEL)
def goes_on(counts, held, history, first, second, third):
    """Tell whether these encoders continue the motion of the arms."""
    head = counts[HEAD]
    since = held[NOW] - history[head, 0]
    away = max(
        abs(first - history[head, 1] - since * held[RATES]),
        abs(second - history[head, 2] - since * held[RATES + 1]),
        abs(third - history[head, 3] - since * held[RATES + 2]),
    )
    return counts[SAMPLES] > 0 and away <= min(NEAR_COUNTS + BEND_COUNTS_PER_S2 * since * since, STRAY_COUNTS)


@njit(boolean(float64[::1], int64, int64, int64), **KERNEL)
def confirms(held, first, second, third):
    """Tell whether these encoders are near those of the answer that waits to be confirmed."""
    away = max(abs(first - held[SUSPECT + 1]), abs(second - held[SUSPECT + 2]), abs(third - held[SUSPECT + 3]))
    return away <= min(FAST_COUNTS_PER_S * max(held[NOW] - held[SUSPECT], SHORT_S), FAR_COUNTS)


@njit(void(int64[::1], float64[:, ::1], float64, float64, float64, float64), **KERNEL)
def remember(counts, history, now, first, second, third):
    """Add a row to the ring."""
    head = counts[HEAD] + 1 if counts[HEAD] + 1 < history.shape[0] else 0
    history[head, 0], history[head, 1], history[head, 2], history[head, 3] = now, first, second, third
    counts[HEAD], counts[SAMPLES] = head, min(counts[SAMPLES] + 1, history.shape[0])


@njit(float64(float64[:, ::1], int64, int64, int64), **KERNEL)
def _rate(history, head, samples, encoder):
    """Return the slope of one encoder over its window."""
    low, high, rate, at = -np.inf, np.inf, 0.0, head
    for _ in range(samples - 1):
        at = at - 1 if at else history.shape[0] - 1
        since = history[head, 0] - history[at, 0]
        if not since > 0.0:
            break
        per_second = 1.0 / since
        slope, band = (history[head, encoder] - history[at, encoder]) * per_second, BAND_COUNTS * per_second
        if not low <= slope <= high:
            break
        low, high, rate = max(low, slope - band), min(high, slope + band), slope
    return rate


@njit(types.UniTuple(float64, 3)(float64[:, ::1], int64, int64), **KERNEL)
def rates(history, head, samples):
    """Return the counts per second of three encoders at the newest sample: the slope over the longest straight window.

    history: a ring of rows (time in seconds, counts of three encoders); head: the newest row; samples: their number.
    Slow motion is averaged over many samples, which reduces the noise; fast motion over few, which avoids delay.
    Source: Janabi-Sharifi, Hayward & Chen, Discrete-time adaptive windowing for velocity estimation, IEEE Trans.
    Control Systems Technology 8(6), 2000, sec. III (end-fit).
    """
    return _rate(history, head, samples, 1), _rate(history, head, samples, 2), _rate(history, head, samples, 3)


@njit(boolean(int64[::1], float64[::1], float64[:, ::1], boolean, int64, int64, int64), **KERNEL)
def sample(counts, held, history, doubtful, first, second, third):
    """Remember the encoders; return False for a doubtful answer, until the next one confirms it."""
    # Doubtful: the first answer, one after stray bytes, and one that does not continue the motion (no checksum).
    going = goes_on(counts, held, history, first, second, third)
    if doubtful or not going:
        if not counts[SUSPECTED] or not confirms(held, first, second, third):
            counts[SUSPECTED] = 1
            held[SUSPECT], held[SUSPECT + 1], held[SUSPECT + 2], held[SUSPECT + 3] = held[NOW], first, second, third
            return False
        if not going:
            seed(counts, held)
            remember(counts, history, held[SUSPECT], held[SUSPECT + 1], held[SUSPECT + 2], held[SUSPECT + 3])
    counts[SUSPECTED] = 0
    remember(counts, history, held[NOW], first, second, third)
    held[RATES], held[RATES + 1], held[RATES + 2] = rates(history, counts[HEAD], counts[SAMPLES])
    return True


@njit(POINT(float64[:, ::1], float64, float64, float64), **KERNEL)
def rotate(frame, x, y, z):
    """Return a direction of the device in the workspace frame."""
    return (
        frame[0, 0] * x + frame[0, 1] * y + frame[0, 2] * z,
        frame[1, 0] * x + frame[1, 1] * y + frame[1, 2] * z,
        frame[2, 0] * x + frame[2, 1] * y + frame[2, 2] * z,
    )


@njit(ROWS(float64[::1]), **KERNEL)
def slopes(held):
    """Return the Jacobian at the tip, d angle / d tip."""
    return (
        (held[SLOPES], held[SLOPES + 1], held[SLOPES + 2]),
        (held[SLOPES + 3], held[SLOPES + 4], held[SLOPES + 5]),
        (held[SLOPES + 6], held[SLOPES + 7], held[SLOPES + 8]),
    )


@njit(void(int64[::1], float64[::1], BYTES), **KERNEL)
def let_go(counts, held, packet):
    """Mark the tip as unknown, and make the next packet one without force, whether or not another one is written."""
    counts[KNOWN] = 0
    held[APPLIED], held[APPLIED + 1], held[APPLIED + 2] = 0.0, 0.0, 0.0
    encode(0, 0, 0, counts[RUNNING] if counts[ARMS] == HOMED else counts[SEEKING], packet)


@njit(int64(*FIXED, float64[::1]), **KERNEL)
def read(answer, packet, counts, held, history, arms, frame, state):
    """Write position, velocity and buttons of a new answer to state, float64 (7,); return 0 without one to trust."""
    fresh = counts[FRESH]
    if not fresh:
        return 0
    counts[FRESH] = 0
    first, second, third, info = decode(answer)
    homed, before = info & HOMED, counts[ARMS]
    counts[ARMS], counts[PRESSED] = homed, info & 15
    if homed != HOMED:  # the encoders are meaningless until all arms are homed
        let_go(counts, held, packet)
        return 0
    if before != HOMED:
        seed(counts, held)
    suspected = counts[SUSPECTED]
    if not sample(counts, held, history, fresh == DOUBTFUL, first, second, third):
        counts[REFUSED] += 1
        if suspected:  # two doubtful answers in a row
            let_go(counts, held, packet)
        return 0
    angles = arms[0, 0] + RAD_PER_COUNT * first, arms[1, 0] + RAD_PER_COUNT * second, arms[2, 0] + RAD_PER_COUNT * third
    x, y, z, is_found = forward(*angles, held[TIP], held[TIP + 1], held[TIP + 2])
    if not is_found:  # angles that no tip has
        counts[REFUSED] += 1
        let_go(counts, held, packet)
        return 0
    counts[KNOWN] = 1
    held[TIP], held[TIP + 1], held[TIP + 2] = x, y, z
    rows = jacobian(*angles, x, y, z)
    for i in range(3):
        held[SLOPES + 3 * i], held[SLOPES + 3 * i + 1], held[SLOPES + 3 * i + 2] = rows[i]
    turning = RAD_PER_COUNT * held[RATES], RAD_PER_COUNT * held[RATES + 1], RAD_PER_COUNT * held[RATES + 2]
    velocity = solve(rows, turning)
    state[0], state[1], state[2] = rotate(frame, x, y, z)
    state[0], state[1], state[2] = state[0] + frame[0, 3], state[1] + frame[1, 3], state[2] + frame[2, 3]
    state[3], state[4], state[5] = rotate(frame, *velocity)
    state[6] = counts[PRESSED]
    return 1


@njit(void(*FIXED, float64, float64, float64), **KERNEL)
def write(answer, packet, counts, held, history, arms, frame, x, y, z):
    """Make the packet for this force in newtons: zero while the tip is unknown, less while the force fades in."""
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
    first, second, third, factor = saturate(
        -share * arms[0, 1] * turn[0], -share * arms[1, 1] * turn[1], -share * arms[2, 1] * turn[2]
    )
    held[APPLIED], held[APPLIED + 1], held[APPLIED + 2] = 0.0, 0.0, 0.0
    if first != 0 or second != 0 or third != 0:
        factor *= share
        held[APPLIED], held[APPLIED + 1], held[APPLIED + 2] = factor * x, factor * y, factor * z
    encode(first, second, third, counts[RUNNING] if counts[ARMS] == HOMED else counts[SEEKING], packet)
