"""The Novint Falcon: kinematics, torques and the tick, compiled."""

import math
from collections.abc import Iterator
from time import thread_time
from typing import Any

import numpy as np
from numba import njit

from tangible_devices.falcon.kernels import framing, kinematics, packet, tick

from .figures import Figure, part
from .tests_path import falcon_streams

POINTS = 100_000
forward, inverse, jacobian, torques = kinematics.forward, kinematics.inverse, kinematics.jacobian, kinematics.torques
read, write, receive, saturate = tick.read, tick.write, framing.receive, packet.saturate


def figures() -> Iterator[Figure]:
    """Yield the figures that need no USB."""
    yield from part("kinematics", lambda: list(_kinematics()))
    yield from part("force to torque", lambda: list(_torques()))


def _tips() -> np.ndarray:
    """Points all over a ball of 50 mm, a quarter wider than the workspace."""
    numbers = np.random.default_rng(0)
    away = numbers.normal(size=(POINTS, 3))
    away *= 0.05 * numbers.random((POINTS, 1)) ** (1 / 3) / np.linalg.norm(away, axis=1, keepdims=True)
    return away + np.array([0.0, 0.0, kinematics.CENTRE_M])


def _kinematics() -> Iterator[Figure]:
    times = np.arange(POINTS) * 1e-3
    way = np.column_stack([0.03 * np.sin(2 * np.pi * rate * times) for rate in (0.31, 0.23, 0.41)])
    way[:, 2] += kinematics.CENTRE_M
    angles, found = np.empty((POINTS, 3)), np.empty((POINTS, 3))
    _inverse(way, angles)
    ns = min(_ns(_follow, angles, found) for _ in range(7))
    yield Figure("Falcon: forward kinematics along a path", "<= 500 ns", f"{ns:.0f} ns", ns <= 500)
    tips = _tips()
    _inverse(tips, angles)
    apart = _round_trip(tips, angles)
    yield Figure("the same: round trip over a ball of 50 mm", "<= 1e-9 m", f"{apart:.1e} m", apart <= 1e-9)
    slopes = max(_slope_error(tip) for tip in tips[:5000])
    yield Figure("Jacobian against central differences", "<= 1e-6", f"{slopes:.1e}", slopes <= 1e-6)
    ns = _tick_ns(way)
    yield Figure("framing, read and write of a tick, compiled", "<= 1000 ns", f"{ns:.0f} ns", ns <= 1000)


def _ns(call: Any, *given: np.ndarray) -> float:
    call(*given)
    start = thread_time()
    call(*given)
    return 1e9 * (thread_time() - start) / POINTS


@njit(nogil=True)
def _inverse(tips, angles):  # noqa: ANN001, ANN202
    for i in range(len(tips)):
        angles[i, 0], angles[i, 1], angles[i, 2] = inverse(tips[i, 0], tips[i, 1], tips[i, 2])


@njit(nogil=True)
def _follow(angles, found):  # noqa: ANN001, ANN202
    x, y, z = 0.0, 0.0, 0.11
    for i in range(len(angles)):
        x, y, z, _ = forward(angles[i, 0], angles[i, 1], angles[i, 2], x, y, z)
        found[i, 0], found[i, 1], found[i, 2] = x, y, z


@njit(nogil=True)
def _round_trip(tips, angles):  # noqa: ANN001, ANN202
    worst = 0.0
    for i in range(len(tips)):
        x, y, z, ok = forward(angles[i, 0], angles[i, 1], angles[i, 2], 0.0, 0.0, 0.11)
        away = math.sqrt((x - tips[i, 0]) ** 2 + (y - tips[i, 1]) ** 2 + (z - tips[i, 2]) ** 2)
        worst = max(worst, away if ok else math.inf)
    return worst


def _slope_error(tip: np.ndarray) -> float:
    def moved(axis: int, steps: int) -> np.ndarray:
        return np.array(inverse(*(tip + 1e-5 * steps * np.eye(3)[axis])))

    slopes = [(8 * (moved(k, 1) - moved(k, -1)) - moved(k, 2) + moved(k, -2)) / 12e-5 for k in range(3)]
    rows = np.array(jacobian(*inverse(*tip), *tip))
    return float(np.abs(rows - np.transpose(slopes)).max() / np.abs(rows).max())


def _tick_ns(way: np.ndarray) -> float:
    angles = np.empty_like(way)
    _inverse(way, angles)
    counts = np.round((angles - math.radians(35)) / kinematics.RAD_PER_COUNT).astype(np.int64)
    answers = np.zeros((POINTS, 18), np.uint8)
    for row, each in zip(answers, counts, strict=True):
        packet.encode(*each.tolist(), 0, row[2:])
        row[2 + packet.INFO] = packet.ZERO + packet.HOMED
    given = answers, np.zeros(64, np.uint8), np.zeros(16, np.uint8), tuple(falcon_streams.buffers()), np.zeros(7)
    return min(_ns(_ticks, *given) for _ in range(7))


@njit(nogil=True)
def _ticks(answers, chunk, begun, fixed, state):  # noqa: ANN001, ANN202
    for i in range(len(answers)):
        chunk[:18] = answers[i]
        fixed[3][tick.NOW] += 0.001
        receive(chunk, 18, begun, fixed[2], fixed[0])
        read(*fixed, state)
        write(*fixed, 1.0, -0.5, 2.0)


def _torques() -> Iterator[Figure]:
    numbers = np.random.default_rng(1)
    forces = numbers.normal(size=(POINTS, 3)) * 10.0 ** numbers.uniform(-3, 300, (POINTS, 1))
    wrong, apart = _worst(_tips(), forces)
    yield Figure("torques of the wrong sign, over all of the range", "0", f"{wrong} of {3 * POINTS}", wrong == 0)
    yield Figure("direction of saturated torques, without rounding", "0 rad", f"{apart:.1e} rad", apart <= 1e-7)


@njit(nogil=True)
def _worst(tips, forces):  # noqa: ANN001, ANN202
    wrong, apart = 0, 0.0
    for i in range(len(tips)):
        x, y, z = tips[i, 0], tips[i, 1], tips[i, 2]
        first, second, third = torques(jacobian(*inverse(x, y, z), x, y, z), (forces[i, 0], forces[i, 1], forces[i, 2]))
        a, b, c, factor = saturate(-1e4 * first, -1e4 * second, -1e4 * third)
        wrong += (a * first > 0) + (b * second > 0) + (c * third > 0)
        wrong += max(abs(a), abs(b), abs(c)) > packet.MOST_COUNTS
        if 0.0 < factor < 1.0:
            off = max(abs(a + 1e4 * factor * first), abs(b + 1e4 * factor * second), abs(c + 1e4 * factor * third))
            apart = max(apart, max(off - 0.5, 0.0) / packet.MOST_COUNTS)
    return wrong, apart
