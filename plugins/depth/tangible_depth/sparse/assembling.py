"""Assembly of a dense map from scattered disparities: filled along rows and columns, within colour edges."""

import cv2
import numpy as np
from jaxtyping import Float32

from tangible_core.data import DisparityMap, to_rgb8
from tangible_core.drawing import nearest
from tangible_core.runtime import plain_opencv

# Distance of a match from its neighbours' mean, in pixels, above which it is dropped.
STRAY_PX = 2.0


def assemble(
    disparity_px: Float32[np.ndarray, "h w"],
    score: Float32[np.ndarray, "h w"],
    picture: np.ndarray,
    reach_px: float = 20.0,
    colour_step: float = 0.08,
) -> DisparityMap:
    """Fill and smooth scattered matches (NaN without): a mean by score, distance and colour, within colour edges."""
    # Normalised convolution by the domain transform of Gastal & Oliveira, SIGGRAPH 2011: a change of `colour_step`
    # counts as the distance `reach_px`.
    guide = to_rgb8(picture)
    mean, _ = _weighted_mean(disparity_px, score, guide, reach_px, colour_step)
    with np.errstate(invalid="ignore"):
        agreeing = np.where(np.abs(disparity_px - mean) <= STRAY_PX, disparity_px, np.float32(np.nan))
    mean, weight = _weighted_mean(agreeing, score, guide, reach_px, colour_step)
    if not np.isfinite(mean).any():
        return DisparityMap(np.full_like(disparity_px, np.nan))
    confidence = np.where(np.isfinite(agreeing), score, np.minimum(weight, 1))
    return DisparityMap(cv2.medianBlur(fill_nearest(mean), 5), np.clip(confidence, 0, 1).astype(np.float32))


def _weighted_mean(
    values: Float32[np.ndarray, "h w"], score: Float32[np.ndarray, "h w"], guide: np.ndarray, reach: float, step: float
) -> tuple[Float32[np.ndarray, "h w"], Float32[np.ndarray, "h w"]]:
    """Return the mean of the known values near each pixel, NaN out of their reach, and the sum of their weights."""
    valid_mask = np.isfinite(values)
    weight = np.where(valid_mask, score, 0).astype(np.float32)
    with plain_opencv():
        total, weight = (
            cv2.ximgproc.dtFilter(guide, part, reach, 255 * step, mode=cv2.ximgproc.DTF_RF, numIters=3)
            for part in (np.where(valid_mask, values, 0).astype(np.float32) * weight, weight)
        )
    # A smaller float32 sum of decaying weights is rounding error.
    within_reach = weight > 1e-12
    return np.where(within_reach, total / np.where(within_reach, weight, 1), np.float32(np.nan)), weight


def erase_speckles(disparity_px: Float32[np.ndarray, "h w"], most_px: int = 60) -> Float32[np.ndarray, "h w"]:
    """Make islands of at most most_px connected pixels of similar disparity unknown: mostly chance matches."""
    lowest = -2048
    sixteenths = np.where(np.isfinite(disparity_px), 16 * disparity_px, 16 * lowest)
    raster = np.clip(np.rint(sixteenths), 16 * lowest, 32767).astype(np.int16)
    cv2.filterSpeckles(raster, 16 * lowest, most_px, 16)
    return np.where(raster > 16 * lowest, disparity_px, np.float32(np.nan))


def fill_nearest(values: Float32[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
    """Replace NaN by the nearest known value; at least one must be known."""
    unknown = ~np.isfinite(values)
    if not unknown.any():
        return values
    return values.reshape(-1)[nearest(~unknown)[1]]
