"""A step of the temporal filter of disparity, compiled. Imports numba: its users import it inside their verbs."""

# pyright: basic

import numpy as np

from ...compiled.compiling import KERNEL, njit


@njit(**KERNEL)
def step(new, values, waiting, doubts, out, weight, gate, most_doubts, most_missing):
    """Filter a map into `values`, copied to `out`; return the number of changed pixels, and of valid ones.

    new, values, waiting, out: float32 (h, w), NaN where unknown; waiting: a change that was seen once. doubts: uint8,
    number of consecutive frames without the value so far. weight: weight of a new value that differs by at most `gate`.
    """
    changes, count = 0, 0
    for y in range(new.shape[0]):
        for x in range(new.shape[1]):
            value, level = new[y, x], values[y, x]
            if abs(value - level) <= gate:  # never for NaN; the usual case first
                level += weight * (value - level)
                if doubts[y, x]:
                    doubts[y, x] = 0
                    waiting[y, x] = np.float32(np.nan)
                count += 1
            elif np.isnan(value):
                waiting[y, x] = np.float32(np.nan)
                doubts[y, x] += not np.isnan(level)
                if doubts[y, x] > most_missing:
                    level, doubts[y, x] = np.float32(np.nan), 0
            else:
                count += 1
                changes += 1
                doubts[y, x] += 1
                if abs(value - waiting[y, x]) <= gate or doubts[y, x] > most_doubts:
                    level, doubts[y, x] = value, 0
                waiting[y, x] = np.float32(np.nan) if doubts[y, x] == 0 else value
            values[y, x] = level
            out[y, x] = level
    return changes, count
