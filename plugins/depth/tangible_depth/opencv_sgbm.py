"""OpenCV's semi-global block matcher."""

from math import floor, log2
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from jaxtyping import Bool, Float32, UInt8
from pydantic import Field, model_validator

from tangible_core.data import DisparityMap, Views, to_grey
from tangible_core.errors import PictureError
from tangible_core.plugins import DepthEstimator, Skippable
from tangible_core.runtime import cv2
from tangible_core.scene import fill_rows


def left_right_confidence(
    left_px: Float32[np.ndarray, "h w"], right_px: Float32[np.ndarray, "h w"]
) -> Float32[np.ndarray, "h w"]:
    """Measure how far both views agree, max(0, 1 - |d_L(x) - d_R(x - d_L(x))| / 1 px), 0 if unknown (Fua 1993)."""
    columns = left_px.shape[1]
    target = np.arange(columns) - left_px
    inside = (target > -0.5) & (target < columns - 0.5)
    nearest = np.rint(np.where(inside, target, 0)).astype(np.int32)
    gap = np.abs(np.where(inside, left_px, np.nan) - np.take_along_axis(right_px, nearest, axis=1))
    return np.nan_to_num(np.clip(1 - gap, 0, 1), nan=0).astype(np.float32)


MODES = {"sgbm": 0, "hh": 1, "3way": 2, "hh4": 3}

# Steps of a pixel in OpenCV's disparities, and the number of which its range must be a multiple.
STEP = 16
AGREEMENT_PX, DERIVATIVE_CAP = 1, 63
"""Tolerance of OpenCV's own left-right check, in pixels, and the limit of the derivatives that it compares."""


