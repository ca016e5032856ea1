"""Velocity of the encoders, estimated from whole counts; compiled.

Imports numba: a method imports this module inside its verb.
"""

# ruff: noqa: ANN001, ANN201, ANN202 -- the types are in the signatures that numba compiles

import numpy as np
from numba import float64, int64, types

from tangible_core.compiled import KERNEL, njit

BAND_COUNTS = 1.0
"""Largest distance of a sample from the line, as an encoder rounds to whole counts."""


@njit(float64(float64[:, ::1], int64, int64, int64), **KERNEL)
def _rate(history, head, samples, encoder):
    """Return the slope of one encoder over its window."""
    low, high, found, at = -np.inf, np.inf, 0.0, head
    for _ in range(samples - 1):
        at = at - 1 if at else history.shape[0] - 1
        since = history[head, 0] - history[at, 0]
        if not since > 0.0:
            break
        per_second = 1.0 / since
        slope, band = (history[head, encoder] - history[at, encoder]) * per_second, BAND_COUNTS * per_second
        if not low <= slope <= high:
            break
        low, high, found = max(low, slope - band), min(high, slope + band), slope
    return found


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
    return _rate(history, head, samples, 1), _rate(history, head, samples, 2), _rate(history, head, samples, 3)
