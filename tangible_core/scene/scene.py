"""What there is to feel: a pair of views, a photo, a height map or a video, from files, from arrays or built in."""

import logging
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from os import PathLike
from pathlib import Path
from typing import Any, NamedTuple, Self, cast

import numpy as np
from jaxtyping import Bool, Float32
from numpy.typing import ArrayLike
from pydantic import ValidationError

from ..data import Calibration, DisparityMap, Record, Relief, SegmentMap, Views
from ..data.arguments import as_picture
from ..data.pictures import fill_from_nearest, fill_non_finite, opaque
from ..errors import ConfigError, PictureError, wrong_argument
from ..files.paths import as_path
from .formats.height_maps import Measured, in_metres, picture_said, said_of
from .formats.multi_picture import Say, unsaid
from .formats.pairs import Layout, halves, read_pair
from .formats.phone_depth import read_phone_depth
from .formats.pictures import (
    NonFinite,
    TruthScale,
    labels_of,
    map_of,
    picture_of,
    read_labels,
    read_map,
    read_picture,
    read_truth,
    truth_of,
)
from .formats.rigs import read_rig
from .framing import framed, measured
from .geometry import Holes, fill_rows, scale_heights
from .rig import StereoRig, turned
from .scaling import felt_factor, reduced_map, reduced_shape
from .scene_files import BUILTINS, SceneFiles, VideoLayout, unknown_scene
from .video.files import FirstFrame, Video, parts_of, read_video, still

log = logging.getLogger(__name__)

File = str | PathLike[str]
_PICTURES = {"left", "right", "photo", "stereo"}


def _read_heights(path: Path, say: Say = unsaid) -> Float32[np.ndarray, "h w"]:
    """A height map, in metres where its file says what its numbers mean. Raises: PictureError."""
    said = said_of(path)
    if said is None:
        return read_map(path, say)
    picture, said = picture_said(path, said)
    return in_metres(read_map(picture, say), said, picture)


_READERS = {"height": _read_heights, "disparity": read_map, "segments": read_labels}
_PHONE_DEPTH = "phone depth"
_CONVERTERS = {"height": map_of, "disparity": map_of, "segments": labels_of}


