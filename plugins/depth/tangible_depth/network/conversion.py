"""Conversion of a network's numbers to a disparity map."""

import numpy as np
from jaxtyping import Float32

from tangible_core.data import DisparityMap, Views

from .card import Means

Map = Float32[np.ndarray, "h w"]
"""A map of a network."""


def to_disparity(values: Map, sure: Map | None, means: Means, views: Views) -> DisparityMap:
    """Convert a network's numbers to a disparity map; unknown where a number is not finite or not a distance.

    With known cameras metres become pixels, Z = f b / (d + offset) solved for d; all other maps of one picture are
    stretched to 0 (far) .. 1 (near). sure: confidence 0..1, or None for 1 everywhere.
    """
    known = np.isfinite(values)
    if means != "disparity-px":
        known &= values > 0 if means in ("depth", "depth-m") else known
    values = np.where(known, values, 1).astype(np.float64)
    cameras = views.calibration
    if means == "disparity-px":
        disparity = values
    elif means == "depth-m" and cameras is not None:
        disparity = cameras.focal_px * cameras.baseline_m / values - cameras.offset_px
    else:
        near = values if means == "inverse-depth" else 1 / values
        disparity = _stretch(near, known)
    in_px = means == "disparity-px" or (means == "depth-m" and cameras is not None)
    confidence = np.ones_like(disparity) if sure is None else np.clip(np.nan_to_num(sure), 0, 1)
    return DisparityMap(
        np.where(known, disparity, np.nan).astype(np.float32),
        np.where(known, confidence, 0).astype(np.float32),
        "px" if in_px else "relative",
    )


def _stretch(near: np.ndarray, known: np.ndarray) -> np.ndarray:
    """Stretch to 0..1; all 0 if everything is equally near."""
    if not known.any():
        return near
    low, high = float(near[known].min()), float(near[known].max())
    if high - low <= 4 * np.finfo(np.float32).eps * max(abs(low), abs(high)):
        return np.zeros_like(near)
    return np.clip((near - low) / (high - low), 0, 1)
