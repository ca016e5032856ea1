"""A picture as a landscape of slopes, in units of the noise, and the edges in it."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, UInt8

from tangible_core.runtime.opencv import plain_opencv

from ..signal.slopes import slopes

_LARGEST = 16000
"""The value of the steepest slope in 16 bits, for Canny's thresholds."""


class Landscape(NamedTuple):
    """Slopes in the channel where they are steepest, in units of the local noise: float32 (h, w) each."""

    steep: Float32[np.ndarray, "h w"]
    """The magnitude."""
    across: Float32[np.ndarray, "h w"]
    down: Float32[np.ndarray, "h w"]


def landscape(smooth: Float32[np.ndarray, "h w c"], most: float, noise: Float32[np.ndarray, "r s"]) -> Landscape:
    """Divide slopes by their noise, which is raised until no slope is above `most`.

    noise: that of the same picture with less smoothing, at any size, of which twice the value bounds the noise here.
    Where edges are many, smoothing leaves little flat area between them, and the slopes measured there are not noise.
    """
    import cv2

    magnitude, across, down, own = slopes(smooth)
    with plain_opencv():
        noise = np.minimum(own, 2 * cv2.resize(noise, own.shape[::-1], interpolation=cv2.INTER_LINEAR))
    noise = np.maximum(noise, np.float32(magnitude.max() / most))
    return Landscape(*(slope / noise for slope in (magnitude, across, down)))


def canny_edges(land: Landscape, low: float, high: float, most: float) -> UInt8[np.ndarray, "h w"]:
    """Return 255 within one pixel of Canny's edges, else 0; the thresholds are in units of the noise."""
    import cv2

    unit = _LARGEST / most
    across, down = (np.rint(slope * np.float32(unit)).astype(np.int16) for slope in (land.across, land.down))
    return cv2.dilate(cv2.Canny(across, down, unit * low, unit * high, L2gradient=True), np.ones((3, 3), np.uint8))
