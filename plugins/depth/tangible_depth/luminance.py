"""Relief from one picture: lighter is nearer."""

from typing import Annotated, ClassVar

import numpy as np
from jaxtyping import Float32, Float64
from pydantic import Field

from tangible_core.data import DisparityMap, Views, to_grey
from tangible_core.plugins import DepthEstimator
from tangible_core.runtime import cv2, plain_opencv


class Luminance(DepthEstimator):
    """Lighter is nearer: the luma of the left view, stretched to 0..1; a picture of one shade is flat at 0.

    Smoothing is a guided filter with the picture as its own guide: it averages where the contrast is low and keeps
    edges. Everything is computed in floating point, so that 256 shades do not become 256 steps under the finger.

    Source: He, Sun & Tang, Guided image filtering, PAMI 2013, sec. 3; luma from ITU-R BT.601.
    """

    finds_depth: ClassVar[bool] = False

    smoothing_px: Annotated[int, Field(ge=0, le=1000)] = 2
    """Radius of the smoothing window; 0 for no smoothing."""
    edge_contrast: Annotated[float, Field(gt=0, le=1)] = 0.05
    """Standard deviation within a window, white being 1, above which it counts as an edge and is not smoothed."""

    def estimate(self, views: Views) -> DisparityMap:
        """Estimate relative disparity 0 (darkest) .. 1 (lightest), known everywhere with confidence 1."""
        grey = to_grey(views.left).astype(np.float64)
        if self.smoothing_px:
            with plain_opencv():
                grey = _guided_filter(grey, self.smoothing_px, self.edge_contrast)
        return DisparityMap(_stretch(grey), unit="relative")


def _guided_filter(grey: Float64[np.ndarray, "h w"], radius_px: int, contrast: float) -> Float64[np.ndarray, "h w"]:
    """Apply the guided filter with guide = input: in each window out = a grey + b, a = var / (var + contrast^2)."""

    def mean(values: np.ndarray) -> np.ndarray:
        return cv2.blur(values, (side, side), borderType=cv2.BORDER_REPLICATE)

    side = 2 * radius_px + 1
    average = mean(grey)
    variance = np.maximum(mean(grey * grey) - average * average, 0)
    slope = variance / (variance + contrast**2)
    return mean(slope) * grey + mean((1 - slope) * average)


def _stretch(grey: Float64[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
    low, high = float(grey.min()), float(grey.max())
    if high - low <= 4 * np.finfo(np.float32).eps:
        return np.zeros(grey.shape, np.float32)
    return ((grey - low) / (high - low)).astype(np.float32)