@dataclass(frozen=True, eq=False)
class Scene:
    """What it shows, and the products that it brings, which then need not be made. Made by `of` or `builtin`.

    >>> Scene.of(height=np.zeros((4, 6)), relief_m=0.01).views is None
    True
    """

    name: str
    views: Views | None = None
    disparity: DisparityMap | None = None
    """A ready one: no depth is estimated."""
    segments: SegmentMap | None = None
    """Ready ones: no texture is segmented."""
    height: Float32[np.ndarray, "h w"] | None = None
    """Heights in any unit, NaN where unknown: no depth is estimated."""
    relief_m: float | None = None
    """Height of the relief that `height` becomes; the workspace's where it is None."""
    measured: Measured | None = None
    """The size that its heights have by their own account: they are metres, and keep their lowest."""
    truth: Float32[np.ndarray, "h w"] | None = None
    """True disparity in pixels, NaN where unknown."""
    known: Bool[np.ndarray, "h w"] | None = None
    """Where the left view or the photo is; None for everywhere."""
    shown: Bool[np.ndarray, "h w"] | None = None
    """Where the left view or the photo is opaque: elsewhere lies flat ground; None for everywhere."""
    video: Video | None = None
    """What plays; the views are those of its first frame."""
    notes: tuple[str, ...] = ()
    """What was noticed while it was read."""
    files: str | SceneFiles | None = None
    """The builtin name, or the files with absolute paths, that it was read from; None if any of it was an array."""

    @classmethod
    def of(
        cls,
        *,
        left: File | ArrayLike | None = None,
        right: File | ArrayLike | None = None,
        stereo: File | ArrayLike | None = None,
        photo: File | ArrayLike | None = None,
        video: File | int | None = None,
        height: File | ArrayLike | None = None,
        disparity: File | ArrayLike | None = None,
        segments: File | ArrayLike | None = None,
        truth: File | ArrayLike | None = None,
        truth_scale: TruthScale | None = None,
        calibration: Calibration | None = None,
        rig: "StereoRig | File | None" = None,
        relief_m: float | None = None,
        layout: VideoLayout | None = None,
        fps: float | None = None,
        repeat: bool = True,
        photo_depth: bool = True,
        crop: Sequence[int] | None = None,
        rotate: int = 0,
        invert: bool = False,
        nodata: float | Sequence[float] | None = None,
        clip: Sequence[float] | None = None,
        non_finite: NonFinite = "error",
        name: str = "",
    ) -> Self:
        """A scene of files and arrays: left and right, or a photo, or heights, or a video, which is a file, a folder or
        the number of a camera; the meanings are those of `SceneFiles`.

        What is transparent in a picture with a fourth channel is no part of the scene.
        Pictures are (h, w) or (h, w, 3|4), uint8, uint16, bool or float (white is 1). All are of one size.
        Raises: ConfigError for parts that make no scene, PictureError for one that cannot be read or is no picture.
        """
        if not isinstance(cast(object, video), str | PathLike | int | None):
            raise wrong_argument("video", video, "the path of a file or a folder, or the number of a camera")
        said_whole = {"video": video} if isinstance(video, int) or "://" in str(video) else {}
        parts: dict[str, Any] = {
            "left": left, "right": right, "stereo": stereo, "photo": photo, "height": height,
            "disparity": disparity, "segments": segments, "truth": truth, "rig": rig,
            "video": None if said_whole else video,
        }  # fmt: skip
        parts = {part: value for part, value in parts.items() if value is not None}
        _check_cameras(calibration, rig)
        paths = {
            part: as_path(cast(Any, value), part).absolute()
            for part, value in parts.items()
            if isinstance(value, str | PathLike)
        }
        files = _checked(
            paths | {part: Path(f"the array given as {part}") for part in parts.keys() - paths.keys()},
            calibration,
            {**said_whole, "relief_m": relief_m, "truth_scale": truth_scale, "layout": layout,
             "photo_depth": photo_depth, "fps": fps, "repeat": repeat, "crop": crop, "rotate": rotate,
             "invert": invert, "nodata": nodata, "clip": clip, "non_finite": non_finite},
        )  # fmt: skip
        if paths.keys() == parts.keys():
            return cls._read(name or _named(files), files, Path(), files)
        cameras = cast("StereoRig | None", _rig(paths["rig"], files).cameras if "rig" in paths else rig)
        said: list[str] = []
        played = _played(files, Path(), cameras, said.append)
        held = {} if played is None else parts_of(played.picture, files, played.video.name)
        for part, value in sorted(parts.items(), key=lambda each: each[0] != files.main):
            if part in paths and part not in ("rig", "video"):
                held |= _read(part, paths[part], files, said.append)
            elif part not in paths and part != "rig":
                held |= _converted(part, as_picture(part, value), files)
        return cls._made(name or "arrays", files, held, None, said, cameras, played and played.video)

    @classmethod
    def builtin(cls, name: str) -> Self:
        """A scene that comes inside scikit-image: motorcycle, brick, coins, grass, gravel.

        Raises: ConfigError for another name.
        """
        name = str(name)
        return cls.read(name if name.startswith("builtin/") else f"builtin/{name}", Path())

    @classmethod
    def read(cls, scene: "str | SceneFiles", folder: Path) -> Self:
        """A builtin name, or files relative to `folder`.

        Raises: ConfigError for a name that is not builtin; PictureError for a file that cannot be read, or two files
        that differ in size.
        """
        if isinstance(scene, SceneFiles):
            return cls._read(_named(scene), scene, folder, scene)
        if scene not in BUILTINS:
            raise ConfigError(unknown_scene(scene))
        return cls._read(scene, BUILTINS[scene], _scikit_image_data(), scene)

    @classmethod
    def _read(cls, name: str, files: SceneFiles, folder: Path, origin: "str | SceneFiles") -> Self:
        paths = {part: as_path(folder) / as_path(path) for part, path in files if isinstance(path, Path)}
        rig = _rig(paths.pop("rig"), files) if "rig" in paths else None
        said: list[str] = []
        played = _played(files, folder, rig and rig.cameras, said.append)
        held = {} if played is None else parts_of(played.picture, files, played.video.name)
        for part, path in paths.items():
            if part != "video":
                held |= _read(part, path, files, said.append)
        if rig is not None and rig.size not in (None, held["left"].shape[1::-1]):
            raise PictureError(
                f"{paths.get(files.main, name)} is not {rig.size[0]} x {rig.size[1]}, the size that the rig was "
                "calibrated for"
            )
        files = files.model_copy(update=paths)
        return cls._made(name, files, held, origin, said, rig and rig.cameras, played and played.video)

    @classmethod
    def _made(
        cls,
        name: str,
        files: SceneFiles,
        held: dict[str, np.ndarray],
        origin: "str | SceneFiles | None",
        said: list[str],
        rig: StereoRig | None = None,
        video: Video | None = None,
    ) -> Self:
        if files.video is not None:
            files = still(files)
        elif files.stereo is not None:
            files = files.model_copy(update={"left": files.stereo, "right": files.stereo, "stereo": None})
        _check_sizes(files, held)
        held = framed(held, files)
        shown = None if files.height else _cut_out(held, files, said.append)
        masked = files.non_finite == "mask" and files.main in _PICTURES
        known = _both(_fill(held, files.main) if masked else None, shown)
        views = None if files.height else Views(held[files.main], held.get("right"), files.calibration)
        if rig is not None and views is not None:
            views, known = turned(views, rig)
            shown = None
        for each in said:
            log.info("%s", each)
        return cls(
            name=name,
            views=views,
            disparity=_disparity(held),
            segments=SegmentMap(held["segments"]) if "segments" in held else None,
            height=_frozen(held.get("height")),
            relief_m=files.relief_m,
            measured=measured(files),
            truth=_frozen(held.get("truth")),
            known=_frozen(known),
            shown=_frozen(shown),
            video=video,
            notes=tuple(said),
            files=origin,
        )

    @property
    def shape(self) -> tuple[int, int]:
        """(h, w) of the pictures, or of the heights. Raises: PictureError if it has neither."""
        if self.views is not None:
            return self.views.shape
        if self.height is None:
            raise PictureError(f"the scene {self.name} has neither a picture nor heights")
        rows, columns = self.height.shape
        return rows, columns

    def brings(self, width_m: float, relief_m: float, holes: Holes = "fill", finest_m: float = 0) -> dict[str, Record]:
        """The products that need not be made, by name; heights become a relief of this size.

        relief_m: where the scene says none. holes: what becomes of unknown heights. finest_m: heights on a finer grid
        are reduced to it; 0 keeps them all.
        Raises: GeometryError for heights that are unknown everywhere.
        """
        relief = None
        if self.height is not None:
            factor = felt_factor(self.height.shape[1], width_m, finest_m)
            height = reduced_map(self.height, reduced_shape(self.shape, factor))
            relief_m = self.relief_m or relief_m
            if self.measured is None:
                relief = scale_heights(height, width_m, relief_m, holes)
            else:
                relief = _as_measured(height, self.measured, width_m, relief_m)
        found = {"views": self.views, "relief": relief, "disparity": self.disparity, "segments": self.segments}
        return {product: record for product, record in found.items() if record is not None}


