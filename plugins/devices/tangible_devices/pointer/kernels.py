"""Kernels that read and write a pointer's memory. Imports numba: this module is imported when a pointer is opened."""

import numpy as np
from numba import float64, int64, uint64, void

from tangible_core.compiled import KERNEL, njit

from .channel import CLIENT_OPEN, FACTOR, FORCE, FORCE_WORDS, SAMPLE, SAMPLE_WORDS, START, TRIES

WORDS, NUMBERS = uint64[::1], float64[::1]
# Words of a link's state after the copied block: number of the newest sample, reads since it came, and their limit.
LAST, AGE, OLDEST = SAMPLE_WORDS + 1, SAMPLE_WORDS + 2, SAMPLE_WORDS + 3
SHARE, TIP = SAMPLE_WORDS + 4, SAMPLE_WORDS + 5
"""Further words: the share of the remaining way that the tip moves in a read, 1 without a filter; and the tip's
position and velocity."""
KEPT_WORDS = TIP + 6
NOBODY, BROKEN, WHOLE = 0, 1, 2
HIGH_M = 1.0  # height of the tip without a client: above every surface
_START, _FACTOR, _HALF = np.uint64(START), np.uint64(FACTOR), np.uint64(32)


@njit(uint64(WORDS, int64, int64), **KERNEL)
def checksum(words, start, count):
    """Return the same checksum as `channel.checksum`."""
    total = _START
    for i in range(start, start + count):
        total = (total ^ words[i]) * _FACTOR
        total ^= total >> _HALF
    return total


@njit(int64(WORDS, WORDS), **KERNEL)
def fetch(words, kept):
    """Copy the client's sample; return WHOLE, BROKEN if it is torn or not finite, or NOBODY."""
    if words[CLIENT_OPEN] == 0:
        return NOBODY
    for _ in range(TRIES):
        for i in range(SAMPLE_WORDS + 1):
            kept[i] = words[SAMPLE + i]
        if checksum(kept, 0, SAMPLE_WORDS) == kept[SAMPLE_WORDS]:
            numbers = kept.view(np.float64)
            for i in range(1, SAMPLE_WORDS):
                if not np.isfinite(numbers[i]):
                    return BROKEN
            return WHOLE
    return BROKEN


@njit(int64(WORDS, WORDS, NUMBERS, NUMBERS), **KERNEL)
def read(words, kept, numbers, state):
    """Write the newest sample, or the filtered tip, to state; return 0 if the client has been silent too long."""
    status = fetch(words, kept)
    if status == NOBODY:
        kept[AGE] = kept[OLDEST]
        for i in range(7):
            state[i] = HIGH_M if i == 2 else 0.0
        return 1
    if status == WHOLE and kept[0] != kept[LAST]:
        # The first sample after a silence is not filtered.
        if kept[AGE] >= kept[OLDEST]:
            for i in range(6):
                numbers[TIP + i] = numbers[1 + i]
        kept[LAST], kept[AGE] = kept[0], 0
    elif kept[AGE] < kept[OLDEST]:
        kept[AGE] += np.uint64(1)
    if status == BROKEN or kept[AGE] >= kept[OLDEST]:
        return 0
    for i in range(7):
        state[i] = numbers[1 + i]
    if numbers[SHARE] < 1.0:
        for i in range(6):
            numbers[TIP + i] += numbers[SHARE] * (numbers[1 + i] - numbers[TIP + i])
            state[i] = numbers[TIP + i]
    return 1


@njit(void(WORDS, WORDS, NUMBERS, float64, float64, float64), **KERNEL)
def write(words, kept, numbers, fx, fy, fz):
    """Write the force for the client."""
    held = words.view(np.float64)
    words[FORCE] += np.uint64(1)
    held[FORCE + 1], held[FORCE + 2], held[FORCE + 3] = fx, fy, fz
    words[FORCE + FORCE_WORDS] = checksum(words, FORCE, FORCE_WORDS)
