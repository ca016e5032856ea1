"""Matches of the left view held against those that the right view has as the reference.

Source: Hirschmueller, IEEE PAMI 30(2), 2008, section 2.4: a disparity map of either view, each by paths of its own, and
a disparity is kept where both agree.
"""

# ruff: noqa: ANN001, ANN202 -- numba infers the types of kernels; their docstrings give them

import numpy as np
from jaxtyping import Int16

from tangible_core.compiled.compiling import KERNEL, njit
from tangible_core.compiled.threads import in_blocks

from .span import UNKNOWN

APART = 16
"""Largest difference, in sixteenths of a pixel, of disparities that agree."""


def reconcile(matched: Int16[np.ndarray, "h w"], from_right: Int16[np.ndarray, "h w"]) -> Int16[np.ndarray, "h w"]:
    """Make UNKNOWN, in `matched` itself, what the right view contradicts; return it with gaps closed from there.

    matched: disparity of the left view, in sixteenths of a pixel. from_right: of the right view, at its own pixels.
    A pixel of the left view without a match takes the nearest surface that the right view has there.
    """
    out = np.empty_like(matched)
    in_blocks(matched.shape[0], lambda y0, y1: _reconcile(matched[y0:y1], from_right[y0:y1], out[y0:y1]))
    return out


@njit(**KERNEL)
def _reconcile(matched, from_right, out):
    h, w = matched.shape
    for y in range(h):
        for x in range(w):
            out[y, x] = matched[y, x]
        for x in range(w):
            value = from_right[y, x]
            there = x + ((value + 8) >> 4)
            if value != UNKNOWN and 0 <= there < w and matched[y, there] == UNKNOWN:
                out[y, there] = max(out[y, there], value)
        for x in range(w):
            value = matched[y, x]
            there = x - ((value + 8) >> 4)
            if value != UNKNOWN and 0 <= there < w:
                other = from_right[y, there]
                if other != UNKNOWN and abs(other - value) > APART:
                    matched[y, x] = out[y, x] = UNKNOWN
