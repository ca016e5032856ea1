"""Scenes with true disparity: builtin, synthetic, folders of pairs, or pairs of standard sets."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Self, cast

import numpy as np
from pydantic import Field, model_validator

from tangible_core.errors import PictureError, quoted
from tangible_core.metrics import visible_pixels
from tangible_core.scene.scene import Scene
from tangible_core.scene.scene_files import SceneFiles
from tangible_core.scene.truth_files import TruthScale
from tangible_core.scene.workspace import Section
from tangible_core.testing.synthetic.stereo_scenes import KnownPair, synthetic_pair

from ..datasets import SETS, MarkedPair, StandardPair, matched, pairs
from ..datasets.choosing import SetName, Split, with_folder
from ..datasets.standard_pair import Mask, Resolution
from .task import SceneSpec

TRUTHS = ("disparity.npz", "disparity.npy", "disparity.pfm", "disparity.png")


class PairGlobs(Section):
    """Files of one's own that belong together by what the stars of their patterns match."""

    left: str
    """Left views, such as `*/left_*.png`, from `folder` on."""
    right: str
    """Right views: a pattern of as many stars."""
    truth: str | None = None
    """Their true disparities; a pair that has none is measured for time alone."""
    truth_scale: TruthScale | None = None
    """How many units of these files are a pixel, such as 256, 0 being unknown; when left out, they are pixels."""
    noc: str | None = None
    """Masks: 255 where both views show a pixel. When left out, what the truth tells, where that is dense."""
    sparse: bool = False
    """Whether the truth has gaps, such as a laser's, so that it does not tell what hides what."""


class DepthScene(SceneSpec):
    """A pair with true disparity: one of builtin, synthetic, folder, set and pairs."""

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
    """left.png, right.png and disparity.npz, .npy, .pfm or .png (where 0 is unknown); or sub-folders with these. With
    `set` or `pairs`, where they lie."""
    set: SetName | None = None
    """A standard set, as its archives unpack into `folder` (a folder of its name if that is left out)."""
    resolution: Resolution | None = None
    """F, H, T or Q of a set that comes in sizes: what does not lie there is made of a larger one."""
    split: Split | None = None
    """`test` for pairs whose truth the benchmark keeps."""
    variant: Literal["final", "clean"] | None = None
    """Which pass of Sintel; `final` if left out."""
    only: tuple[str | int, ...] = ()
    """Names of pairs of a set; all of them if left out."""
    pairs: PairGlobs | None = None
    """Files of your own, matched by patterns."""

    @model_validator(mode="before")
    @classmethod
    def _beside_the_file(cls, said: Any) -> Any:
        """Patterns without a folder start at the file."""
        if isinstance(said, dict) and "pairs" in said:
            return {"folder": Path(), **cast("dict[str, Any]", said)}
        return with_folder(said)

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        given = [name for name in ("builtin", "synthetic", "set", "pairs") if getattr(self, name) is not None]
        given += ["folder"] if self.folder is not None and not {"set", "pairs"} & {*given} else []
        if len(given) != 1:
            raise ValueError(
                f"a scene is one of builtin, synthetic, folder, set and pairs; this one is "
                f"{' and '.join(given) or 'none'}"
            )
        if self.set is None and (idle := [name for name in _OF_SETS if getattr(self, name)]):
            raise ValueError(f"{' and '.join(idle)} is of a standard set; name it: `set: ...`")
        return self

    @classmethod
    def named(cls, name: str) -> Mapping[str, Any]:
        """`builtin/NAME` or `synthetic/NAME`; or a set and its size or part, `middlebury-2014@Q`, `kitti-2015@test`."""
        if (size := named_set(name)) is not None:
            return size
        kind, _, rest = name.partition("/")
        if kind not in ("builtin", "synthetic"):
            raise ValueError(
                f"no scene is named {quoted(name)}; write builtin/motorcycle, synthetic/planes, {{folder: ...}} "
                "or {{set: ...}}"
            )
        return {kind: rest}

    def expand(self) -> "Mapping[str, DepthScene]":
        """Itself, or one for each pair of a set, or each sub-folder that holds a pair."""
        if self.set is not None or self.pairs is not None:
            return self._of_set()
        if self.folder is None or (self.folder / "left.png").exists():
            return {self._name(): self}
        found = sorted(each.parent for each in self.folder.glob("*/left.png"))
        if not found:
            raise PictureError(
                f"{self.folder}: neither it nor a folder in it holds left.png, right.png and disparity.npz"
            )
        return {str(each.name): self.model_copy(update={"folder": each}) for each in found}

    def open(self) -> KnownPair | MarkedPair:
        """The pair. Raises: PictureError, ConfigError if there is none, or it has no truth."""
        if self.set is not None or self.pairs is not None:
            (pair,) = self.listed()
            return pair.open()
        if self.synthetic is not None:
            return synthetic_pair(self.synthetic, self.width_px, self.height_px, self.seed)
        if self.folder is not None:
            files = _files(self.folder)
            in_png = files.truth is not None and files.truth.suffix == ".png"  # which cannot hold NaN
            return _known(Scene.read(files, self.folder), str(self.folder), zero_is_unknown=in_png)
        scene = Scene.builtin(self.builtin or "")
        return _known(scene, scene.name, zero_is_unknown=False)

    def _of_set(self) -> "Mapping[str, DepthScene]":
        found: dict[str, DepthScene] = {}
        for pair in self.listed():
            split = "test" if pair.test else "training"
            marks = (pair.resolution if pair.resolution != "F" else None, self.variant, "test" if pair.test else None)
            name = pair.name if self.set is None else f"{'@'.join(filter(None, (self.set, *marks)))}/{pair.name}"
            found[name] = self.model_copy(update={"only": (pair.name,), "split": self.set and split})
        return found

    def listed(self) -> tuple[StandardPair, ...]:
        """The pairs of a set, or those that patterns match, unread. Raises: as `datasets.pairs` and `matched`."""
        assert self.folder is not None  # by _beside_the_file
        if self.set is not None:
            return pairs(
                self.set, self.folder,
                resolution=self.resolution, split=self.split, variant=self.variant, only=self.only,
            )  # fmt: skip
        assert self.pairs is not None  # held by _one_kind
        found = _of_globs(self.folder, self.pairs)
        if missing := next((name for name in self.only if str(name) not in found), None):
            raise PictureError(f"{self.folder}: no pair in it is named {quoted(missing)}; there are {', '.join(found)}")
        return tuple(found[str(name)] for name in self.only) if self.only else tuple(found.values())

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
            f"{name} is not a pair with true disparity; use builtin/motorcycle, a synthetic one or a folder of pairs"
        )
    truth_px = np.where(scene.truth == 0, np.float32(np.nan), scene.truth) if zero_is_unknown else scene.truth
    return KnownPair(scene.views, truth_px, visible_pixels(truth_px))


