"""Pictures of a scene, and the maps that are computed from them: disparity, segments, parts.

Coordinates in pictures are (column, row) in pixels, with pixel centres at whole numbers.
"""

from dataclasses import dataclass, field
from typing import Literal

import numpy as np
from jaxtyping import Bool, Float32, Int32, Integer

from ..errors import GeometryError, PictureError
from .arguments import named_fields
from .pictures import check_picture, check_same_shape, size_in_words
from .records import Record, as_read_only, settle


@named_fields
@dataclass(frozen=True, eq=False)
class Calibration(Record):
    """A rectified pair of cameras: Z = focal_px * baseline_m / (disparity_px + offset_px).

    Raises: GeometryError if focal_px or baseline_m is not positive.
    """

    focal_px: float
    baseline_m: float
    offset_px: float = 0.0
    """The difference of the principal points' columns, right minus left, px (Middlebury's `doffs`)."""
    vertical: bool = False
    """The right camera stands below the left one: a left pixel (row, x) matches (row - d, x)."""

    def __post_init__(self) -> None:
        super().__post_init__()
        if not (0 < self.focal_px < np.inf and 0 < self.baseline_m < np.inf and np.isfinite(self.offset_px)):
            raise GeometryError(
                f"a calibration needs focal_px > 0 and baseline_m > 0, not {self.focal_px} px and {self.baseline_m} m"
            )


@named_fields
@dataclass(frozen=True, eq=False)
class Views(Record):
    """A picture of a scene, or a pair of pictures, as arrays; `Scene` also reads files and is what a pipeline takes.

    (h, w) or (h, w, 3 or 4), of uint8, uint16, bool or float in 0..1. A pair is rectified: matches share their row.

    >>> import numpy as np
    >>> Views(np.zeros((48, 64), np.uint8)).shape
    (48, 64)

    Raises: PictureError if an array is not a picture, holds NaN or infinity, or the two differ in size.
    """

    left: np.ndarray
    right: np.ndarray | None = None
    calibration: Calibration | None = None

    def __post_init__(self) -> None:
        super().__post_init__()
        object.__setattr__(self, "left", as_read_only(check_picture(self.left, "left view")))
        if self.right is not None:
            object.__setattr__(self, "right", as_read_only(check_picture(self.right, "right view")))
            if self.left.shape[:2] != self.right.shape[:2]:
                raise PictureError(
                    f"the left view is {size_in_words(self.left)} and the right one {size_in_words(self.right)}; "
                    "both views must be of one size"
                )

    @property
    def shape(self) -> tuple[int, int]:
        """(h, w) of the left view."""
        return self.left.shape[:2]


@named_fields
@dataclass(frozen=True, eq=False)
class DisparityMap(Record):
    """The shift of each left pixel against the right view, or relative nearness from one picture.

    disparity_px: float32 (h, w), NaN where unknown; larger is nearer. A left pixel (row, x) matches (row, x - d).
    confidence: float32 (h, w) in 0..1; by default 1 where the disparity is known and 0 elsewhere.
    unit: "px" for stereo, "relative" (0 far .. 1 near) for one picture.
    Raises: PictureError for infinity, or a confidence of another size.
    """

    disparity_px: Float32[np.ndarray, "h w"]
    confidence: Float32[np.ndarray, "h w"] = field(default_factory=lambda: np.empty((0, 0), np.float32))
    unit: Literal["px", "relative"] = "px"

    def __post_init__(self) -> None:
        settle(self)
        if self.confidence.size == 0:
            object.__setattr__(self, "confidence", np.isfinite(self.disparity_px).astype(np.float32))
        check_same_shape("disparity_px", self.disparity_px, "confidence", self.confidence)
        if infinite := np.count_nonzero(np.isinf(self.disparity_px)):
            count = f"{infinite} of {self.disparity_px.size} values {'is' if infinite == 1 else 'are'} infinite"
            raise PictureError(f"disparity_px: {count}; write NaN where the disparity is unknown")
        super().__post_init__()


