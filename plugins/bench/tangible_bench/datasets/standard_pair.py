"""A pair of a standard set: the paths of its files, and the pair itself once they are read."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Bool, Float32

from tangible_core.data import Calibration, Record, Views, size_in_words
from tangible_core.errors import ConfigError, PictureError
from tangible_core.runtime import cv2, plain_opencv
from tangible_core.scene import Scene, SceneFiles
from tangible_core.scene.formats import TruthScale, read_map

from ..metrics.standard_sets import visible_pixels
from .cameras import Cameras, ReadCameras


def shrink_views(views: Views, by: int) -> Views:
    """Replace blocks of `by` x `by` pixels by their mean; rows and columns that are left over at the end are cut."""
    if by == 1:
        return views
    old = views.calibration
    cameras = old and Calibration(old.focal_px / by, old.baseline_m, old.offset_px / by)
    return Views(_mean(views.left, by), None if views.right is None else _mean(views.right, by), cameras)


def shrink_truth(truth_px: Float32[np.ndarray, "h w"], by: int) -> Float32[np.ndarray, "r c"]:
    """Return the upper median of the known values of blocks, in smaller pixels; NaN if most are unknown."""
    if by == 1:
        return truth_px
    blocks = np.sort(_blocks(truth_px, by), axis=-1)  # NaN last
    count_valid = np.isfinite(blocks).sum(axis=-1)
    # A mean would lie between the two surfaces at an edge, where there is nothing.
    middle = np.take_along_axis(blocks, np.minimum(count_valid // 2, by * by - 1)[..., None], axis=-1)[..., 0]
    return np.where(2 * count_valid >= by * by, middle / np.float32(by), np.float32(np.nan))


def shrink_mask(mask: Bool[np.ndarray, "h w"], by: int) -> Bool[np.ndarray, "r c"]:
    """Return a mask of the blocks of which most pixels are marked."""
    return mask if by == 1 else 2 * _blocks(mask, by).sum(axis=-1) > by * by


def _mean(picture: np.ndarray, by: int) -> np.ndarray:
    rows, columns = (max(1, side // by) for side in picture.shape[:2])
    whole = np.ascontiguousarray(picture[: rows * by, : columns * by])
    with plain_opencv():
        return cv2.resize(whole, (columns, rows), interpolation=cv2.INTER_AREA)


def _blocks(values: np.ndarray, by: int) -> np.ndarray:
    """Return the blocks, (rows, columns, by * by). A side shorter than `by` is repeated at its end."""
    rows, columns = (max(1, side // by) for side in values.shape)
    short = [(0, max(0, by - side)) for side in values.shape]
    whole = np.pad(values, short, mode="edge")[: rows * by, : columns * by]
    return whole.reshape(rows, by, columns, by).swapaxes(1, 2).reshape(rows, columns, by * by)


Resolution = Literal["F", "H", "T", "Q"]
FULL_PX: dict[Resolution | None, int] = {None: 1, "F": 1, "H": 2, "T": 3, "Q": 4}
"""The width of a pixel of each resolution, in pixels of the full size."""


class Mask(NamedTuple):
    """Mask pictures; the mask has the pixels that all of them mark."""

    files: tuple[Path, ...]
    marks: Literal["at 255", "above 0", "at 0"]


@dataclass(frozen=True, eq=False)
class MarkedPair(Record):
    """A pair with the truth (px, NaN where unknown), masks and range of its benchmark.

    noc: pixels that both views show. foreground: pixels of moving objects. full_px: the width of a pixel in pixels of
    the full size; None for a set in one size. most_px: the largest disparity that methods are given.
    """

    views: Views
    truth_px: Float32[np.ndarray, "h w"] | None = None
    noc: Bool[np.ndarray, "h w"] | None = None
    foreground: Bool[np.ndarray, "h w"] | None = None
    full_px: float | None = None
    most_px: float | None = None


@dataclass(frozen=True)
class StandardPair:
    """The files of a pair of a set; none is read before the pair is opened."""

    name: str
    left: Path
    right: Path
    truth: Path | None = None  # the true disparity; None if the benchmark keeps it
    truth_scale: TruthScale | None = None
    noc: Mask | None = None  # the mask of pixels that both views show; None to derive it from a dense truth
    foreground: Mask | None = None
    # True if the truth has gaps, such as a laser's, so that occlusion does not follow from it.
    sparse: bool = False
    cameras: ReadCameras = Cameras
    resolution: Resolution | None = None  # the size of the opened pair; None for a set in one size
    shrink: int = 1  # the factor by which the files are larger than the opened pair
    test: bool = False  # true if the pair is in the benchmark's test part, for which results are submitted

    def files(self) -> SceneFiles:
        """Return the files for a pipeline. Raises: ConfigError for a pair smaller than its files; PictureError."""
        if self.shrink > 1:
            raise ConfigError(
                f"{self.name} is not in its folder at {self.resolution}; fetch that size, or leave `resolution:` out"
            )
        return self._files(self.cameras())

    def scene(self) -> Scene:
        """Read the pair for a pipeline. Raises: as `files`; PictureError for a file that cannot be read."""
        return Scene.read(self.files(), Path())

    def open(self) -> MarkedPair:
        """Read the pair with its masks. Raises: PictureError for a file that cannot be read, or has another size."""
        cameras = self.cameras()
        scene = Scene.read(self._files(cameras), Path())
        assert scene.views is not None
        shape = scene.views.shape
        noc, foreground = (mask and _read_mask(mask, shape, self.left) for mask in (self.noc, self.foreground))
        truth_px = scene.truth
        if truth_px is not None and noc is None and not self.sparse:
            noc = visible_pixels(truth_px)
        by = self.shrink
        return MarkedPair(
            shrink_views(scene.views, by),
            None if truth_px is None else shrink_truth(truth_px, by),
            None if noc is None else shrink_mask(noc, by),
            None if foreground is None else shrink_mask(foreground, by),
            None if self.resolution is None else float(FULL_PX[self.resolution]),
            None if cameras.most_px is None else cameras.most_px / by,
        )

    def _files(self, cameras: Cameras) -> SceneFiles:
        rig = cameras.calibration
        rig_keys = {} if rig is None else {"focal_px": rig.focal_px, "baseline_m": rig.baseline_m}
        rig_keys |= {"offset_px": rig.offset_px} if rig is not None and rig.offset_px else {}
        truth = {} if self.truth is None else {"truth": self.truth, "truth_scale": self.truth_scale}
        views = {"left": self.left, "right": self.right, "order": "as-named"}
        return SceneFiles.model_validate({**views, **rig_keys, **truth})


def _read_mask(mask: Mask, shape: tuple[int, int], picture: Path) -> Bool[np.ndarray, "h w"]:
    is_marked = np.ones(shape, np.bool_)
    for path in mask.files:
        values = read_map(path)
        if values.shape != shape:
            sizes = f"{path} is {size_in_words(values)} and {picture} {shape[1]} x {shape[0]}"
            raise PictureError(f"{sizes}; a mask has the size of its picture; unpack it again")
        is_marked &= {"at 255": values == 255, "above 0": values > 0, "at 0": values == 0}[mask.marks]
    return is_marked
