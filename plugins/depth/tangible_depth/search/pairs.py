"""The input of the matchers: two grey pictures of 8 bits."""

from math import floor, log2
from typing import NamedTuple

import cv2
import numpy as np
from jaxtyping import UInt8

from tangible_core.data import Views, to_grey
from tangible_core.errors import PictureError


class Pair(NamedTuple):
    """Two grey pictures (h, w) of one size, each contiguous in memory and read-only."""

    left: UInt8[np.ndarray, "h w"]
    right: UInt8[np.ndarray, "h w"]

    @classmethod
    def of(cls, *pictures: np.ndarray) -> "Pair":
        """Hold read-only views of both pictures: kernels are compiled anew for arrays that can be written."""
        views = [picture.view() for picture in pictures]
        for view in views:
            view.flags.writeable = False
        return cls(*views)

    @property
    def width(self) -> int:
        """The number of columns."""
        return self.left.shape[1]

    def downsample(self, factor: int) -> "Pair":
        """Average factor x factor pixels into one; the edge is repeated to complete the last ones."""
        return self if factor == 1 else Pair.of(*(_downsample(view, factor) for view in self))

    def mirror(self) -> "Pair":
        """Mirror each picture sideways; a disparity d becomes -d."""
        return Pair.of(*(np.ascontiguousarray(view[:, ::-1]) for view in self))

    def exchange(self) -> "Pair":
        """Exchange the views and mirror both; a disparity d stays d."""
        return Pair(*reversed(self.mirror()))


def grey_pair(views: Views, method: str) -> Pair:
    """Convert both views to 8 bits of grey, alike for all data types. Raises: PictureError without a right view."""
    if views.right is None:
        raise PictureError(f"{method} needs two views, but the right one is missing; give both, or use luminance")
    pictures = (views.left, views.right)
    if all(picture.dtype == np.uint8 and (picture.ndim == 2 or picture.shape[2] == 3) for picture in pictures):
        return Pair.of(*(_grey8(picture) for picture in pictures))
    greys = [to_grey(picture) for picture in pictures]
    low = min(0.0, *(float(grey.min()) for grey in greys))
    # Views that leave the upper half of the range unused, as 12 bits in a 16-bit file do, are multiplied by a power of
    # two.
    peaks = [float(grey.max()) - low for grey in greys]
    if views.left.dtype == views.right.dtype:
        peaks = [max(peaks)] * 2
    gains = (255 * 2.0 ** floor(-log2(peak)) if peak > 0 else 0.0 for peak in peaks)
    return Pair.of(
        *(
            np.rint((grey - np.float32(low)) * np.float32(gain)).astype(np.uint8)
            for grey, gain in zip(greys, gains, strict=True)
        )
    )


def _grey8(picture: np.ndarray) -> UInt8[np.ndarray, "h w"]:
    if picture.ndim == 2:
        return np.ascontiguousarray(picture)
    return cv2.cvtColor(np.ascontiguousarray(picture), cv2.COLOR_RGB2GRAY)  # pyright: ignore[reportReturnType]


def _downsample(grey: UInt8[np.ndarray, "h w"], factor: int) -> UInt8[np.ndarray, "-(-h//{factor}) -(-w//{factor})"]:
    h, w = grey.shape
    whole = cv2.copyMakeBorder(grey, 0, -h % factor, 0, -w % factor, cv2.BORDER_REPLICATE)
    size = (whole.shape[1] // factor, whole.shape[0] // factor)
    return cv2.resize(whole, size, interpolation=cv2.INTER_AREA)  # pyright: ignore[reportReturnType]