def _as_measured(height_m: np.ndarray, measured: Measured, width_m: float, relief_m: float) -> Relief:
    """Heights in metres, so wide and so high; the lowest stay as much above the base as they are."""
    scale = np.float32(relief_m / measured.high_m) if measured.high_m else np.float32(1)
    found = fill_rows(height_m) if scale == 1 else fill_rows(height_m) * scale
    return Relief(np.maximum(found, np.float32(0)), (width_m, width_m * measured.length_m / measured.width_m))


def _check_cameras(calibration: object, rig: object) -> None:
    """Raises: ArgumentError for what describes no camera."""
    if not isinstance(calibration, Calibration | None):
        raise wrong_argument("calibration", calibration, "a Calibration, such as Calibration(focal_px, baseline_m)")
    if not isinstance(rig, StereoRig | str | PathLike | None):
        raise wrong_argument("rig", rig, "a StereoRig, or the path of its file")


def _checked(paths: Mapping[str, Path], calibration: Calibration | None, options: Mapping[str, Any]) -> SceneFiles:
    """The parts of a scene as files. Raises: ConfigError if they make none."""
    cameras: dict[str, float] = {}
    if calibration is not None:
        cameras = {"focal_px": calibration.focal_px, "baseline_m": calibration.baseline_m}
        cameras |= {"offset_px": calibration.offset_px} if calibration.offset_px else {}
    try:
        return SceneFiles.model_validate({**paths, **cameras, **options})
    except ValidationError as error:
        raise ConfigError(
            *(
                f"{'.'.join(['scene', *map(str, each['loc'])])}: {each['msg'].removeprefix('Value error, ')}"
                for each in error.errors()
            )
        ) from error


def _named(files: SceneFiles) -> str:
    """The name of a scene that has none of its own."""
    return f"camera {files.video}" if isinstance(files.video, int) else str(getattr(files, files.main))


def _played(files: SceneFiles, folder: Path, rig: StereoRig | None, say: Say) -> FirstFrame | None:
    """The video of a scene and its first frame; None where it has none. Raises: PictureError."""
    if files.video is None:
        return None
    source = files.video if isinstance(files.video, int) else as_path(folder) / as_path(files.video)
    return read_video(source, files.model_copy(update={"video": source}), rig, say)


class _Rig(NamedTuple):
    """Two cameras, and the size of the pictures that they were calibrated with, where it is known."""

    cameras: StereoRig
    size: tuple[int, int] | None


