"""A relief of parts, each at its height, rounded and bulged, with a little of the picture's own light."""
# scipy has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false

from collections.abc import Sequence
from typing import final

import numpy as np
from jaxtyping import Float32

from ..data import Relief, Views
from ..data.pictures import check_same_shape, to_grey
from ..data.views import PartMap, border_pixels
from ..errors import GeometryError
from ..runtime.opencv import plain_opencv
from ..scene.scaling import felt_factor, reduce_views
from .heights import HeightChoice

QUIET_M = np.float32(0.0016)
"""Width of the seam along a border in which the detail fades out: the border is felt for itself."""
FINEST_M, COARSEST_M = 0.00025, 0.0012
"""Standard deviations of the two Gaussians between which the picture's light and dark are detail."""


@final
class Layering:
    """What does not depend on the heights of the parts, made once; a relief of such heights is then made at once.

    A part rises from its border to its middle by a quarter of a circle, `round_m` wide, by at most `bulge_m` and at
    most its own height: what lies at 0 is ground and stays flat, and nothing jumps when a height is changed. The
    picture's own rim is no border. Of the detail, light rises and dark sinks by up to half of `detail_m`, but nothing
    below 0; it fades out towards the borders, where a part is at its height. So the highest place is no higher than the
    highest part, bulge and detail together.
    """

    def __init__(
        self, parts: PartMap, width_m: float, heights: HeightChoice, picture: np.ndarray | None = None
    ) -> None:
        """picture: of the parts' size; None for no detail.

        Raises: GeometryError if width_m is not positive, PictureError for what is no picture or one of another size.
        """
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
        """The relief with these heights of the parts, in their order.

        Raises: GeometryError if there is not one finite height >= 0 a part.
        """
        heights = np.asarray(heights_m, np.float32)
        if heights.shape != (self.parts.count,):
            raise GeometryError(f"there are {self.parts.count} parts and {heights.size} heights; give one a part")
        if (wrong := np.flatnonzero(~(np.isfinite(heights) & (heights >= 0)))).size:
            raise GeometryError(f"part {wrong[0]}: its height is {heights[wrong[0]]} m; it must be 0 or more")
        labels = self.parts.labels
        found = np.take(np.minimum(heights, self._bulge_m), labels, mode="clip")  # which none is; fastest
        found *= self._profile
        found += np.take(heights, labels, mode="clip")
        if self._detail_m is not None:
            found += self._detail_m
            np.maximum(found, 0, out=found)
        return Relief(found, self._extent_m)


def border_distance(parts: PartMap) -> Float32[np.ndarray, "h w"]:
    """Pixels from each pixel's centre to the nearest border of two parts; infinite where there is none."""
    from scipy.ndimage import distance_transform_edt

    beside = border_pixels(parts.labels)
    if not beside.any():
        return np.full(beside.shape, np.float32(np.inf))
    return (np.asarray(distance_transform_edt(~beside)) + 0.5).astype(np.float32)


def _profile(distance_m: Float32[np.ndarray, "h w"], round_m: float) -> Float32[np.ndarray, "h w"]:
    """How far up from its rim a part has risen at this distance from its border, 0 to 1; 0 where there is no border."""
    if not np.isfinite(distance_m[0, 0]):
        return np.zeros_like(distance_m)
    inward = np.minimum(distance_m / np.float32(round_m), np.float32(1)) if round_m else np.ones_like(distance_m)
    return np.sqrt(inward * (np.float32(2) - inward))


def _detail(picture: np.ndarray, width_m: float) -> Float32[np.ndarray, "h w"]:
    """Light and dark of a size that a fingertip feels, from -1 to 1; a picture of one shade is 0.

    On a grid no finer than it needs, so that a picture of more pixels says the same.
    """
    import cv2

    rows, columns = picture.shape[:2]
    grey = to_grey(reduce_views(Views(picture), felt_factor(columns, width_m, FINEST_M / 3)).left)
    pitch_m = width_m / grey.shape[1]
    with plain_opencv():
        fine, coarse = (
            np.asarray(cv2.GaussianBlur(grey, (0, 0), each / pitch_m, borderType=cv2.BORDER_REPLICATE))
            for each in (FINEST_M, COARSEST_M)
        )
        fine -= coarse
        most = np.float32(3 * fine.std(dtype=np.float64))
        if most <= 16 * np.finfo(np.float32).eps:
            return np.zeros((rows, columns), np.float32)
        found = np.clip(fine / most, -1, 1)
        return np.asarray(cv2.resize(found, (columns, rows), interpolation=cv2.INTER_LINEAR))
