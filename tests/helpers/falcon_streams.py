"""Damaged streams of a Falcon's answers, and the positions that the driver reads from them; compiled for speed."""

# ruff: noqa: NPY002 -- numba knows the legacy generator, which is quicker to seed

import math

import numpy as np
from numba import njit

from tangible_devices.falcon.kernels import framing, packet, tick

receive, read, encode, counts_of = framing.receive, tick.read, packet.encode, packet.decode
SENT, WHOLE = 9, 2
"""Number of answers in a stream, and of whole ones at its beginning and at its end."""
LOST, GAINED, SWAPPED, NOISE = 1, 2, 4, 8
"""Kinds of damage, as bits: lost bytes, additional bytes, wrong bytes, noise alone."""


def buffers(samples: int = 16) -> tick.Buffers:
    """Return the buffers of a link with the default calibration."""
    return tick.Buffers(
        answer=np.zeros(16, np.uint8),
        packet=np.zeros(16, np.uint8),
        counts=np.zeros(tick.COUNTS, np.int64),
        held=np.zeros(tick.HELD),
        history=np.zeros((samples, 4)),
        arms=np.column_stack([np.full(3, math.radians(35)), np.full(3, 1e4)]),
        frame=np.array([[1.0, 0.0, 0.0, 0.0], [0.0, 0.0, -1.0, 0.125], [0.0, 1.0, 0.0, 0.0]]),
    )


@njit(cache=True)
def damage_bytes(stream, size, kinds, damage, out):
    """Copy the stream with some bytes lost, gained or swapped; return (size, number of damages)."""
    done, length = 0, 0
    for i in range(size):
        if kinds & 7 and np.random.random() < damage:
            done += 1
            kind = 1 << np.random.randint(0, 3)
            if not kinds & kind:
                kind = kinds & 7 & -(kinds & 7)
            if kind == LOST:
                continue
            out[length] = np.random.randint(0, 256)
            length += 1
            if kind == SWAPPED:
                continue
        out[length] = stream[i]
        length += 1
    return length, done


@njit(cache=True)
def feed(data, size, begun, fixed, state, true, sent, found):
    """Feed data in IN transfers of random sizes; found: positions, those never sent, the worst error in counts."""
    chunk = np.zeros(64, np.uint8)
    at = 0
    while at < size:
        n = min(np.random.randint(1, 63), size - at)
        chunk[2 : 2 + n] = data[at : at + n]
        at += n
        if receive(chunk, n + 2, begun, fixed[2], fixed[0]) and read(*fixed, state):
            row = fixed[4][fixed[2][tick.HEAD]]
            away = np.inf
            for k in range(sent):
                away = min(away, max(abs(row[1] - true[k, 0]), abs(row[2] - true[k, 1]), abs(row[3] - true[k, 2])))
            found[0] += 1
            found[1] += away > 0
            found[2] = max(found[2], away)


@njit(cache=True)
def fuzz(streams, kinds, damage, seed, fixed):
    """Return (positions, positions never sent, the worst error in counts, streams without recovery in time)."""
    np.random.seed(seed)
    stream, true, one = np.zeros(16, np.uint8), np.zeros((SENT, 3), np.int64), np.zeros(64 * SENT, np.uint8)
    begun, state, found = np.zeros(16, np.uint8), np.zeros(7), np.zeros(3)
    late = 0
    for _ in range(streams):
        fixed[2][framing.FILL], fixed[2][tick.SAMPLES], fixed[2][tick.SUSPECTED] = 0, 0, 0
        for axis in range(3):
            place, speed = np.random.uniform(-700, 300), np.random.uniform(-25, 25)
            for k in range(SENT):
                true[k, axis] = int(place + k * speed)
        for k in range(SENT):
            encode(true[k, 0], true[k, 1], true[k, 2], 0, stream)
            stream[packet.INFO] = packet.ZERO + packet.HOMED
            whole = k < WHOLE or k >= SENT - WHOLE
            if kinds & NOISE and not whole:
                for i in range(16):
                    one[i] = np.random.randint(0, 256)
                size = np.random.randint(0, 17)
            else:
                size, _done = damage_bytes(stream, 16, 0 if whole else kinds, damage, one)
            fixed[3][tick.NOW] += 0.001
            feed(one, size, begun, fixed, state, true, k + 1, found)
        row = fixed[4][fixed[2][tick.HEAD]]
        late += row[1] != true[SENT - 1, 0] or row[2] != true[SENT - 1, 1] or row[3] != true[SENT - 1, 2]
    return int(found[0]), int(found[1]), found[2], late
