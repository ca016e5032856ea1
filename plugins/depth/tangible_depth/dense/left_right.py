"""The left-right check: confidence from the agreement of both views' maps."""

import numpy as np
from jaxtyping import Float32


def left_right_confidence(
    left_px: Float32[np.ndarray, "h w"], right_px: Float32[np.ndarray, "h w"]
) -> Float32[np.ndarray, "h w"]:
    """Measure how far both views agree: c = max(0, 1 - |d_L(x) - d_R(x - d_L(x))| / 1 px).

    Parameters: disparities of the left and of the right view, (h, w), NaN where unknown; both count a left pixel x as
    the match of the right pixel x - d.
    Returns: (h, w) in 0..1; 0 where either is unknown, or the match lies outside the right view.
    Source: Fua, Machine Vision and Applications 6 (1993), the validity test; here graded.
    """
    columns = left_px.shape[1]
    target = np.arange(columns) - left_px
    seen = (target > -0.5) & (target < columns - 0.5)
    nearest = np.rint(np.where(seen, target, 0)).astype(np.int32)
    gap = np.abs(np.where(seen, left_px, np.nan) - np.take_along_axis(right_px, nearest, axis=1))
    return np.nan_to_num(np.clip(1 - gap, 0, 1), nan=0).astype(np.float32)
