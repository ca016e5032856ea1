"""The source of a scene: its parts as files and arrays, and how they are read, framed and combined."""

import logging
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from functools import partial
from os import PathLike
from pathlib import Path
from typing import Any, cast

import numpy as np
from jaxtyping import Float
from pydantic import ValidationError

from ..data import Calibration, DisparityMap, SegmentMap, Views
from ..data.arguments import as_picture
from ..data.option_errors import sentences_about
from ..data.pictures import fill_non_finite, used_range
from ..errors import ConfigError, PictureError, wrong_argument
from ..files.paths import as_path
from .formats.height_maps import find_picture, in_metres, metadata_beside, read_heights_metadata
from .formats.multi_picture import Notify
from .formats.pairs import Layout, Stored, halves, read_pair, read_stored, views_of
from .formats.phone_depth import read_phone_depth
from .formats.pictures import (
    TruthScale,
    labels_of,
    map_of,
    picture_of,
    read_labels,
    read_map,
    read_picture,
    read_truth,
    truth_of,
    without,
)
from .formats.rigs import find_rig, read_rig
from .framing import OFFSET, apply_framing, cut_out, measured_size
from .rig import StereoRig, rectify_views
from .scene_files import SceneFiles, as_numbers
from .video.files import parts_of, read_video, still

log: logging.Logger = logging.getLogger(__name__)

_PICTURES = {"left", "right", "photo", "stereo"}
_PARTS = ("left", "right", "stereo", "photo", "video", "height", "disparity", "depth", "segments", "truth")
_DISPARITIES = ("disparity", "truth")
_UNIT_CAMERA = Calibration(focal_px=1.0, baseline_m=1.0)
"""The cameras whose disparity is one over the depth."""
_DEPTH_UNIT_M = 0.001
_PHONE_DEPTH = "phone depth"
_INSTEAD_OF_RIG = ("rig", "focal_px", "disparity", "depth", "truth", "segments", "crop")
FAR_APART_M = 10.0
"""Baseline from which millimetres are more likely than metres, unless the pictures were taken from the air."""


def _read_heights(path: Path, notify: Notify) -> Float[np.ndarray, "h w"]:
    """Read a height map, in metres if its metadata state a scale. Raises: PictureError."""
    metadata = read_heights_metadata(path)
    if metadata is None:
        if (other := metadata_beside(path)) is not None and path.suffix.lower() != ".json":
            notify(f"{path.stem}.json describes {other.file}: its sizes do not count for {path.name}")
        return read_map(path, notify, exact=True)
    picture, metadata = find_picture(path, metadata)
    return in_metres(read_map(picture, notify), metadata, picture, notify)


_READERS: Mapping[str, Callable[[Path, Notify], np.ndarray]] = {
    "height": _read_heights,
    "depth": read_map,
    "segments": read_labels,
}
_CONVERTERS = {"height": partial(map_of, exact=True), "depth": map_of, "segments": labels_of}


