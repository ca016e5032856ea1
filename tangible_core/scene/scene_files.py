"""The block `scene:` of a pipeline file: its files and their options, builtin scenes, and readers of other forms."""

import re
from abc import ABC, abstractmethod
from collections.abc import Collection, Iterable, Mapping
from pathlib import Path
from typing import Annotated, Any, Literal, Self

from pydantic import BeforeValidator, Field, model_validator

from ..data import Calibration
from ..data.quantities import Quantities
from ..errors import did_you_mean, quoted
from .formats.pictures import NonFinite, TruthScale
from .scene_options import VideoLayout

Length = Annotated[float, Field(gt=0, allow_inf_nan=False)]
Start = Annotated[int, Field(ge=0)]
Count = Annotated[int, Field(ge=1)]
Percent = Annotated[float, Field(ge=0, le=100, allow_inf_nan=False)]
Fps = Annotated[float, Field(gt=0, le=1000, allow_inf_nan=False)]
Number = Annotated[float, Field(allow_inf_nan=False)]

_NEEDS = {
    **{"focal_px": "baseline_m", "baseline_m": "focal_px", "offset_px": "focal_px"},
    **{"relief_m": "height", "cell_m": "height", "nodata": "height or depth or disparity"},
    **{"kind": "photo", "page": "photo", "rig": "left", "rig_unit_m": "rig", "fps": "video", "repeat": "video"},
    **{"truth_scale": "truth", "disparity_scale": "disparity"},
    **{"depth_unit_m": "depth", "near_m": "depth", "far_m": "depth"},
}
_OF_ONE_VIEW = ("rotate", "invert", "clip")
_OF_VIDEOS = ("video", "layout", "fps", "segments", "crop", "repeat")
_OF_VIDEO_PAIRS = ("focal_px", "baseline_m", "offset_px", "rig", "rig_unit_m", "order")
_OF_DEPTH = ("disparity", "disparity_scale", "depth", "depth_unit_m", "near_m", "far_m")
_OF_VIEWS = (*_OF_DEPTH, "truth", "truth_scale", "focal_px", "baseline_m", "offset_px")


def _video(value: object) -> object:
    if isinstance(value, str) and re.match(r"[A-Za-z][A-Za-z0-9+.-]+://", value):
        raise ValueError("addresses are not opened: save the video, and name its file")
    if isinstance(value, bool) or value == "" or not isinstance(value, str | Path | int | None):
        raise ValueError(_WHAT_VIDEO)
    if isinstance(value, int) and not 0 <= value <= LAST_CAMERA:
        raise ValueError(_WHAT_VIDEO)
    return value


LAST_CAMERA = 99
_WHAT_VIDEO = "a video is the path of a file or of a folder of pictures, or the number of a camera, from 0"
VideoSource = Annotated[Path | Annotated[int, Field(ge=0, le=LAST_CAMERA)], BeforeValidator(_video)]


