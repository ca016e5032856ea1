"""The guided filter with a map itself as its guide: it makes noise even, and keeps steps."""

import numpy as np
from jaxtyping import Float32

Map = Float32[np.ndarray, "h w"]


def filter_coefficients(values: Map, radius: float, deviation: float) -> tuple[Map, Map]:
    """Return two maps, of which the filtered map is the first times the values plus the second.

    radius: of the window, cells, at least 1. deviation: the standard deviation below which a window is noise.
    Source: He et al., PAMI 2013.
    """
    import cv2

    side = 2 * max(1, round(radius)) + 1

    def mean(values: np.ndarray) -> np.ndarray:
        return np.asarray(cv2.blur(values, (side, side), borderType=cv2.BORDER_REPLICATE))

    around = mean(values)
    variance = np.maximum(mean(values * values) - around * around, 0)
    kept = variance / (variance + np.float32(deviation**2))
    return mean(kept), mean((1 - kept) * around)
