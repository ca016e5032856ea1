"""Scenes with true disparity: builtin ones, synthetic ones, folders of pairs, or pairs of standard sets."""

from collections.abc import Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Self

import numpy as np
from pydantic import Field, model_validator

from tangible_core.errors import PictureError, quoted
from tangible_core.scene import Scene, SceneFiles, Section
from tangible_core.scene.formats import TruthScale
from tangible_core.testing.synthetic import KnownPair, synthetic_pair

from ..datasets import SETS, MarkedPair, StandardPair, match_files, pairs
from ..datasets.choosing import SetName, Split, with_folder_of_set
from ..datasets.standard_pair import Mask, Resolution
from ..metrics.standard_sets import visible_pixels
from .task import SceneSpec, check_one_kind, expand_folder, pick_pairs, with_folder_of_file

TRUTHS = ("disparity.npz", "disparity.npy", "disparity.pfm", "disparity.png")


class PairGlobs(Section):
    """Patterns of custom files; files belong together if the stars of their patterns match the same."""

    left: str
    """Pattern of the left views, such as `*/left_*.png`, relative to `folder`."""
    right: str
    """Pattern of the right views, with as many stars."""
    truth: str | None = None
    """Pattern of the true disparities; a pair without one is measured for time alone."""
    truth_scale: TruthScale | None = None
    """Units of these files per pixel, such as 256, with 0 for unknown; when left out, the unit is a pixel."""
    noc: str | None = None
    """Pattern of masks, 255 where both views show a pixel. When left out, the mask follows from a dense truth."""
    sparse: bool = False
    """True if the truth has gaps, such as a laser's, so that occlusion does not follow from it."""


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
    """A folder with left.png, right.png and disparity.npz, .npy, .pfm or .png (where 0 is unknown); or with sub-folders
    that have these. With `set` or `pairs`, the folder of the set or the patterns."""
    set: SetName | None = None
    """A standard set, as its archives unpack into `folder` (a folder of its name if that is left out)."""
    resolution: Resolution | None = None
    """F, H, T or Q of a set that comes in sizes; a size that is not in the folder is made from a larger one."""
    split: Split | None = None
    """`test` for pairs whose truth the benchmark keeps."""
    variant: Literal["final", "clean"] | None = None
    """The pass of Sintel; `final` if left out."""
    only: tuple[str | int, ...] = ()
    """Names of pairs of a set; all of them if left out."""
    pairs: PairGlobs | None = None
    """Custom files, matched by patterns."""

    @model_validator(mode="before")
    @classmethod
    def _complete_folder(cls, block: Any) -> Any:
        return with_folder_of_set(with_folder_of_file(block))

    @model_validator(mode="after")
    def _one_kind(self) -> Self:
        kinds = [name for name in ("builtin", "synthetic", "set", "pairs") if getattr(self, name) is not None]
        kinds += ["folder"] if self.folder is not None and not {"set", "pairs"} & {*kinds} else []
        check_one_kind(kinds, "builtin, synthetic, folder, set and pairs")
        if self.set is None and (idle := [name for name in _OF_SETS if getattr(self, name)]):
            raise ValueError(f"{' and '.join(idle)} needs a standard set; name it: `set: ...`")
        return self

    @classmethod
    def parse_name(cls, name: str) -> Mapping[str, Any]:
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
        if self.set is not None or self.pairs is not None:
            return self._expand_set()
        if self.folder is None or (self.folder / "left.png").exists():
            return {self._name(): self}
        return expand_folder(self, self.folder, "left.png", "left.png, right.png and disparity.npz")

    def open(self) -> KnownPair | MarkedPair:
        if self.set is not None or self.pairs is not None:
            (pair,) = self.list_pairs()
            return pair.open()
        if self.synthetic is not None:
            return synthetic_pair(self.synthetic, self.width_px, self.height_px, self.seed)
        if self.folder is not None:
            files = SceneFiles(
                left=self.folder / "left.png", right=self.folder / "right.png", truth=_truth(self.folder)
            )
            in_png = files.truth is not None and files.truth.suffix == ".png"  # which cannot hold NaN
            return _known_pair(Scene.read(files, self.folder), str(self.folder), zero_is_unknown=in_png)
        scene = Scene.builtin(self.builtin or "")
        return _known_pair(scene, scene.name, zero_is_unknown=False)

    def _expand_set(self) -> "Mapping[str, DepthScene]":
        scenes: dict[str, DepthScene] = {}
        for pair in self.list_pairs():
            split = "test" if pair.test else "training"
            marks = (pair.resolution if pair.resolution != "F" else None, self.variant, "test" if pair.test else None)
            name = pair.name if self.set is None else f"{'@'.join(filter(None, (self.set, *marks)))}/{pair.name}"
            scenes[name] = self.model_copy(update={"only": (pair.name,), "split": self.set and split})
        return scenes

    def list_pairs(self) -> tuple[StandardPair, ...]:
        """Return the unread pairs of a set, or of patterns. Raises: as `datasets.pairs` and `match_files`."""
        assert self.folder is not None  # by _complete_folder
        if self.set is not None:
            return pairs(
                self.set, self.folder,
                resolution=self.resolution, split=self.split, variant=self.variant, only=self.only,
            )  # fmt: skip
        assert self.pairs is not None  # by _one_kind
        return tuple(pick_pairs(_match(self.folder, self.pairs), self.only, self.folder).values())

    def _name(self) -> str:
        if self.synthetic is None:
            return f"builtin/{self.builtin}" if self.folder is None else self.folder.name
        seed = f" seed {self.seed}" if self.seed else ""
        return f"{self.synthetic} {self.width_px}x{self.height_px}{seed}"


