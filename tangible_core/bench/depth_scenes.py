"""Scenes with true disparity: builtin, synthetic, or folders of pairs."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from ..errors import PictureError, quoted
from ..metrics import visible_pixels
from ..scene.scene import Scene
from ..scene.scene_files import SceneFiles
from ..synthetic.stereo_scenes import KnownPair, synthetic_pair
from .task import SceneSpec

TRUTHS = ("disparity.npz", "disparity.npy", "disparity.pfm", "disparity.png")


class DepthScene(SceneSpec):
    """A pair with true disparity: one of builtin, synthetic and folder."""

    builtin: str | None = None
    """A builtin scene, such as motorcycle."""
    synthetic: Literal["planes", "steps", "spheres", "bars"] | None = None
    """Analytic surfaces with exact disparity and occlusion."""
    width_px: Annotated[int, Field(ge=16, le=20_000)] = 480
    """Width of a synthetic pair."""
    height_px: Annotated[int, Field(ge=16, le=20_000)] = 360
    """Height of a synthetic pair."""
    seed: Annotated[int, Field(ge=0)] = 0
    """Layout and textures of a synthetic pair."""
    folder: Path | None = None
    """left.png, right.png and disparity.npz, .npy, .pfm or .png (where 0 is unknown); or sub-folders with these."""

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        given = [name for name in ("builtin", "synthetic", "folder") if getattr(self, name) is not None]
        if len(given) != 1:
            raise ValueError(
                f"a scene is one of builtin, synthetic and folder; this one is {' and '.join(given) or 'none'}"
            )
        return self

    @classmethod
    def named(cls, name: str) -> Mapping[str, Any]:
        """`builtin/NAME` or `synthetic/NAME`."""
        kind, _, rest = name.partition("/")
        if kind not in ("builtin", "synthetic"):
            raise ValueError(
                f"no scene is named {quoted(name)}; write builtin/motorcycle, synthetic/planes or {{folder: ...}}"
            )
        return {kind: rest}

    def expand(self) -> "Mapping[str, DepthScene]":
        """Itself, or one for each sub-folder that holds a pair."""
        if self.folder is None or (self.folder / "left.png").exists():
            return {self._name(): self}
        found = sorted(each.parent for each in self.folder.glob("*/left.png"))
        if not found:
            raise PictureError(
                f"{self.folder}: neither it nor a folder in it holds left.png, right.png and disparity.npz"
            )
        return {str(each.name): self.model_copy(update={"folder": each}) for each in found}

    def open(self) -> KnownPair:
        """The pair. Raises: PictureError, ConfigError if there is none, or it has no truth."""
        if self.synthetic is not None:
            return synthetic_pair(self.synthetic, self.width_px, self.height_px, self.seed)
        if self.folder is not None:
            files = _files(self.folder)
            in_png = files.truth is not None and files.truth.suffix == ".png"  # which cannot hold NaN
            return _known(Scene.read(files, self.folder), str(self.folder), zero_is_unknown=in_png)
        scene = Scene.builtin(self.builtin or "")
        return _known(scene, scene.name, zero_is_unknown=False)

    def _name(self) -> str:
        if self.synthetic is None:
            return f"builtin/{self.builtin}" if self.folder is None else self.folder.name
        seed = f" seed {self.seed}" if self.seed else ""
        return f"{self.synthetic} {self.width_px}x{self.height_px}{seed}"


def _files(folder: Path) -> SceneFiles:
    return SceneFiles(left=folder / "left.png", right=folder / "right.png", truth=_truth(folder))


def _truth(folder: Path) -> Path:
    for name in TRUTHS:
        if (folder / name).exists():
            return folder / name
    raise PictureError(f"{folder}: has no true disparity; put {' or '.join(TRUTHS)} beside left.png")


def _known(scene: Scene, name: str, zero_is_unknown: bool) -> KnownPair:
    if scene.views is None or scene.views.right is None or scene.truth is None:
        raise PictureError(
            f"{name} is no pair with true disparity; compare on builtin/motorcycle, synthetic ones or a folder of pairs"
        )
    truth_px = np.where(scene.truth == 0, np.float32(np.nan), scene.truth) if zero_is_unknown else scene.truth
    return KnownPair(scene.views, truth_px, visible_pixels(truth_px))
