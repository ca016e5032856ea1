"""A step of the temporal filter of disparity, compiled. Imports numba: its users import it inside their verbs."""

# pyright: basic

import numpy as np

from ...compiled.compiling import KERNEL, njit


@njit(**KERNEL)
def step(new, kept, waiting, doubts, out, averaged, gate, most_doubts, most_missing):
    """Filter a map into `kept`, copied to `out`; return the number of changed pixels, and of known ones.

    new, kept, waiting, out: float32 (h, w), NaN where unknown; waiting: a change that was seen once. doubts: uint8,
    number of consecutive frames without the kept value. averaged: weight of a new value that differs by at most `gate`.
    """
    changed, known = 0, 0
    for y in range(new.shape[0]):
        for x in range(new.shape[1]):
            value, held = new[y, x], kept[y, x]
            if abs(value - held) <= gate:  # never for NaN; the usual case first
                held += averaged * (value - held)
                if doubts[y, x]:
                    doubts[y, x] = 0
                    waiting[y, x] = np.float32(np.nan)
                known += 1
            elif np.isnan(value):
                waiting[y, x] = np.float32(np.nan)
                doubts[y, x] += not np.isnan(held)
                if doubts[y, x] > most_missing:
                    held, doubts[y, x] = np.float32(np.nan), 0
            else:
                known += 1
                changed += 1
                doubts[y, x] += 1
                if abs(value - waiting[y, x]) <= gate or doubts[y, x] > most_doubts:
                    held, doubts[y, x] = value, 0
                waiting[y, x] = np.float32(np.nan) if doubts[y, x] == 0 else value
            kept[y, x] = held
            out[y, x] = held
    return changed, known