@named_fields
@dataclass(frozen=True, eq=False)
class SegmentMap(Record):
    """The texture segment of each pixel.

    labels: int32 (h, w), 0..n-1, each of them present.
    confidence: float32 (h, w) in 0..1; by default 1 everywhere.
    """

    labels: Int32[np.ndarray, "h w"]
    confidence: Float32[np.ndarray, "h w"] = field(default_factory=lambda: np.empty((0, 0), np.float32))

    def __post_init__(self) -> None:
        settle(self)
        if self.confidence.size == 0:
            object.__setattr__(self, "confidence", np.ones(self.labels.shape, np.float32))
        check_same_shape("labels", self.labels, "confidence", self.confidence)
        super().__post_init__()

    @property
    def count(self) -> int:
        """The number of segments."""
        return int(self.labels.max()) + 1


@named_fields
@dataclass(frozen=True, eq=False)
class SegmentTree(Record):
    """Regions of a picture joined pair by pair, from the smallest ones to the whole: any number of segments at once.

    labels: int32 (h, w), the smallest regions, 0..n-1, each of them present.
    joins: int32 (n - 1, 2), the two nodes of each joining. Nodes 0..n-1 are the smallest regions, n + i is joining i.
    levels: float32 (n - 1), rising within 0..1: how sure it is that people see a border there.
    """

    labels: Int32[np.ndarray, "h w"]
    joins: Int32[np.ndarray, "joins 2"]
    levels: Float32[np.ndarray, "joins"] = field(default_factory=lambda: np.empty(0, np.float32))

    def cut(self, most: int, level: float = 0.0) -> SegmentMap:
        """Return the segments between borders of at least a level, at most `most` of them.

        The confidence of a segment is the level at which it is joined; that of the whole picture is 1.
        """
        count = len(self.joins) + 1
        joining_count = max(count - most, int(np.searchsorted(self.levels, level)))
        roots, sure = np.arange(count + joining_count), np.ones(count + len(self.joins), np.float32)
        for at in reversed(range(joining_count)):
            roots[self.joins[at]] = roots[count + at]
        for at in range(joining_count, len(self.joins)):
            sure[self.joins[at]] = self.levels[at]
        _, names = np.unique(roots[:count], return_inverse=True)
        return SegmentMap(names.astype(np.int32)[self.labels], sure[roots[:count]][self.labels])


@named_fields
@dataclass(frozen=True, eq=False)
class PartMap(Record):
    """The part of each pixel. A part is a piece of one segment whose pixels are connected by their sides.

    labels: int32 (h, w), numbers of parts from 0, in the order of their first pixels, row by row. On a coarser grid
    (see `parts.reduced_parts`) the numbers are those of the whole picture, and a part may have no pixel there.
    segments: the segment of each part.
    Raises: PictureError if a label is not the number of a part.
    """

    labels: Int32[np.ndarray, "h w"]
    segments: tuple[int, ...]

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.labels.ndim != 2 or self.labels.size == 0:
            raise PictureError(f"parts are numbers (h, w) of at least one pixel, not {self.labels.shape}")
        low, high = int(self.labels.min()), int(self.labels.max())
        if low < 0 or high >= self.count:
            raise PictureError(
                f"the numbers of parts in {size_in_words(self.labels)} pixels run from {low} to {high}, "
                f"and segments are given for {self.count} parts; give one for each part"
            )

    @property
    def count(self) -> int:
        """The number of parts."""
        return len(self.segments)


def border_pixels(labels: Integer[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    """Return a mask of the pixels that share a side with a pixel of another label."""
    across, along = labels[:, 1:] != labels[:, :-1], labels[1:] != labels[:-1]
    mask = np.zeros(labels.shape, np.bool_)
    mask[:, 1:] |= across
    mask[:, :-1] |= across
    mask[1:] |= along
    mask[:-1] |= along
    return mask