_OF_SETS = ("resolution", "split", "variant")


def _of_globs(folder: Path, globs: PairGlobs) -> dict[str, StandardPair]:
    wanted = {part: pattern for part in ("left", "right", "truth", "noc") if (pattern := getattr(globs, part))}
    return {
        name: StandardPair(
            name,
            files["left"],
            files["right"],
            files.get("truth"),
            globs.truth_scale if "truth" in files else None,
            noc=Mask((files["noc"],), "at 255") if "noc" in files else None,
            sparse=globs.sparse,
        )
        for name, files in matched(folder, wanted, ("left", "right")).items()
    }


def named_set(name: str) -> Mapping[str, Any] | None:
    """What `middlebury-2014@Q` or `kitti-2015@test` stands for; None for what names no standard set.

    >>> named_set("middlebury-2014@Q"), named_set("synthetic/planes")
    ({'set': 'middlebury-2014', 'resolution': 'Q'}, None)
    """
    known, *marks = name.split("@")
    options = {"test": "split", "training": "split", "final": "variant", "clean": "variant"}
    return {"set": known, **{options.get(mark, "resolution"): mark for mark in marks}} if known in SETS else None


def size_of(scene: str) -> str:
    """The size in the name of a scene, where its pixels are not those of the full size.

    >>> size_of("middlebury-2014@Q/Adirondack"), size_of("builtin/motorcycle"), size_of("kitti-2015/000000_10")
    ('Q', 'Q', '')
    """
    known, *marks = scene.partition("/")[0].split("@")
    if scene == "builtin/motorcycle":
        return "Q"
    return next((mark for mark in marks if mark in SIZES), "") if known in SETS else ""


SIZES = ("H", "T", "Q")
