"""A pair of a standard set: where its files are; and the pair itself, once they are read."""

from dataclasses import dataclass
from pathlib import Path
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Bool, Float32

from tangible_core.data import Record, Views
from tangible_core.data.pictures import size_in_words
from tangible_core.errors import ConfigError, PictureError
from tangible_core.metrics import visible_pixels
from tangible_core.scene.picture_files import read_map
from tangible_core.scene.scene import Scene
from tangible_core.scene.scene_files import SceneFiles
from tangible_core.scene.truth_files import TruthScale

from .cameras import Cameras, ReadCameras, unknown_cameras
from .shrinking import smaller_mask, smaller_truth, smaller_views

Resolution = Literal["F", "H", "T", "Q"]
FULL_PX: dict[Resolution | None, int] = {None: 1, "F": 1, "H": 2, "T": 3, "Q": 4}
"""How many pixels of the full size one pixel is wide."""


class Mask(NamedTuple):
    """Pictures that mark pixels: those that all of them mark."""

    files: tuple[Path, ...]
    marks: Literal["at 255", "above 0", "at 0"]


@dataclass(frozen=True, eq=False)
class MarkedPair(Record):
    """A pair and all that its benchmark knows of it.

    truth_px: true disparity in px, NaN where unknown; None for a pair to submit results of.
    noc: pixels that both views show; None where nobody knows. foreground: pixels of moving objects.
    full_px: how many pixels of the full size one pixel is wide, which the benchmark's thresholds count; None of a set
    that has one size.
    most_px: the largest disparity that methods are told, in pixels of these pictures.
    """

    views: Views
    truth_px: Float32[np.ndarray, "h w"] | None = None
    noc: Bool[np.ndarray, "h w"] | None = None
    foreground: Bool[np.ndarray, "h w"] | None = None
    full_px: float | None = None
    most_px: float | None = None


@dataclass(frozen=True)
class StandardPair:
    """A pair of a set by its files, none of which is read before it is opened."""

    name: str
    left: Path
    right: Path
    truth: Path | None = None
    """None of a pair whose truth its benchmark keeps."""
    truth_scale: TruthScale | None = None
    """See `SceneFiles.truth_scale`."""
    noc: Mask | None = None
    """Which pixels both views show; None for what the truth tells, where it is dense."""
    foreground: Mask | None = None
    sparse: bool = False
    """Truth of a laser has gaps, so that what hides what does not follow from it."""
    cameras: ReadCameras = unknown_cameras
    resolution: Resolution | None = None
    """Of the pair as it is opened; None of a set that has one size."""
    shrink: int = 1
    """By how much the files are larger."""
    test: bool = False
    """Whether results are to be submitted for it."""

    def files(self, cameras: Cameras | None = None) -> SceneFiles:
        """The pair as a pipeline has it. Raises: ConfigError for one that is smaller than its files; PictureError."""
        if self.shrink > 1:
            raise ConfigError(
                f"{self.name} does not lie there at {self.resolution}; fetch that size, or leave `resolution:` out"
            )
        return self._files(self.cameras() if cameras is None else cameras)

    def scene(self) -> Scene:
        """The pair, read for a pipeline. Raises: as `files`; PictureError for a file that cannot be read."""
        return Scene.read(self.files(), Path())

    def open(self) -> MarkedPair:
        """The pair with its masks. Raises: PictureError for a file that cannot be read, or is of another size."""
        cameras = self.cameras()
        scene = Scene.read(self._files(cameras), Path())
        assert scene.views is not None
        shape = scene.views.shape
        noc, foreground = (each and _marked(each, shape, self.left) for each in (self.noc, self.foreground))
        truth_px = scene.truth
        if truth_px is not None and noc is None and not self.sparse:
            noc = visible_pixels(truth_px)
        by = self.shrink
        return MarkedPair(
            smaller_views(scene.views, by),
            None if truth_px is None else smaller_truth(truth_px, by),
            None if noc is None else smaller_mask(noc, by),
            None if foreground is None else smaller_mask(foreground, by),
            None if self.resolution is None else float(FULL_PX[self.resolution]),
            None if cameras.most_px is None else cameras.most_px / by,
        )

    def _files(self, cameras: Cameras) -> SceneFiles:
        rig = cameras.calibration
        known = {} if rig is None else {"focal_px": rig.focal_px, "baseline_m": rig.baseline_m}
        known |= {"offset_px": rig.offset_px} if rig is not None and rig.offset_px else {}
        truth = {} if self.truth is None else {"truth": self.truth, "truth_scale": self.truth_scale}
        return SceneFiles.model_validate(
            {"left": self.left, "right": self.right, "order": "as-named", **known, **truth}
        )


def _marked(mask: Mask, shape: tuple[int, int], left: Path) -> Bool[np.ndarray, "h w"]:
    found = np.ones(shape, np.bool_)
    for path in mask.files:
        values = read_map(path)
        if values.shape != shape:
            raise PictureError(
                f"{path} is {size_in_words(values)} and {left} {shape[1]} x {shape[0]}; a mask has the size of its "
                "picture; unpack it again"
            )
        found &= {"at 255": values == 255, "above 0": values > 0, "at 0": values == 0}[mask.marks]
    return found