class SceneFiles(Quantities):
    """A scene in files: a pair (left and right, or both in one file, stereo), one photo, a height map, or a video.
    Relative paths start at the YAML file."""

    left: Path | None = None
    """The left view of a rectified pair."""
    right: Path | None = None
    """The right view of a rectified pair, of the same size."""
    stereo: Path | None = None
    """A rectified pair in one file: two halves of a picture, a .jps file, or the two pictures of an .mpo file."""
    video: VideoSource | None = None
    """A video file, a folder of pictures in the order of their numbers, or the number of a camera, from 0.
    `tangible feel` plays it; everything else uses its first frame."""
    fps: Fps | None = None
    """Frames of the video a second. When left out, the rate that the file or the camera states, and 30 for a folder."""
    repeat: bool = True
    """Start the video again at its end."""
    layout: VideoLayout | None = None
    """Arrangement of the halves of `stereo`, or of each frame of `video`: `side-by-side`, the left view on the left;
    `cross-eyed`, the left view on the right; `top-bottom`, the left view on top; `bottom-top`, the left view below;
    `mono`, for a video of one view. When left out, the one that the file states, and otherwise side-by-side (.jps:
    cross-eyed; a video: mono)."""
    photo: Path | None = None
    """A single picture, or a drawing in vectors: an SVG, or a page of a PDF."""
    kind: Literal["photograph", "drawing", "lines", "text"] | None = None
    """What the photo shows: a `photograph`; a flat `drawing`, with areas of one colour, such as a map or a chart; line
    art, `lines`; or a page of `text`. When left out, the likeliest by its colours, lines and ground."""
    page: Count | None = None
    """The page of a PDF, from 1; the first when left out."""
    photo_depth: bool = True
    """Use the depth map that a phone stored in the photo, if there is one; no depth is estimated then."""
    height: Path | None = None
    """A height map in any unit, larger values standing higher: a grey picture, .npy, .pfm or .tif; or heights in
    millimetres as the exporter `heights` writes them, which keep their size: .json, or the picture next to it. No depth
    is estimated."""
    disparity: Path | None = None
    """A disparity map of the left view or the photo, in pixels, NaN where unknown. No depth is estimated."""
    disparity_scale: TruthScale | None = None
    """Value in the file `disparity` that stands for one pixel of disparity, as in `truth_scale`, where 0 or less is
    unknown. When left out, its numbers are pixels."""
    depth: Path | None = None
    """A depth map of the left view or the photo: the distance of each pixel along the optical axis, smaller being
    nearer, 0 or less and NaN where unknown, as Kinect, RealSense and phones store it. No depth is estimated."""
    depth_unit_m: Length | None = None
    """Metres that one number of `depth` is; 0.001 when left out, a millimetre."""
    near_m: Length | None = None
    """Depths that are smaller count as this one."""
    far_m: Length | None = None
    """Depths that are greater count as this one: what is behind is flat ground."""
    segments: Path | None = None
    """A label picture: one colour or number per segment. No texture is segmented."""
    truth: Path | None = None
    """Ground-truth disparity of the left view, in pixels, NaN or infinite where unknown; only for error figures."""
    truth_scale: TruthScale | None = None
    """Value in the file `truth` that stands for one pixel of disparity, where 0 is unknown: 256 for KITTI, 4 for
    Middlebury 2003, `sintel` for Sintel's three channels. When left out, its numbers are pixels."""
    focal_px: Length | None = None
    """Focal length of the rectified cameras, in pixels; with `baseline_m`, the relief is proportional to depth."""
    baseline_m: Length | None = None
    """Distance between the camera centres."""
    offset_px: Annotated[float, Field(allow_inf_nan=False)] | None = None
    """Column of the right camera's principal point minus that of the left (Middlebury's `doffs`); 0 if left out."""
    rig: Path | None = None
    """Calibration of the two cameras that took left and right (K, lens distortion, rotation, translation): OpenCV's
    YAML or XML (M1, D1, M2, D2, R, T), Kalibr's (cam0, cam1), ROS's left.yaml beside right.yaml, or calib.txt of
    Middlebury or KITTI. The raw pair is rectified by it, and depth is metric; the right camera may stand below."""
    rig_unit_m: Length | None = None
    """Metres that one unit of the rig's translation is; when left out 1, or what the format defines (Middlebury:
    millimetres); 0.001 for a board measured in millimetres."""
    relief_m: Length | None = None
    """Height of the relief made from a height map; by default that of `workspace`."""
    cell_m: Length | tuple[Length, Length] | None = None
    """Side of a cell of the height map on the ground, or its width and length, before rotation. When left out, the one
    that the file states (a GeoTIFF, an ESRI grid), and otherwise cells are square and of no known size."""
    order: Literal["as-named"] | None = None
    """`as-named`: left and right are in order, and not checked. When left out, the depth of exchanged views is
    corrected, with a warning: larger disparities of the view named left are then nearer."""

    crop: tuple[Start, Start, Count, Count] | None = None
    """The part to use, [x, y, width, height] in pixels of the upright picture, x and y from its upper left corner. All
    files of the scene are cropped alike; points of materials count from the part's corner."""
    rotate: Literal[0, 90, 180, 270] = 0
    """Clockwise rotation of a photo, a video of one view, or a height map, in degrees, after cropping."""
    invert: bool = False
    """Exchange light and dark of a photo or a video, or high and low of a height map."""
    nodata: Number | tuple[Number, ...] | None = None
    """Values of a map of heights, depth or disparity, as its file has them, that stand for no data, such as -9999. The
    one that a GeoTIFF states itself (GDAL's tag) is used anyway."""
    clip: tuple[Percent, Percent] | None = None
    """Percentiles to which a photo's brightness or a map's heights are clipped, such as [1, 99], so that a few spikes
    do not take up the whole relief."""
    non_finite: NonFinite = "error"
    """Treatment of NaN and infinity in a picture. `error`: stop, and name the first such pixel. `mask`: fill from the
    nearest pixel, and leave the disparity unknown and the segment's confidence 0 there."""

    @model_validator(mode="after")
    def _one_scene(self) -> Self:
        names = [name for name, value in self if isinstance(value, Path | float | str) and name != "non_finite"]
        names += [name for name in ("nodata", "cell_m") if isinstance(getattr(self, name), tuple)]
        names += ["video"] if isinstance(self.video, int) else []
        names += [] if self.repeat else ["repeat"]
        names += ["page"] if self.page else []
        if "video" in names:
            names += [] if self.non_finite == "error" else ["non_finite"]
            self._check_video([*names, *(name for name in ("crop", *_OF_ONE_VIEW) if getattr(self, name))])
            return self
        kinds = [kind for kind in (("left", "right"), ("stereo",), ("photo",), ("height",)) if set(kind) & set(names)]
        if self.stereo and (idle := [name for name in ("left", "right", "photo", "height") if name in names]):
            raise ValueError(f"stereo already gives both views; leave out {', '.join(idle)}")
        if len(kinds) != 1 or not set(kinds[0]) <= set(names):
            listing = ", ".join(names) or "nothing"
            cure = f"; {'right' if 'left' in names else 'left'} is missing" if kinds == [("left", "right")] else ""
            raise ValueError(
                f"a scene is either left and right, or photo, or height, or video; this one gives {listing}{cure}"
            )
        self._check_needs(names)
        if "layout" in names and (not self.stereo or self.layout == "mono"):
            raise ValueError("layout needs stereo or video; mono is for a video")
        if idle := self.rig and [name for name in names if name in _OF_VIEWS or name == "segments"]:
            raise ValueError(f"rig gives the cameras and rectifies the pictures; leave out {', '.join(idle)}")
        if idle := self.height and [name for name in names if name in _OF_VIEWS]:
            raise ValueError(f"height already gives all heights; leave out {', '.join(idle)}")
        if self.page and self.photo and self.photo.suffix.lower() not in ("", ".pdf"):
            raise ValueError("page is for a PDF; leave it out")
        if self.depth and self.disparity:
            raise ValueError("depth and disparity are two forms of one map; leave one of them out")
        if self.near_m and self.far_m and not self.near_m < self.far_m:
            raise ValueError(f"near_m is less than far_m, not {self.near_m:g} and {self.far_m:g}")
        self._check_framing()
        return self

    def _check_needs(self, names: Collection[str]) -> None:
        for name, other in _NEEDS.items():
            if name in names and not set(other.split(" or ")) & set(names):
                raise ValueError(f"{name} needs {other}")

    def _check_video(self, names: Collection[str]) -> None:
        self._check_needs(set(names) | ({"left"} if self.rig else set()))
        mono = self.layout in (None, "mono")
        fitting = {*_OF_VIDEOS, *(("rotate", "invert") if mono else _OF_VIDEO_PAIRS)}
        idle = [name for name in names if name not in fitting]
        if mono and idle and set(idle) <= set(_OF_VIDEO_PAIRS):
            raise ValueError(f"{', '.join(idle)} is for two views; give their layout, such as layout: side-by-side")
        if not mono and idle and set(idle) <= {"rotate", "invert"}:
            raise ValueError(f"{' and '.join(idle)} is for one view: the rows of a pair's views belong together")
        if idle:
            raise ValueError(f"a video gives the whole scene; leave out {', '.join(idle)}")
        if self.rig and (idle := [name for name in names if name in (*_OF_VIEWS, "segments", "crop")]):
            raise ValueError(f"rig gives the cameras and rectifies the pictures; leave out {', '.join(idle)}")

    def _check_framing(self) -> None:
        if self.clip is not None and not self.clip[0] < self.clip[1]:
            raise ValueError(f"clip is [low, high] with low < high, not {list(self.clip)}")
        if self.main in ("left", "stereo") and (idle := [name for name in _OF_ONE_VIEW if getattr(self, name)]):
            raise ValueError(
                f"{' and '.join(idle)} is for a photo or a height map: the rows of a pair's views belong together"
            )
        if self.rig and self.crop:
            raise ValueError("rig is for whole pictures; leave out crop")

    @property
    def main(self) -> Literal["left", "stereo", "photo", "height", "video"]:
        """The field that decides the kind of scene, and whose size the others share."""
        if self.video is not None:
            return "video"
        return "left" if self.left else "stereo" if self.stereo else "photo" if self.photo else "height"

    @property
    def calibration(self) -> Calibration | None:
        """The calibration of the cameras, if it is known."""
        if self.focal_px is None or self.baseline_m is None:
            return None
        return Calibration(self.focal_px, self.baseline_m, self.offset_px or 0.0)


