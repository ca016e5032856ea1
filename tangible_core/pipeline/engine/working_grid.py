"""A scene at the size at which it is felt: what is finer than the workspace's `finest_m` is not made."""

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
    """What a scene has on the grid that is felt. Reduced when first asked for, and kept."""

    def __init__(self, scene: Scene, size: FeltSize) -> None:
        self.scene = scene
        self.factor = scaling.felt_factor(scene.shape[1], size.width_m, size.finest_m)
        self.shape = scaling.reduced_shape(scene.shape, self.factor)
        """(h, w) of the grid."""
        self.note = _note(self.factor, size.finest_m)
        """What to say of it; nothing where it is the pictures' own."""

    @property
    def key(self) -> str:
        """What products depend on."""
        known = "" if self.scene.known is None else f"known {digest_of(self.scene.known)}"
        shown = "" if self.scene.shown is None else f"shown {digest_of(self.scene.shown)}"
        return f"1/{self.factor} {known} {shown}"

    @cached_property
    def views(self) -> Views | None:
        """The pictures; without calibration where they are reduced."""
        return None if self.scene.views is None else scaling.reduced(self.scene.views, self.factor)

    @cached_property
    def known(self) -> Bool[np.ndarray, "h w"] | None:
        """Where the pictures are; None for everywhere."""
        return None if self.scene.known is None else scaling.reduced_mask(self.scene.known, self.shape)

    @cached_property
    def shown(self) -> Bool[np.ndarray, "h w"] | None:
        """Where the pictures are opaque; None for everywhere."""
        shown = None if self.scene.shown is None else scaling.reduced_mask(self.scene.shown, self.shape)
        return None if shown is None or shown.all() else shown

    def whole_disparity(self, found: DisparityMap) -> DisparityMap:
        """One that was found on this grid, for every pixel of the pictures."""
        return known_disparity(scaling.on_grid(found, self.scene.shape), self.scene.known)

    def whole_segments(self, found: SegmentMap) -> SegmentMap:
        """Those that were found on this grid, for every pixel of the pictures."""
        return known_segments(scaling.enlarged_segments(found, self.scene.shape), self.scene.known)

    def whole_parts(self, found: PartMap) -> PartMap:
        """Those that were found on this grid, for every pixel of the pictures, with the same numbers."""
        return scaling.enlarged_parts(found, self.scene.shape)


def known_disparity(found: DisparityMap, known: Bool[np.ndarray, "h w"] | None) -> DisparityMap:
    """Unknown where the pictures are."""
    if known is None:
        return found
    return DisparityMap(np.where(known, found.disparity_px, np.float32(np.nan)), found.confidence * known, found.unit)


def known_segments(found: SegmentMap, known: Bool[np.ndarray, "h w"] | None) -> SegmentMap:
    """Of confidence 0 where the pictures are unknown."""
    return found if known is None else SegmentMap(found.labels, found.confidence * known)


def grounded(relief: Relief, shown: Bool[np.ndarray, "h w"] | None) -> Relief:
    """Flat, and at the bottom, where the picture is transparent."""
    return relief if shown is None else Relief(np.where(shown, relief.height_m, np.float32(0)), relief.extent_m)


def layered(
    layering: Layering, heights_m: Sequence[float], size: FeltSize, shown: Bool[np.ndarray, "h w"] | None = None
) -> Relief:
    """The relief of parts of these heights, smoothed, and flat where the picture is transparent."""
    return grounded(smooth(layering.relief(heights_m), size.smooth_m), shown)


def parts_on_grid(parts: PartMap, shape: tuple[int, int], product: Literal["parts", "simplified"]) -> PartMap:
    """The parts as they are felt, with the same numbers.

    Each of the picture's own parts has a cell at least; of one that was simplified away, none is left.
    """
    return reduced_parts(parts, shape) if product == "parts" else scaling.enlarged_parts(parts, shape)


def with_ground(found: SegmentMap, shown: Bool[np.ndarray, "h w"] | None) -> SegmentMap:
    """What is transparent becomes a segment of its own, the last one."""
    if shown is None:
        return found
    kept = np.unique(found.labels[shown])
    labels = np.where(shown, np.searchsorted(kept, found.labels), kept.size)
    return SegmentMap(labels.astype(np.int32), found.confidence)


def _note(factor: float, finest_m: float) -> str:
    if factor == 1:
        return ""
    what = f"at 1/{factor:g} of the size, as finer than {1e3 * finest_m:g} mm is not felt"
    return f"{what} (`workspace: {{finest_m: 0}}` keeps everything)"