@dataclass(frozen=True, eq=False)
class SceneSource:
    """The parts of a scene before any of them is read."""

    name: str
    files: SceneFiles
    """Files of the parts, relative to `folder`; for an array, words that stand for it in messages."""
    folder: Path = Path()
    arrays: Mapping[str, Any] | None = None
    rig: StereoRig | None = None
    """The cameras, if they are not in a file."""
    origin: str | SceneFiles | None = None
    """The builtin name or the files that identify the scene; None if a part is an array."""

    def load(self) -> dict[str, Any]:
        """Read the parts and return the fields of their `Scene`.

        Raises: PictureError for a file that cannot be read, or two parts that differ in size.
        """
        arrays = self.arrays or {}
        paths = {
            part: as_path(self.folder) / as_path(path)
            for part, path in self.files
            if isinstance(path, Path) and part not in arrays and (part != "rig" or self.rig is None)
        }
        files = self.files.model_copy(update=paths)
        notes: list[str] = []
        rig, size = (self.rig, None) if "rig" not in paths else read_rig(paths["rig"], files.rig_unit_m)
        first = None if files.video is None else read_video(files.video, files, rig, notes.append)
        parts = {} if first is None else parts_of(first.picture, files, first.video.name)
        if files.left is not None:
            left, right = (self._read_view(part, getattr(files, part), notes.append) for part in ("left", "right"))
            parts |= views_of(left, right, files.non_finite, notes.append)._asdict()
        for part, path in files:
            if part in parts:
                continue
            if part in arrays:
                parts |= _convert(part, as_picture(part, arrays[part]), files)
            elif isinstance(path, Path) and part not in ("rig", "video"):
                parts |= _read(part, path, files, notes.append)
        if size is not None and size != parts["left"].shape[1::-1]:
            raise PictureError(
                f"{paths.get(files.main, self.name)} is not {size[0]} x {size[1]}, the size that the rig was "
                "calibrated for"
            )
        if {"left", "right"} <= paths.keys() and not any(getattr(files, name) for name in _INSTEAD_OF_RIG):
            shape = (parts["left"].shape[0], parts["left"].shape[1])
            if found := find_rig(paths["left"], paths["right"], shape):
                named = found.relative_to(self.folder) if found.is_relative_to(self.folder) else found
                notes.append(f"{found.name} states the cameras of the pair; write `rig: {named}` to use it")
        warnings: list[str] = []
        fields = _fields(files, parts, rig, notes, warnings)
        for each in notes:
            log.info("%s", each)
        for each in warnings:
            log.warning("%s", each)
        return fields | {
            "name": self.name,
            "relief_m": files.relief_m,
            "frames": first and first.video,
            "notes": (*notes, *warnings),
            "warnings": tuple(warnings),
            "files": self.origin,
        }

    def _read_view(self, part: str, path: Path, notify: Notify) -> Stored:
        """Read a view of a pair as it is stored. Raises: PictureError."""
        if part not in (self.arrays or {}):
            return read_stored(path, notify)
        return Stored(as_picture(part, cast(Any, self.arrays)[part]).copy(), None, str(path))


def source_of_arguments(arguments: Mapping[str, Any]) -> SceneSource:
    """Return the source for the arguments of a `Scene`: files, arrays and options by their key in `SceneFiles`; also
    `calibration`, `rig` and `name`.

    Raises: ArgumentError for an argument of a wrong type, ConfigError for parts that do not make a scene.
    """
    options = {key: value for key, value in arguments.items() if key not in (*_PARTS, "calibration", "rig", "name")}
    parts = {part: arguments.get(part) for part in _PARTS}
    calibration, rig, name = arguments.get("calibration"), arguments.get("rig"), arguments.get("name", "")
    video = parts["video"]
    if not isinstance(cast(object, video), str | PathLike | int | None):
        raise wrong_argument("video", video, "the path of a file or a folder, or the number of a camera")
    if not isinstance(cast(object, calibration), Calibration | None):
        raise wrong_argument("calibration", calibration, "a Calibration, such as Calibration(focal_px, baseline_m)")
    if not isinstance(cast(object, rig), StereoRig | str | PathLike | None):
        raise wrong_argument("rig", rig, "a StereoRig, or the path of its file")
    verbatim = {"video": video} if isinstance(video, int) or "://" in str(video) else {}
    given = {part: value for part, value in {**parts, "rig": rig}.items() if value is not None and part not in verbatim}
    paths = {
        part: as_path(cast(Any, value), part).absolute()
        for part, value in given.items()
        if isinstance(value, str | PathLike)
    }
    names = {part: Path(f"the array given as {part}") for part in given.keys() - paths.keys()}
    files = _validate({**paths, **names, **options, **verbatim}, calibration)
    if not names:
        return SceneSource(name or scene_name(files), files, origin=files)
    arrays = {part: given[part] for part in names if part != "rig"}
    return SceneSource(name or "arrays", files, arrays=arrays, rig=rig if isinstance(rig, StereoRig) else None)


