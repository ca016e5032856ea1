"""The Novint Falcon: kinematics and the tick, compiled."""

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
forward, inverse = kinematics.forward, kinematics.inverse
read, write, receive = tick.read, tick.write, framing.receive


def figures() -> Iterator[Figure]:
    """Yield the figures that need no USB."""
    yield from part("kinematics", lambda: list(_kinematics()))


def _kinematics() -> Iterator[Figure]:
    times = np.arange(POINTS) * 1e-3
    way = np.column_stack([0.03 * np.sin(2 * np.pi * rate * times) for rate in (0.31, 0.23, 0.41)])
    way[:, 2] += kinematics.CENTRE_M
    angles, found = np.empty((POINTS, 3)), np.empty((POINTS, 3))
    _inverse(way, angles)
    ns = min(_ns(_follow, angles, found) for _ in range(7))
    yield Figure("Falcon: forward kinematics along a path", "<= 500 ns", f"{ns:.0f} ns", ns <= 500)
    ns = _tick_ns(way)
    yield Figure("framing, read and write of a tick, compiled", "<= 1000 ns", f"{ns:.0f} ns", ns <= 1000)


def _ns(call: Any, *given: np.ndarray) -> float:
    call(*given)
    start = thread_time()
    call(*given)
    return 1e9 * (thread_time() - start) / POINTS


@njit(nogil=True)
def _inverse(tips, angles):
    for i in range(len(tips)):
        angles[i, 0], angles[i, 1], angles[i, 2] = inverse(tips[i, 0], tips[i, 1], tips[i, 2])


@njit(nogil=True)
def _follow(angles, found):
    x, y, z = 0.0, 0.0, 0.11
    for i in range(len(angles)):
        x, y, z, _ = forward(angles[i, 0], angles[i, 1], angles[i, 2], x, y, z)
        found[i, 0], found[i, 1], found[i, 2] = x, y, z


def _tick_ns(way: np.ndarray) -> float:
    angles = np.empty_like(way)
    _inverse(way, angles)
    counts = np.round((angles - math.radians(35)) / kinematics.RAD_PER_COUNT).astype(np.int64)
    answers = np.zeros((POINTS, 18), np.uint8)
    for row, count in zip(answers, counts, strict=True):
        packet.encode(*count.tolist(), 0, row[2:])
        row[2 + packet.INFO] = packet.ZERO + packet.HOMED
    given = answers, np.zeros(64, np.uint8), np.zeros(16, np.uint8), tuple(falcon_streams.buffers()), np.zeros(7)
    return min(_ns(_ticks, *given) for _ in range(7))


@njit(nogil=True)
def _ticks(answers, chunk, begun, fixed, state):
    for i in range(len(answers)):
        chunk[:18] = answers[i]
        fixed[3][tick.NOW] += 0.001
        receive(chunk, 18, begun, fixed[2], fixed[0])
        read(*fixed, state)
        write(*fixed, 1.0, -0.5, 2.0)