class OpenCVSGBM(DepthEstimator, Skippable):
    """OpenCV's semi-global block matching of a rectified pair.

    Penalties follow OpenCV's documentation for one channel, P1 = 8 b^2 and P2 = 32 b^2 for blocks of side b. Views are
    matched in grey, at eight bits. They are padded sideways, so that every column gets a disparity. A block without any
    change along its rows stays unknown: OpenCV would invent a disparity.

    Source: Hirschmueller, PAMI 2008; Birchfield & Tomasi, PAMI 1998, for the cost.
    """

    needs_pair: ClassVar[bool] = True
    mode: Literal["3way", "hh4", "sgbm", "hh"] = "3way"
    """Number of directions along which costs are aggregated: `3way` 3 and `sgbm` 5, in little memory; `hh4` 4 and `hh`
    8, with 4 bytes per pixel and disparity."""
    block_px: Annotated[int, Field(ge=1, le=11)] = 5
    """Side of the blocks that are matched; odd."""
    min_disparity_px: Annotated[int, Field(ge=-2016, le=2016)] = 0
    """Smallest disparity searched; negative where the cameras converge."""
    max_disparity_px: Annotated[int, Field(ge=-2016, le=2016)] = 64
    """Upper end of the search range, exclusive."""
    uniqueness_percent: Annotated[int, Field(ge=0, le=99)] = 10
    """Margin by which the best cost must beat all others except its neighbours; otherwise the disparity is unknown."""
    speckle_size: Annotated[int, Field(ge=0)] = 100
    """Speckles of at most this many pixels are removed; 0 keeps all."""
    speckle_step_px: Annotated[int, Field(ge=1, le=16)] = 2
    """Largest difference of disparity between neighbours within one speckle."""
    second_pass: bool = True
    """Match from the right view too, for a graded confidence, in twice the time. Without it, every known disparity has
    confidence 1."""
    fill: bool = False
    """Fill unknown disparities from the background in their row (`fill_rows`), with confidence 0."""

    @model_validator(mode="after")
    def _check_range(self) -> Self:
        if self.max_disparity_px <= self.min_disparity_px:
            raise ValueError(
                f"max_disparity_px {self.max_disparity_px} must be above min_disparity_px {self.min_disparity_px}"
            )
        if self.block_px % 2 == 0:
            raise ValueError(f"block_px {self.block_px} must be odd")
        return self

    def skip(self, views: Views) -> str | None:
        """Return the reason to skip a pair of identical views, which shows no depth."""
        if views.right is not None and np.array_equal(views.left, views.right):
            return "both views are identical: there is no depth to find"
        return None

    def estimate(self, views: Views) -> DisparityMap:
        """Estimate disparity in pixels, NaN if unknown, with `left_right_confidence`. Raises: PictureError."""
        if views.right is None:
            raise PictureError(
                "stereo needs two views, but this scene has one; use a method for a single picture, such as luminance"
            )
        left, right = _eight_bits(views.left, views.right)
        disparity = np.where(_has_texture(left, self.block_px), self._match(left, right), np.float32(np.nan))
        confidence = np.isfinite(disparity).astype(np.float32)
        if self.second_pass:
            confidence = left_right_confidence(disparity, self._match(right[:, ::-1], left[:, ::-1])[:, ::-1])
        if self.fill and not np.isnan(disparity).all():
            disparity = fill_rows(disparity)
        return DisparityMap(disparity, confidence)

    def _match(self, left: UInt8[np.ndarray, "h w"], right: UInt8[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
        """Match the left view, NaN if unknown; the range is first clipped to the picture's width."""
        width = left.shape[1]
        low, high = max(self.min_disparity_px, 1 - width), min(self.max_disparity_px, width)
        if low >= high:
            return np.full(left.shape, np.nan, np.float32)
        disparity = self._compute(left, right, low, -(-(high - low) // STEP) * STEP)
        in_range = (disparity > low - 0.5) & (disparity < high - 0.5)
        return np.where(in_range, disparity, np.float32(np.nan))

    def _compute(
        self, left: UInt8[np.ndarray, "h w"], right: UInt8[np.ndarray, "h w"], low: int, count: int
    ) -> Float32[np.ndarray, "h w"]:
        """Run OpenCV for `count` disparities from `low`, in pixels; unknown ones are below `low`."""
        block = self.block_px
        before, after = (
            max(low + count, 0),
            max(-low, 0) + block // 2,
        )  # columns that OpenCV leaves out, and its least width
        matcher = cv2.StereoSGBM.create(
            minDisparity=low,
            numDisparities=count,
            blockSize=block,
            P1=8 * block**2,
            P2=32 * block**2,
            disp12MaxDiff=AGREEMENT_PX,
            preFilterCap=DERIVATIVE_CAP,
            uniquenessRatio=self.uniqueness_percent,
            speckleWindowSize=self.speckle_size,
            speckleRange=self.speckle_step_px,
            mode=MODES[self.mode],
        )
        try:
            frames = (np.pad(view, ((0, 0), (before, after)), mode="edge") for view in (left, right))
            sixteenths = matcher.compute(*frames)[:, before : before + left.shape[1]]
        except (cv2.error, MemoryError) as error:
            raise PictureError(
                f"OpenCV cannot match a pair of {left.shape[1]} x {left.shape[0]} over {count} disparities in mode "
                f"{self.mode!r}: {error}; try mode '3way', a smaller range or smaller pictures"
            ) from error
        return sixteenths.astype(np.float32) / STEP


def _eight_bits(left: np.ndarray, right: np.ndarray) -> list[UInt8[np.ndarray, "h w"]]:
    """Convert both views to grey, multiplied by a power of two if they leave the upper half of the range unused."""
    greys = [np.clip(to_grey(view), 0, 1) for view in (left, right)]
    peak = max(float(grey.max()) for grey in greys)
    # So a 12-bit pair in 16-bit files keeps its detail, and a picture gives the same result in any type.
    gain = 255 * 2.0 ** floor(-log2(peak)) if peak > 0 else 0.0
    return [np.rint(grey * np.float32(gain)).astype(np.uint8) for grey in greys]


def _has_texture(grey: UInt8[np.ndarray, "h w"], block_px: int) -> Bool[np.ndarray, "h w"]:
    """Test each pixel for a change along the rows within its block, of at least 3 px."""
    change = np.zeros(grey.shape, np.uint8)
    change[:, 1:] = grey[:, 1:] != grey[:, :-1]
    side = max(block_px, 3)
    # A change lies between two columns, so a block has one column of changes less than of pixels.
    return cv2.dilate(change, np.ones((side, side - 1), np.uint8), anchor=(side // 2 - 1, side // 2)) > 0
