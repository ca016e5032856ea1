"""What a network's numbers mean, as a disparity map."""

import numpy as np
from jaxtyping import Float32

from tangible_core.data import DisparityMap, Views

from .card import Means

Map = Float32[np.ndarray, "h w"]


def to_disparity(found: Map, sure: Map | None, means: Means, views: Views) -> DisparityMap:
    """The disparity map that these numbers are; unknown where a number is none, or stands for no distance.

    Metres become Z = f b / (d + offset) solved for d, in pixels, where the cameras are known; everything else from one
    picture is put on 0 (far) to 1 (near).
    """
    known = np.isfinite(found)
    if means != "disparity-px":
        known &= found > 0 if means in ("depth", "depth-m") else known
    values = np.where(known, found, 1).astype(np.float64)
    cameras = views.calibration
    if means == "disparity-px":
        disparity = values
    elif means == "depth-m" and cameras is not None:
        disparity = cameras.focal_px * cameras.baseline_m / values - cameras.offset_px
    else:
        near = values if means == "inverse-depth" else 1 / values
        disparity = _stretched(near, known)
    in_px = means == "disparity-px" or (means == "depth-m" and cameras is not None)
    confidence = np.ones_like(disparity) if sure is None else np.clip(np.nan_to_num(sure), 0, 1)
    return DisparityMap(
        np.where(known, disparity, np.nan).astype(np.float32),
        np.where(known, confidence, 0).astype(np.float32),
        "px" if in_px else "relative",
    )


def _stretched(near: np.ndarray, known: np.ndarray) -> np.ndarray:
    """On 0..1; all 0 where everything is as near."""
    if not known.any():
        return near
    low, high = float(near[known].min()), float(near[known].max())
    if high - low <= 4 * np.finfo(np.float32).eps * max(abs(low), abs(high)):
        return np.zeros_like(near)
    return np.clip((near - low) / (high - low), 0, 1)