def _validate(values: Mapping[str, Any], calibration: Calibration | None) -> SceneFiles:
    """Return the parts and options as `SceneFiles`. Raises: ConfigError if they do not make a scene."""
    cameras: dict[str, float] = {}
    if calibration is not None:
        cameras = {"focal_px": calibration.focal_px, "baseline_m": calibration.baseline_m}
        cameras |= {"offset_px": calibration.offset_px} if calibration.offset_px else {}
    given = {**values, **cameras}
    try:
        return SceneFiles.model_validate(given)
    except ValidationError as error:
        raise ConfigError(*(text for _, text in sentences_about(error, SceneFiles, given, ("scene",)))) from error


def scene_name(files: SceneFiles) -> str:
    """Return a name for the scene of these files: its main file, or its camera."""
    return f"camera {files.video}" if isinstance(files.video, int) else str(getattr(files, files.main))


def _read(part: str, path: Path, files: SceneFiles, notify: Notify) -> dict[str, np.ndarray]:
    """Read a file of a scene: two views, or a photo and its depth, or one part."""
    if part == "stereo":
        return read_pair(path, cast("Layout | None", files.layout), files.non_finite, notify)._asdict()
    if part in _DISPARITIES:
        return {part: read_truth(path, *_scale(part, files), notify)}
    if part not in _PICTURES:
        return {part: _READERS[part](path, notify)}
    may_shrink = part == "photo" and all(
        getattr(files, other) is None for other in ("crop", "segments", "disparity", "depth")
    )
    picture = read_picture(path, files.non_finite, notify, reduce=may_shrink)
    depth = None
    if part == "photo" and files.photo_depth and files.disparity is None and files.depth is None:
        depth = read_phone_depth(path, (picture.shape[0], picture.shape[1]), notify)
    return {part: picture} if depth is None else {part: picture, _PHONE_DEPTH: depth}


def _scale(part: str, files: SceneFiles) -> tuple[TruthScale | None, tuple[float, ...]]:
    """Return the scale of a map of disparity, and its numbers for no data."""
    return getattr(files, f"{part}_scale"), as_numbers(files.nodata) if part == "disparity" else ()


def _convert(part: str, values: np.ndarray, files: SceneFiles) -> dict[str, np.ndarray]:
    """Convert a copy of an array to the part of a scene, or to its two views."""
    name = str(getattr(files, part))
    if part in _DISPARITIES:
        return {part: truth_of(values.copy(), name, *_scale(part, files))}
    if part not in _PICTURES:
        return {part: _CONVERTERS[part](values.copy(), name)}
    picture = picture_of(values.copy(), name, files.non_finite)
    return halves(picture, cast("Layout | None", files.layout), name)._asdict() if part == "stereo" else {part: picture}


def _fields(
    files: SceneFiles, parts: dict[str, np.ndarray], rig: StereoRig | None, notes: list[str], warnings: list[str]
) -> dict[str, Any]:
    """Frame the parts and return them as fields of a `Scene`."""
    if files.video is not None:
        files = still(files)
    elif files.stereo is not None:
        files = files.model_copy(update={"left": files.stereo, "right": files.stereo, "stereo": None})
    _check_sizes(files, parts)
    measured = measured_size(files, parts["height"].shape) if files.height else None
    parts = apply_framing(parts, files, warnings.append)
    shown = None if files.height else _cut_out(parts, files, notes.append)
    masked = files.non_finite == "mask" and files.main in _PICTURES
    known = _both(_fill(parts, files.main) if masked else None, shown)
    _stretch(parts, Path(getattr(files, files.main)).name, warnings.append)
    camera = files.calibration or (_UNIT_CAMERA if files.depth else None)
    views = None if files.height else Views(parts[files.main], parts.get("right"), camera)
    if rig is not None and views is not None:
        views, known = rectify_views(views, rig)
        shown = None
    if views is not None and views.calibration is not None and views.calibration.baseline_m >= FAR_APART_M:
        cure = "rig_unit_m: 0.001" if rig is not None else f"baseline_m: {views.calibration.baseline_m:g} mm"
        notes.append(
            f"the cameras stand {views.calibration.baseline_m:.4g} m apart; if these are millimetres, write `{cure}`"
        )
    for each in (known, shown, parts.get("height"), parts.get("truth")):
        if each is not None:
            each.flags.writeable = False
    return {
        "views": views,
        "disparity": _disparity(parts, files, camera),
        "segments": SegmentMap(parts["segments"]) if "segments" in parts else None,
        "height": parts.get("height"),
        "offset": float(parts.get(OFFSET, 0.0)),
        "measured": measured,
        "truth": parts.get("truth"),
        "known": known,
        "shown": shown,
    }