def _truth(folder: Path) -> Path:
    for name in TRUTHS:
        if (folder / name).exists():
            return folder / name
    raise PictureError(f"{folder}: has no true disparity; put {' or '.join(TRUTHS)} next to left.png")


def _known_pair(scene: Scene, name: str, zero_is_unknown: bool) -> KnownPair:
    if scene.views is None or scene.views.right is None or scene.truth is None:
        raise PictureError(
            f"{name} is not a pair with true disparity; use builtin/motorcycle, a synthetic one or a folder of pairs"
        )
    truth_px = np.where(scene.truth == 0, np.float32(np.nan), scene.truth) if zero_is_unknown else scene.truth
    return KnownPair(scene.views, truth_px, visible_pixels(truth_px))


_OF_SETS = ("resolution", "split", "variant")  # options that only standard sets have


def _match(folder: Path, globs: PairGlobs) -> dict[str, StandardPair]:
    patterns = {part: pattern for part in ("left", "right", "truth", "noc") if (pattern := getattr(globs, part))}
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
        for name, files in match_files(folder, patterns, ("left", "right")).items()
    }


def named_set(name: str) -> Mapping[str, Any] | None:
    """Return the options of a name such as `middlebury-2014@Q` or `kitti-2015@test`; None if it names no standard set.

    >>> named_set("middlebury-2014@Q"), named_set("synthetic/planes")
    ({'set': 'middlebury-2014', 'resolution': 'Q'}, None)
    """
    set_name, *marks = name.split("@")
    options = {"test": "split", "training": "split", "final": "variant", "clean": "variant"}
    return {"set": set_name, **{options.get(mark, "resolution"): mark for mark in marks}} if set_name in SETS else None


def scene_size(scene: str) -> str:
    """Return the size in the name of a scene; an empty text for the full size.

    >>> scene_size("middlebury-2014@Q/Adirondack"), scene_size("builtin/motorcycle"), scene_size("kitti-2015/000000_10")
    ('Q', 'Q', '')
    """
    set_name, *marks = scene.partition("/")[0].split("@")
    if scene == "builtin/motorcycle":
        return "Q"
    return next((mark for mark in marks if mark in ("H", "T", "Q")), "") if set_name in SETS else ""