def _rig(path: Path, files: SceneFiles) -> _Rig:
    return _Rig(*read_rig(path, files.rig_unit_m or 1.0))


def _read(part: str, path: Path, files: SceneFiles, say: Say = unsaid) -> dict[str, np.ndarray]:
    """What a file of a scene holds, by what it is: two views, or a photo and its depth, or what it was given for."""
    if part == "stereo":
        return read_pair(path, cast("Layout | None", files.layout), files.non_finite, say)._asdict()
    if part == "truth":
        return {part: read_truth(path, files.truth_scale, say)}
    if part not in _PICTURES:
        return {part: _READERS[part](path, say)}
    picture = read_picture(path, files.non_finite, say)
    depth = None
    if part == "photo" and files.photo_depth and files.disparity is None:
        depth = read_phone_depth(path, (picture.shape[0], picture.shape[1]), say)
    return {part: picture} if depth is None else {part: picture, _PHONE_DEPTH: depth}


def _converted(part: str, values: np.ndarray, files: SceneFiles) -> dict[str, np.ndarray]:
    """A copy, as what it was given for."""
    name = str(getattr(files, part))
    if part == "truth":
        return {part: truth_of(values.copy(), name, files.truth_scale)}
    if part not in _PICTURES:
        return {part: _CONVERTERS[part](values.copy(), name)}
    picture = picture_of(values.copy(), name, files.non_finite)
    return halves(picture, cast("Layout | None", files.layout), name)._asdict() if part == "stereo" else {part: picture}


def _disparity(held: Mapping[str, np.ndarray]) -> DisparityMap | None:
    if _PHONE_DEPTH in held:
        return DisparityMap(held[_PHONE_DEPTH], unit="relative")
    return DisparityMap(held["disparity"]) if "disparity" in held else None


def builtin_files(name: str) -> SceneFiles:
    """The files of a builtin scene, with absolute paths. Raises: PictureError without scikit-image."""
    files, folder = BUILTINS[name], _scikit_image_data()
    return files.model_copy(update={part: folder / path for part, path in files if isinstance(path, Path)})


def _scikit_image_data() -> Path:
    """The folder itself: scikit-image's own functions download what they miss."""
    from importlib.util import find_spec

    spec = find_spec("skimage")
    if spec is None or not spec.submodule_search_locations:
        raise PictureError("builtin scenes come inside scikit-image, which is not installed: pip install scikit-image")
    return Path(spec.submodule_search_locations[0]) / "data"


def _check_sizes(files: SceneFiles, held: Mapping[str, np.ndarray]) -> None:
    main = files.main
    size = held[main].shape[1::-1]
    for other in held.keys() - {main}:
        if (its := held[other].shape[1::-1]) != size:
            cure = "by its nearest neighbours, which mixes no labels" if other == "segments" else "or crop one of them"
            raise PictureError(
                f"{getattr(files, other)} ({other}) is {its[0]} x {its[1]} and {getattr(files, main)} ({main}) is "
                f"{size[0]} x {size[1]}; all parts of a scene must be of one size; resize {cure}"
            )


def _fill(held: dict[str, np.ndarray], main: str) -> np.ndarray | None:
    """Fill what is not finite in the pictures; where the main one is known, None if that is everywhere."""
    known: dict[str, np.ndarray] = {}
    for name in held.keys() & _PICTURES:
        held[name], known[name] = fill_non_finite(held[name])
    return None if known[main].all() else known[main]


def _cut_out(held: dict[str, np.ndarray], files: SceneFiles, say: Say) -> np.ndarray | None:
    """Take the fourth channel from the pictures and fill what it hides; where the main one is opaque, or None.

    Raises: PictureError if all of it is transparent.
    """
    shown: dict[str, np.ndarray] = {}
    for name in [each for each in held if each in _PICTURES and held[each].shape[2:] == (4,)]:
        shown[name] = opaque(held[name])
        if not shown[name].any():
            raise PictureError(f"{getattr(files, name)}: all of the picture is transparent; there is nothing to feel")
        held[name] = np.ascontiguousarray(held[name][..., :3])
        if not shown[name].all():
            held[name] = fill_from_nearest(held[name], shown[name])
    main = shown.get(files.main)
    if main is None or main.all():
        return None
    say(f"{100 * (1 - main.mean()):.0f} % of {Path(getattr(files, files.main)).name} is transparent: flat ground")
    return main


def _both(one: np.ndarray | None, other: np.ndarray | None) -> np.ndarray | None:
    return other if one is None else one if other is None else one & other


def _frozen(values: np.ndarray | None) -> np.ndarray | None:
    if values is not None:
        values.flags.writeable = False
    return values