def _disparity(parts: Mapping[str, np.ndarray], files: SceneFiles, camera: Calibration | None) -> DisparityMap | None:
    if _PHONE_DEPTH in parts:
        return DisparityMap(parts[_PHONE_DEPTH], unit="relative")
    if "depth" in parts and camera is not None:
        depth = without(parts["depth"], *as_numbers(files.nodata))
        depth_m = np.where(depth > 0, depth, np.nan).astype(np.float64) * (files.depth_unit_m or _DEPTH_UNIT_M)
        depth_m = np.clip(depth_m, files.near_m, files.far_m)
        return DisparityMap((camera.focal_px * camera.baseline_m / depth_m - camera.offset_px).astype(np.float32))
    return DisparityMap(parts["disparity"]) if "disparity" in parts else None


def _check_sizes(files: SceneFiles, parts: Mapping[str, np.ndarray]) -> None:
    main = files.main
    size = parts[main].shape[1::-1]
    for other in parts.keys() - {main}:
        if (its := parts[other].shape[1::-1]) != size:
            cure = "by its nearest neighbours, which mixes no labels" if other == "segments" else "or crop one of them"
            raise PictureError(
                f"{getattr(files, other)} ({other}) is {its[0]} x {its[1]} and {getattr(files, main)} ({main}) is "
                f"{size[0]} x {size[1]}; all parts of a scene must be of one size; resize {cure}"
            )


def _fill(parts: dict[str, np.ndarray], main: str) -> np.ndarray | None:
    """Fill non-finite pixels of the pictures; return the mask of the main one, None if it was finite everywhere."""
    known: dict[str, np.ndarray] = {}
    for name in parts.keys() & _PICTURES:
        parts[name], known[name] = fill_non_finite(parts[name])
    return None if known[main].all() else known[main]


def _cut_out(parts: dict[str, np.ndarray], files: SceneFiles, notify: Notify) -> np.ndarray | None:
    """Drop the fourth channel of the pictures; return the mask of the main one, None if it was opaque everywhere."""
    shown: dict[str, np.ndarray] = {}
    for name in [each for each in parts if each in _PICTURES and parts[each].shape[2:] == (4,)]:
        parts[name], shown[name] = cut_out(parts[name], str(getattr(files, name)))
    main = shown.get(files.main)
    if main is None or main.all():
        return None
    notify(f"{100 * (1 - main.mean()):.0f} % of {Path(getattr(files, files.main)).name} is transparent: flat ground")
    return main


def _stretch(parts: dict[str, np.ndarray], name: str, notify: Notify) -> None:
    """Stretch pictures of more than 8 bits that use little of their range to all of it, both views alike."""
    pictures = {part: values for part, values in parts.items() if part in _PICTURES}
    if (used := used_range(*pictures.values())) is not None:
        parts.update({part: used.stretch(values) for part, values in pictures.items()})
        notify(used.sentence(name))


def _both(one: np.ndarray | None, other: np.ndarray | None) -> np.ndarray | None:
    return other if one is None else one if other is None else one & other