def as_numbers(values: float | tuple[float, ...] | None) -> tuple[float, ...]:
    """Return the values of an option that is one number, several or none."""
    return () if values is None else values if isinstance(values, tuple) else (values,)


BUILTINS: Mapping[str, SceneFiles] = {
    "builtin/motorcycle": SceneFiles(
        left=Path("motorcycle_left.png"),
        right=Path("motorcycle_right.png"),
        truth=Path("motorcycle_disp.npz"),
        focal_px=994.978,
        baseline_m=0.193001,
        offset_px=31.086,
    ),
    **{f"builtin/{name}": SceneFiles(photo=Path(f"{name}.png")) for name in ("brick", "coins", "grass", "gravel")},
}
"""Scenes whose files come inside scikit-image; the motorcycle is Middlebury 2014, at a quarter of its size."""


class SceneReader(Quantities, ABC):
    """A form of the block `scene:` that stands for files; its fields are the keys of the block.

    A package names its readers in the entry-point group `tangible.scene`. The name of the entry point is the key that
    only blocks of this form have, such as `set` in `scene: {set: kitti-2015, name: 000000_10}`.
    """

    @abstractmethod
    def files(self) -> SceneFiles:
        """Find the files of the scene. Raises: TangibleError."""

    @classmethod
    def suggest(cls, key: str, block: Mapping[str, Any]) -> Iterable[str]:
        """Return values of this key for the completion in a shell; block: the keys of `scene:` given so far."""
        return ()


def builtin_files(name: str) -> SceneFiles:
    """Return the files of a builtin scene, with absolute paths."""
    files, folder = BUILTINS[name], scikit_image_data()
    return files.model_copy(update={part: folder / path for part, path in files if isinstance(path, Path)})


def scikit_image_data() -> Path:
    """Return the data folder of scikit-image, whose own functions would download missing files."""
    from importlib.util import find_spec

    spec = find_spec("skimage")
    assert spec is not None and spec.submodule_search_locations is not None
    return Path(spec.submodule_search_locations[0]) / "data"


def unknown_scene(name: str) -> str:
    """Return the complaint about a name that is not builtin."""
    return (
        f"no scene is named {quoted(name)}{did_you_mean(name, BUILTINS)}; builtin are {', '.join(sorted(BUILTINS))}; "
        "for your own files write {photo: FILE}, {left: FILE, right: FILE} or {height: FILE}"
    )
