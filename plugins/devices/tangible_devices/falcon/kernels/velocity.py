"""Velocity of the encoders, estimated from whole counts; compiled.

Imports numba: a method imports this module inside its verb.
"""

# ruff: noqa: ANN001, ANN201, ANN202 -- the types are in the signatures that numba compiles

import numpy as np
from numba import boolean, float64, int64, types

from tangible_core.compiled.compiling import KERNEL, njit

BAND_COUNTS = 1.0
"""Largest distance of a sample from the line, as an encoder rounds to whole counts."""


@njit(types.Tuple((float64, float64, float64, boolean))(*[float64] * 4), **KERNEL)
def _narrow(low, high, per_second, rise):
    """Narrow the range of slopes by a sample; return (low, high, slope to the sample, True if it was in range)."""
    slope, band = rise * per_second, BAND_COUNTS * per_second
    if not low <= slope <= high:
        return low, high, slope, False
    return max(low, slope - band), min(high, slope + band), slope, True


@njit(types.UniTuple(float64, 3)(float64[:, ::1], int64, int64), **KERNEL)
def rates(history, head, samples):
    """Return the counts per second of three encoders at the newest sample: the slope over the longest straight window.

    history: a ring of rows (time in seconds, counts of three encoders); head: the newest row; samples: their number.
    Slow motion is averaged over many samples, which reduces the noise of single counts; fast motion over few, which
    avoids delay. Every sample between the ends of the window is within one count of the line through them; the range
    of slopes for which this holds is narrowed sample by sample.
    Source: Janabi-Sharifi, Hayward & Chen, Discrete-time adaptive windowing for velocity estimation, IEEE Trans.
    Control Systems Technology 8(6), 2000, sec. III (end-fit).
    """
    low_0 = low_1 = low_2 = -np.inf
    high_0 = high_1 = high_2 = np.inf
    found_0 = found_1 = found_2 = 0.0
    going_0 = going_1 = going_2 = True
    at = head
    for _ in range(samples - 1):
        at = at - 1 if at else history.shape[0] - 1
        since = history[head, 0] - history[at, 0]
        if not (since > 0.0 and (going_0 or going_1 or going_2)):
            break
        per_second = 1.0 / since
        if going_0:
            low_0, high_0, slope, going_0 = _narrow(low_0, high_0, per_second, history[head, 1] - history[at, 1])
            found_0 = slope if going_0 else found_0
        if going_1:
            low_1, high_1, slope, going_1 = _narrow(low_1, high_1, per_second, history[head, 2] - history[at, 2])
            found_1 = slope if going_1 else found_1
        if going_2:
            low_2, high_2, slope, going_2 = _narrow(low_2, high_2, per_second, history[head, 3] - history[at, 3])
            found_2 = slope if going_2 else found_2
    return found_0, found_1, found_2
