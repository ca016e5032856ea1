"""The task for texture methods, segments compared with the true ones whatever their numbers; and its scenes."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from pathlib import Path
from typing import Annotated, Any, Self

import numpy as np
from pydantic import Field, model_validator

from tangible_core.data import SegmentMap, size_in_words
from tangible_core.errors import PictureError, quoted
from tangible_core.plugins import Segmenter
from tangible_core.scene import Section
from tangible_core.scene.formats import read_labels, read_picture
from tangible_core.testing.synthetic import KnownSegments, folder_textures, smooth_scene, texture_mosaic

from ..datasets import match_files
from ..metrics.segments import segment_errors
from . import damage
from .task import Measure, Perturbation, SceneSpec, Task, check_one_kind, expand_folder, pick_pairs, with_folder_of_file

PICTURE, LABELS = "picture.png", "labels.png"


class LabelGlobs(Section):
    """Patterns of custom files; files belong together if the stars of their patterns match the same."""

    picture: str
    """Pattern of the pictures, such as `images/*.jpg`, relative to `folder`."""
    labels: str
    """Pattern of their labels, a flat colour or grey for each segment, with as many stars."""


class TextureScene(SceneSpec):
    """A picture with true segments: one of mosaic, smooth, folder and pairs."""

    mosaic: Annotated[int, Field(ge=1)] | None = None
    """The number of textures in curvy regions, which grey alone does not tell apart."""
    smooth: Annotated[int, Field(ge=1)] | None = None
    """The number of regions of one grey each, under a slope of light and noise."""
    folder: Path | None = None
    """A folder with picture.png and labels.png, a flat colour or grey for each segment; or with sub-folders that have
    these. With `pairs`, the folder of the patterns."""
    pairs: LabelGlobs | None = None
    """Custom files, matched by patterns."""
    only: tuple[str, ...] = ()
    """Names of such pairs; all of them if left out."""
    textures: Path | None = None
    """A folder of pictures of one texture each, for a mosaic of these in place of the builtin ones."""
    width_px: Annotated[int, Field(ge=16, le=20_000)] = 512
    """Width of a mosaic or a smooth scene."""
    height_px: Annotated[int, Field(ge=16, le=20_000)] = 512
    """Height of a mosaic or a smooth scene."""
    seed: Annotated[int, Field(ge=0)] = 0
    """Regions, textures and noise of a mosaic or a smooth scene."""

    @model_validator(mode="before")
    @classmethod
    def _complete_folder(cls, block: Any) -> Any:
        return with_folder_of_file(block)

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        kinds = [name for name in ("mosaic", "smooth", "pairs") if getattr(self, name) is not None]
        kinds += ["folder"] if self.folder is not None and "pairs" not in kinds else []
        check_one_kind(kinds, "mosaic, smooth, folder and pairs")
        if self.textures is not None and self.mosaic is None:
            raise ValueError(f"textures: only a mosaic is made of them; leave them out of {kinds[0]}")
        return self

    @classmethod
    def parse_name(cls, name: str) -> Mapping[str, Any]:
        kind, _, segments = name.partition("/")
        if kind not in ("mosaic", "smooth") or not segments.isdecimal():
            raise ValueError(f"no scene is named {quoted(name)}; write mosaic/4, smooth/14 or {{folder: ...}}")
        return {kind: int(segments)}

    def expand(self) -> "Mapping[str, TextureScene]":
        if self.pairs is not None:
            return {name: self.model_copy(update={"only": (name,)}) for name in self._matching_pairs()}
        if self.folder is None or (self.folder / PICTURE).exists():
            return {self._name(): self}
        return expand_folder(self, self.folder, PICTURE, f"{PICTURE} and {LABELS}")

    def open(self) -> KnownSegments:
        shape = (self.height_px, self.width_px)
        if self.pairs is not None:
            (files,) = self._matching_pairs().values()
            return _read(files["picture"], files["labels"])
        if self.folder is not None:
            return _read(self.folder / PICTURE, self.folder / LABELS)
        if self.smooth is not None:
            return smooth_scene(self.smooth, shape, self.seed)
        assert self.mosaic is not None  # by _one_kind
        textures = None if self.textures is None else folder_textures(self.textures)
        return texture_mosaic(self.mosaic, shape, self.seed, textures)

    def _matching_pairs(self) -> dict[str, dict[str, Path]]:
        assert self.folder is not None and self.pairs is not None  # by _complete_folder
        patterns = {"picture": self.pairs.picture, "labels": self.pairs.labels}
        return pick_pairs(match_files(self.folder, patterns, ("picture", "labels")), self.only, self.folder)

    def _name(self) -> str:
        if self.folder is not None:
            return self.folder.name
        kind = f"smooth {self.smooth}" if self.mosaic is None else f"mosaic {self.mosaic}"
        of = f" of {self.textures.name}" if self.textures else ""
        return f"{kind}{of} {self.width_px}x{self.height_px}" + (f" seed {self.seed}" if self.seed else "")


def _read(picture_path: Path, labels_path: Path) -> KnownSegments:
    picture, labels = read_picture(picture_path), read_labels(labels_path)
    if picture.shape[:2] != labels.shape:
        sizes = f"{picture_path} is {size_in_words(picture)} and {labels_path} {size_in_words(labels)}"
        raise PictureError(f"{sizes}; they must be of the same size")
    return KnownSegments(picture, labels)


def segment(method: Segmenter, scene: KnownSegments) -> SegmentMap:
    """Run the timed call."""
    return method.segment(scene.picture)


def measure(segments: SegmentMap, scene: KnownSegments) -> dict[str, float]:
    """Return `segment_errors`, where `segments` is the difference between the number of segments and the true one."""
    errors = segment_errors(segments.labels, scene.labels)
    return errors | {"segments": abs(errors["segments"] - scene.count)}


def _light(change: Callable[[np.ndarray, float], np.ndarray]) -> Callable[[KnownSegments, float], KnownSegments]:
    """Return a perturbation of the picture that moves no pixel."""
    return lambda scene, value: replace(scene, picture=change(scene.picture, value))


PERTURBATIONS: Mapping[str, Perturbation] = {
    "noise": Perturbation(
        "standard deviation in grey levels of 255, above 0",
        lambda sd: 0 < sd <= 255,
        _light(lambda picture, sd: damage.noise(picture, sd, seed=0)),
    ),
    "gain": Perturbation("factor, above 0", lambda factor: 0 < factor <= 10, _light(damage.gain)),
    "offset": Perturbation("grey levels of 255 to add", lambda levels: abs(levels) <= 255, _light(damage.offset)),
    "light": Perturbation(
        "share by which the light rises from the middle to the right border, -1 to 1",
        lambda share: 0 < abs(share) <= 1,
        _light(damage.light),
    ),
    "quarter": Perturbation(
        "turns by 90 degrees to the left: 1, 2 or 3", lambda turns: turns in (1, 2, 3), damage.quarter
    ),
    "rotate": Perturbation(
        "degrees to the left, within 45; the largest part without empty corners",
        lambda degrees: 0 < abs(degrees) <= 45,
        damage.rotate,
    ),
    "flip": Perturbation("1 left for right, 0 top for bottom", lambda axis: axis in (0, 1), damage.flip),
    "scale": Perturbation("factor on both sides, 0.1 to 10", lambda factor: 0.1 <= factor <= 10, damage.scale),
}

MEASURES = {
    "ari": Measure("ARI", 3, "high", tolerance=0.0005),
    "accuracy": Measure("accuracy", 3, "high", tolerance=0.0005),
    "boundary_px": Measure("boundary px", 1, tolerance=0.05),
    "segments": Measure("segments off", 1, tolerance=0.05),
}

TASK = Task(
    kind="texture",
    version=1,
    scene=TextureScene,
    work=segment,
    measure=measure,
    measures=MEASURES,
    columns=tuple(MEASURES),
    plot_measures=("ari", "boundary_px"),
    perturbations=PERTURBATIONS,
    facts={"segments": lambda scene: scene.count},
)
