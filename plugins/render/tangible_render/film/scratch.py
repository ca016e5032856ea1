"""The scratch arrays of a frame, and their margins beyond the heights."""

from typing import NamedTuple, Self

import numpy as np
from jaxtyping import Float32, UInt8

from ..surface.coefficients import BORDER

# The reach of the filter in cells: further heights weigh less than (2 - sqrt 3)^11, 5e-7.
TAPS = 10
MARGIN = BORDER + TAPS
RING = BORDER + 1  # the cells of the mask beyond each border, the outermost of which are 0


class Scratch(NamedTuple):
    """The scratch arrays of a frame, allocated once for all frames."""

    at: UInt8[np.ndarray, "h w"]
    wide: UInt8[np.ndarray, "h w"]
    near: UInt8[np.ndarray, "h6 w6"]
    values: Float32[np.ndarray, "hm wm"]
    smooth: Float32[np.ndarray, "hm wm"]
    coefficients: Float32[np.ndarray, "h4 w4"]
    ends: Float32[np.ndarray, "h4 w4"]

    @classmethod
    def of(cls, rows: int, columns: int) -> Self:
        """Allocate the arrays for heights of this size."""
        with_margin = rows + 2 * MARGIN, columns + 2 * MARGIN
        with_border = rows + 2 * BORDER, columns + 2 * BORDER
        return cls(
            np.empty((rows, columns), np.uint8),
            np.empty((rows, columns), np.uint8),
            np.empty((rows + 2 * RING, columns + 2 * RING), np.uint8),
            np.empty(with_margin, np.float32),
            np.empty(with_margin, np.float32),
            np.empty(with_border, np.float32),
            np.empty(with_border, np.float32),
        )
