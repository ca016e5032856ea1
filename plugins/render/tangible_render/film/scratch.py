"""The arrays that a frame is made in, and how far beyond the heights they reach."""

from typing import NamedTuple, Self

import numpy as np
from jaxtyping import Float32, UInt8

from ..surface.coefficients import BORDER

TAPS = 10
"""Cells to each side that a coefficient is made of: farther ones weigh less than (2 - sqrt 3)^11, 5e-7 of a height."""
MARGIN, RING = BORDER + TAPS, BORDER + 1
"""Cells beyond each border: of values, for the filter; and of the mask, which has one more of nothing all round."""


class Scratch(NamedTuple):
    """What is written to on the way, so that a frame needs no memory of its own."""

    at: UInt8[np.ndarray, "h w"]
    wide: UInt8[np.ndarray, "h w"]
    near: UInt8[np.ndarray, "h6 w6"]
    values: Float32[np.ndarray, "hm wm"]
    eased: Float32[np.ndarray, "hm wm"]
    coefficients: Float32[np.ndarray, "h4 w4"]
    ends: Float32[np.ndarray, "h4 w4"]

    @classmethod
    def of(cls, rows: int, columns: int) -> Self:
        """For heights of this size."""
        padded = rows + 2 * MARGIN, columns + 2 * MARGIN
        with_border = rows + 2 * BORDER, columns + 2 * BORDER
        return cls(
            np.empty((rows, columns), np.uint8),
            np.empty((rows, columns), np.uint8),
            np.empty((rows + 2 * RING, columns + 2 * RING), np.uint8),
            np.empty(padded, np.float32),
            np.empty(padded, np.float32),
            np.empty(with_border, np.float32),
            np.empty(with_border, np.float32),
        )
