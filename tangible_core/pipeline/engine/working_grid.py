"""The grid on which products are made: the pictures, reduced where they are finer than the workspace's `finest_m`."""

from collections.abc import Sequence
from functools import cached_property
from typing import Literal, final

import numpy as np
from jaxtyping import Bool

from ...data import DisparityMap, PartMap, Relief, SegmentMap, Views
from ...data.records import digest_of
from ...parts import Layering, reduced_parts
from ...scene import scaling
from ...scene.geometry import smooth
from ...scene.scene import Scene
from ...scene.workspace import FeltSize


@final
class WorkingGrid:
    """A scene on the working grid; pictures and masks are reduced at their first use."""

    def __init__(self, scene: Scene, size: FeltSize) -> None:
        self.scene = scene
        self.factor: float = scaling.felt_factor(scene.shape[1], size.width_m, size.finest_m)
        self.shape: tuple[int, int] = scaling.reduced_shape(scene.shape, self.factor)
        """(h, w) of the grid."""
        self.note: str = _note(self.factor, size.finest_m)
        """A sentence about the reduction; empty for a grid of the pictures' size."""

    @property
    def key(self) -> str:
        """The part of a product's key that depends on the grid."""
        known_key = "" if self.scene.known is None else f"known {digest_of(self.scene.known)}"
        shown_key = "" if self.scene.shown is None else f"shown {digest_of(self.scene.shown)}"
        return f"1/{self.factor} {known_key} {shown_key}"

    @cached_property
    def views(self) -> Views | None:
        """The pictures; without calibration where they are reduced."""
        return None if self.scene.views is None else scaling.reduce_views(self.scene.views, self.factor)

    @cached_property
    def known_mask(self) -> Bool[np.ndarray, "h w"] | None:
        """A mask, True where the pictures have values; None for everywhere."""
        return None if self.scene.known is None else scaling.reduced_mask(self.scene.known, self.shape)

    @cached_property
    def opaque_mask(self) -> Bool[np.ndarray, "h w"] | None:
        """A mask, True where the pictures are opaque; None for everywhere."""
        mask = None if self.scene.shown is None else scaling.reduced_mask(self.scene.shown, self.shape)
        return None if mask is None or mask.all() else mask

    def full_disparity(self, disparity: DisparityMap) -> DisparityMap:
        """Return a map on this grid for every pixel of the pictures."""
        return known_disparity(scaling.on_grid(disparity, self.scene.shape), self.scene.known)

    def full_segments(self, segments: SegmentMap) -> SegmentMap:
        """Return segments on this grid for every pixel of the pictures."""
        return known_segments(scaling.enlarged_segments(segments, self.scene.shape), self.scene.known)

    def full_parts(self, parts: PartMap) -> PartMap:
        """Return parts on this grid for every pixel of the pictures, with the same numbers."""
        return scaling.enlarged_parts(parts, self.scene.shape)

    def parts(self, parts: PartMap, product: Literal["parts", "simplified"]) -> PartMap:
        """Return parts of any size on this grid, as `parts_on_grid`."""
        return parts_on_grid(parts, self.shape, product)


def known_disparity(disparity: DisparityMap, valid_mask: Bool[np.ndarray, "h w"] | None) -> DisparityMap:
    """Return the map with NaN and confidence 0 where `valid_mask` is False; None keeps it."""
    if valid_mask is None:
        return disparity
    values_px = np.where(valid_mask, disparity.disparity_px, np.float32(np.nan))
    return DisparityMap(values_px, disparity.confidence * valid_mask, disparity.unit)


def known_segments(segments: SegmentMap, valid_mask: Bool[np.ndarray, "h w"] | None) -> SegmentMap:
    """Return the segments with confidence 0 where `valid_mask` is False; None keeps them."""
    return segments if valid_mask is None else SegmentMap(segments.labels, segments.confidence * valid_mask)


def flatten_transparent(relief: Relief, opaque_mask: Bool[np.ndarray, "h w"] | None) -> Relief:
    """Return the relief at height 0 where the picture is transparent."""
    return (
        relief
        if opaque_mask is None
        else Relief(np.where(opaque_mask, relief.height_m, np.float32(0)), relief.extent_m)
    )


def relief_of_layers(
    layering: Layering, heights_m: Sequence[float], size: FeltSize, opaque_mask: Bool[np.ndarray, "h w"] | None = None
) -> Relief:
    """Return the relief of parts of these heights, smoothed, and at 0 where the picture is transparent."""
    return flatten_transparent(smooth(layering.relief(heights_m), size.smooth_m), opaque_mask)


def parts_on_grid(parts: PartMap, shape: tuple[int, int], product: Literal["parts", "simplified"]) -> PartMap:
    """Return the parts on a grid of (h, w), with the same numbers; each keeps at least one cell."""
    return reduced_parts(parts, shape) if product == "parts" else scaling.enlarged_parts(parts, shape)


def add_ground_segment(segments: SegmentMap, opaque_mask: Bool[np.ndarray, "h w"] | None) -> SegmentMap:
    """Return the segments with all that is transparent as a segment of its own, the last one."""
    if opaque_mask is None:
        return segments
    opaque = np.unique(segments.labels[opaque_mask])
    labels = np.where(opaque_mask, np.searchsorted(opaque, segments.labels), opaque.size)
    return SegmentMap(labels.astype(np.int32), segments.confidence)


def transparent_parts(parts: PartMap, opaque_mask: Bool[np.ndarray, "h w"] | None) -> list[int]:
    """Return the parts that are all transparent. opaque_mask: of the parts' size; None for everywhere opaque."""
    if opaque_mask is None:
        return []
    opaque = np.bincount(parts.labels[opaque_mask], minlength=parts.count)
    total = np.bincount(parts.labels.reshape(-1), minlength=parts.count)
    return np.flatnonzero((opaque == 0) & (total > 0)).tolist()


def _note(factor: float, finest_m: float) -> str:
    if factor == 1:
        return ""
    what = f"at 1/{factor:g} of the size, as detail below {1e3 * finest_m:g} mm cannot be felt"
    return f"{what} (`workspace: {{finest_m: 0}}` keeps everything)"
