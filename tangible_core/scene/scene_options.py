"""The options of scenes in Python, by kind of scene: those of `SceneFiles`, with arrays in place of files."""

from collections.abc import Sequence
from os import PathLike
from typing import Literal, TypedDict

from numpy.typing import ArrayLike
from typing_extensions import TypeAliasType

from ..data import Calibration
from .formats.pairs import Layout
from .formats.pictures import NonFinite, TruthScale
from .rig import StereoRig

File = TypeAliasType("File", str | PathLike[str])  # so that help() shows the name
Picture = TypeAliasType("Picture", File | ArrayLike)
VideoLayout = Literal["mono", "side-by-side", "cross-eyed", "top-bottom", "bottom-top"]


class SceneOptions(TypedDict, total=False):
    """The options of every scene."""

    segments: Picture | None
    crop: Sequence[int] | None
    name: str


class TurnOptions(TypedDict, total=False):
    """The options of scenes with one view."""

    rotate: int
    invert: bool


class MapOptions(TypedDict, total=False):
    """The options of depth that is given instead of estimated, and of pictures and their cameras."""

    calibration: Calibration | None
    disparity: Picture | None
    disparity_scale: TruthScale | None
    depth: Picture | None
    depth_unit_m: float | None
    near_m: float | None
    far_m: float | None
    nodata: float | Sequence[float] | None
    truth: Picture | None
    truth_scale: TruthScale | None
    non_finite: NonFinite


class PairOptions(SceneOptions, MapOptions, total=False):
    """The options of a pair."""

    layout: Layout | None
    rig: StereoRig | File | None


class PhotoOptions(SceneOptions, MapOptions, TurnOptions, total=False):
    """The options of one picture."""

    photo_depth: bool
    page: int | None
    kind: Literal["photograph", "drawing", "lines", "text"] | None
    clip: Sequence[float] | None


class HeightOptions(SceneOptions, TurnOptions, total=False):
    """The options of a height map."""

    relief_m: float | None
    nodata: float | Sequence[float] | None
    cell_m: float | Sequence[float] | None
    clip: Sequence[float] | None


class VideoOptions(SceneOptions, TurnOptions, total=False):
    """The options of a video."""

    layout: VideoLayout | None
    fps: float | None
    repeat: bool
    calibration: Calibration | None
    rig: StereoRig | File | None
