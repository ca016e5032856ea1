"""The relief of parts, each at its height, rounded and bulged, with a little detail from the picture's light."""
# scipy has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false

from collections.abc import Sequence
from typing import final

import numpy as np
from jaxtyping import Float32

from ..data import Relief, Views
from ..data.part_words import name_part
from ..data.pictures import check_same_shape, to_grey
from ..data.views import PartMap, border_pixels
from ..errors import GeometryError
from ..runtime.opencv import cv2, plain_opencv
from ..scene.scaling import felt_factor, reduce_views
from .heights import HeightChoice

# Width of the seam along a border in which the detail fades out, so that it does not mask the border.
QUIET_M = np.float32(0.0016)
FINEST_M, COARSEST_M = 0.00025, 0.0012
"""Standard deviations of the two Gaussians whose difference is the detail, metres."""


@final
class Layering:
    """A maker of reliefs that computes once all that does not depend on the heights of the parts."""

    def __init__(
        self, parts: PartMap, width_m: float, heights: HeightChoice, picture: np.ndarray | None = None
    ) -> None:
        """picture: of the parts' size, None for no detail. Raises: GeometryError, PictureError."""
        if not 0 < width_m < np.inf:
            raise GeometryError(f"width_m must be a positive length in metres, not {width_m}")
        rows, columns = parts.labels.shape
        pitch_m = width_m / columns
        distance_m = border_distance(parts) * np.float32(pitch_m)
        self.parts = parts
        self._extent_m = (width_m, width_m * rows / columns)
        self._bulge_m = np.float32(heights.bulge_m)
        self._profile = _profile(distance_m, heights.round_m)
        self._detail_m: Float32[np.ndarray, "h w"] | None = None
        if picture is not None and heights.detail_m:
            check_same_shape(
                "the picture", picture[..., 0] if picture.ndim == 3 else picture, "the map of its parts", parts.labels
            )
            fade = np.clip(distance_m / QUIET_M, np.float32(0), np.float32(1))
            self._detail_m = _detail(picture, width_m) * fade * np.float32(heights.detail_m / 2)

    def relief(self, heights_m: Sequence[float]) -> Relief:
        """Make the relief with these heights of the parts, in their order. Raises: GeometryError for a wrong height."""
        heights = np.asarray(heights_m, np.float32)
        if heights.shape != (self.parts.count,):
            raise GeometryError(f"there are {self.parts.count} parts and {heights.size} heights; give one a part")
        if (wrong := np.flatnonzero(~(np.isfinite(heights) & (heights >= 0)))).size:
            raise GeometryError(
                f"{name_part(int(wrong[0]))}: its height is {heights[wrong[0]]} m; it must be 0 or more"
            )
        labels = self.parts.labels
        height_m = np.take(np.minimum(heights, self._bulge_m), labels, mode="clip")  # no label is clipped; fastest
        height_m *= self._profile
        height_m += np.take(heights, labels, mode="clip")
        if self._detail_m is not None:
            height_m += self._detail_m
            np.maximum(height_m, 0, out=height_m)
        return Relief(height_m, self._extent_m)


def border_distance(parts: PartMap) -> Float32[np.ndarray, "h w"]:
    """Return the distance in pixels from each pixel's centre to the nearest border; infinite if there is none."""
    from scipy.ndimage import distance_transform_edt

    at_border = border_pixels(parts.labels)
    if not at_border.any():
        return np.full(at_border.shape, np.float32(np.inf))
    return (np.asarray(distance_transform_edt(~at_border)) + 0.5).astype(np.float32)


def _profile(distance_m: Float32[np.ndarray, "h w"], round_m: float) -> Float32[np.ndarray, "h w"]:
    """Return the rise of a part at this distance from its border, 0 to 1; 0 if there is no border."""
    if not np.isfinite(distance_m[0, 0]):
        return np.zeros_like(distance_m)
    # A part rises by a quarter of a circle, `round_m` wide, by at most `bulge_m` and at most its own height: parts at 0
    # stay flat, and nothing jumps when a height changes. The picture's rim is not a border.
    inward = np.minimum(distance_m / np.float32(round_m), np.float32(1)) if round_m else np.ones_like(distance_m)
    return np.sqrt(inward * (np.float32(2) - inward))


def _detail(picture: np.ndarray, width_m: float) -> Float32[np.ndarray, "h w"]:
    """Return light and dark at a scale that a fingertip feels, from -1 to 1; 0 for a picture of one shade."""
    rows, columns = picture.shape[:2]
    # No finer than needed, so that a picture of more pixels gives the same detail.
    grey = to_grey(reduce_views(Views(picture), felt_factor(columns, width_m, FINEST_M / 3)).left)
    pitch_m = width_m / grey.shape[1]
    with plain_opencv():
        fine, coarse = (
            np.asarray(cv2.GaussianBlur(grey, (0, 0), sigma_m / pitch_m, borderType=cv2.BORDER_REPLICATE))
            for sigma_m in (FINEST_M, COARSEST_M)
        )
        fine -= coarse
        most = np.float32(3 * fine.std(dtype=np.float64))
        if most <= 16 * np.finfo(np.float32).eps:
            return np.zeros((rows, columns), np.float32)
        detail = np.clip(fine / most, -1, 1)
        return np.asarray(cv2.resize(detail, (columns, rows), interpolation=cv2.INTER_LINEAR))
