"""Smoothing before edges are looked for."""

import numpy as np
from jaxtyping import Float32


def without_specks(values: Float32[np.ndarray, "h w c"]) -> Float32[np.ndarray, "h w c"]:
    """A pixel further from its 8 neighbours than they are from one another takes the nearest of their values.

    Noise, lines, corners and steps stay as they are. A picture of one pixel has no neighbours and stays.
    Source: conservative smoothing (Jain, Kasturi & Schunck, Machine Vision, 1995, ch. 4), held back by the spread.
    """
    import cv2

    if values.shape[0] * values.shape[1] == 1:
        return values
    around = np.array([[1, 1, 1], [1, 0, 1], [1, 1, 1]], np.uint8)
    lowest, highest = (each(values, around).reshape(values.shape) for each in (cv2.erode, cv2.dilate))
    outside = np.maximum(lowest - values, values - highest)
    specks = outside > highest - lowest
    return np.where(specks, np.clip(values, lowest, highest), values)


def gaussian(values: Float32[np.ndarray, "h w c"], sigma_px: float) -> Float32[np.ndarray, "h w c"]:
    """Gaussian smoothing; outside of the picture is its mirror image."""
    import cv2

    return cv2.GaussianBlur(values, (0, 0), sigma_px, borderType=cv2.BORDER_REFLECT).reshape(values.shape)
