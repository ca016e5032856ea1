"""A picture as a landscape of slopes, in units of the noise, and the edges in it."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, UInt8

from tangible_core.runtime.opencv import plain_opencv

from ..signal.slopes import slopes

_LARGEST = 16000
"""Of 16 bits, what the steepest slope is given before Canny's thresholds."""


class Landscape(NamedTuple):
    """Float32 (h, w) each: slopes in the channel where they are steepest, in units of the noise hereabouts."""

    steep: Float32[np.ndarray, "h w"]
    """The magnitude."""
    across: Float32[np.ndarray, "h w"]
    down: Float32[np.ndarray, "h w"]


def landscape(smooth: Float32[np.ndarray, "h w c"], most: float, noise: Float32[np.ndarray, "r s"]) -> Landscape:
    """Slopes over their noise, which is taken to be such that none is above `most`.

    noise: what the same picture less smooth has, at any size; it is at most twice that. Where edges are many, smoothing
    leaves little that is flat between them, and what is measured there is no noise.
    """
    import cv2

    magnitude, across, down, own = slopes(smooth)
    with plain_opencv():
        noise = np.minimum(own, 2 * cv2.resize(noise, own.shape[::-1], interpolation=cv2.INTER_LINEAR))
    noise = np.maximum(noise, np.float32(magnitude.max() / most))
    return Landscape(*(slope / noise for slope in (magnitude, across, down)))


def canny_edges(land: Landscape, low: float, high: float, most: float) -> UInt8[np.ndarray, "h w"]:
    """255 within one pixel of Canny's edges; the thresholds are in units of the noise."""
    import cv2

    unit = _LARGEST / most
    across, down = (np.rint(slope * np.float32(unit)).astype(np.int16) for slope in (land.across, land.down))
    return cv2.dilate(cv2.Canny(across, down, unit * low, unit * high, L2gradient=True), np.ones((3, 3), np.uint8))
