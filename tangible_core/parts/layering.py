"""A relief of parts, each at its height, rounded and bulged, with a little of the picture's own light."""
# scipy has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false

from collections.abc import Sequence
from typing import final

import numpy as np
from jaxtyping import Bool, Float32

from ..data import Relief
from ..data.parts import PartMap
from ..data.pictures import check_same_shape, to_grey
from ..errors import GeometryError
from ..runtime.opencv import plain_opencv
from .heights import HeightChoice

QUIET_M = 0.0016
"""Width of the seam along a border in which the detail fades out: the border is felt for itself."""
FINEST_M, COARSEST_M = 0.00025, 0.0012
"""Standard deviations of the two Gaussians between which the picture's light and dark are detail."""


@final
class Layering:
    """What does not depend on the heights of the parts, made once; a relief of such heights is then made at once.

    A part rises from its border to its middle by a quarter of a circle, `round_m` wide, by at most `bulge_m` and at
    most its own height: what lies at 0 is ground and stays flat, and nothing jumps when a height is changed. The
    picture's own rim is no border. The detail lies between 0 and `detail_m`, and fades out towards the borders. So the
    highest place is no higher than the highest part, bulge and detail together.
    """

    def __init__(
        self, parts: PartMap, width_m: float, heights: HeightChoice, picture: np.ndarray | None = None
    ) -> None:
        """picture: of the parts' size; None for no detail.

        Raises: GeometryError if width_m is not positive, PictureError for what is no picture or one of another size.
        """
        rows, columns = parts.labels.shape
        if not 0 < width_m < np.inf:
            raise GeometryError(f"width_m must be a positive length in metres, not {width_m}")
        self.parts = parts
        self._extent_m = (width_m, width_m * rows / columns)
        pitch_m = width_m / columns
        distance_m = border_distance(parts) * np.float32(pitch_m)
        inward = np.clip(distance_m / np.float32(heights.round_m or pitch_m), 0, 1)
        self._rise_m = heights.bulge_m
        self._profile: Float32[np.ndarray, "h w"] = np.sqrt(inward * (np.float32(2) - inward))
        self._detail_m: Float32[np.ndarray, "h w"] | None = None
        if picture is not None and heights.detail_m:
            grey = to_grey(picture)
            check_same_shape("the picture", grey, "the map of its parts", parts.labels)
            fade = np.clip(distance_m / np.float32(QUIET_M), 0, 1)
            self._detail_m = fade * _detail(grey, pitch_m) * np.float32(heights.detail_m)

    def relief(self, heights_m: Sequence[float]) -> Relief:
        """The relief with these heights of the parts, in their order.

        Raises: GeometryError if there is not one finite height >= 0 a part.
        """
        heights = np.asarray(heights_m, np.float32)
        if heights.shape != (self.parts.count,):
            raise GeometryError(f"there are {self.parts.count} parts and {heights.size} heights; give one a part")
        if (wrong := np.flatnonzero(~(np.isfinite(heights) & (heights >= 0)))).size:
            raise GeometryError(f"part {wrong[0]}: its height is {heights[wrong[0]]} m; it must be 0 or more")
        rises = np.minimum(heights, np.float32(self._rise_m))
        found = np.take(rises, self.parts.labels)
        found *= self._profile
        found += np.take(heights, self.parts.labels)
        if self._detail_m is not None:
            found += self._detail_m
        return Relief(found, self._extent_m)


def border_distance(parts: PartMap) -> Float32[np.ndarray, "h w"]:
    """Pixels from each pixel's centre to the nearest border of two parts; infinite where there is none."""
    from scipy.ndimage import distance_transform_edt

    beside = _beside_border(parts)
    if not beside.any():
        return np.full(beside.shape, np.float32(np.inf))
    return (np.asarray(distance_transform_edt(~beside)) + 0.5).astype(np.float32)


def _beside_border(parts: PartMap) -> Bool[np.ndarray, "h w"]:
    labels = parts.labels
    across, along = labels[:, 1:] != labels[:, :-1], labels[1:] != labels[:-1]
    found = np.zeros(labels.shape, np.bool_)
    found[:, 1:] |= across
    found[:, :-1] |= across
    found[1:] |= along
    found[:-1] |= along
    return found


def _detail(grey: Float32[np.ndarray, "h w"], pitch_m: float) -> Float32[np.ndarray, "h w"]:
    """Light and dark of a size that a fingertip feels, 0 to 1; a picture of one shade is 0."""
    import cv2

    with plain_opencv():
        fine, coarse = (
            np.asarray(cv2.GaussianBlur(grey, (0, 0), each / pitch_m, borderType=cv2.BORDER_REPLICATE))
            for each in (FINEST_M, COARSEST_M)
        )
    fine = fine - coarse
    spread = float(fine.std(dtype=np.float64))
    if spread <= 4 * np.finfo(np.float32).eps:
        return np.zeros_like(grey)
    return (np.clip(fine / np.float32(3 * spread), -1, 1) + 1) / 2
