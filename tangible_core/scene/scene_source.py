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

from ..data import Calibration
from ..data.arguments import as_picture
from ..data.option_errors import sentences_about
from ..errors import ConfigError, PictureError, wrong_argument
from ..files.paths import as_path
from .combining import PHONE_DEPTH, PICTURES, combine_parts
from .formats.decoding import content_bytes
from .formats.height_maps import find_picture, in_metres, metadata_beside, read_heights_metadata
from .formats.kinds import vector_format
from .formats.multi_picture import Notify
from .formats.pairs import Layout, Stored, halves, read_pair, read_stored, to_views
from .formats.phone_depth import read_phone_depth
from .formats.pictures import (
    TruthScale,
    read_labels,
    read_map,
    read_picture,
    read_truth,
    to_labels,
    to_map,
    to_picture,
    to_truth,
)
from .formats.rigs import find_rig, read_rig
from .rig import StereoRig
from .scene_files import SceneFiles, as_numbers
from .vectors import read_pdf, read_svg
from .video.files import frame_parts, read_video

log: logging.Logger = logging.getLogger(__name__)

_PARTS = ("left", "right", "stereo", "photo", "video", "height", "disparity", "depth", "segments", "truth")
_DISPARITIES = ("disparity", "truth")
_INSTEAD_OF_RIG = ("rig", "focal_px", "disparity", "depth", "truth", "segments", "crop")


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
_CONVERTERS = {"height": partial(to_map, exact=True), "depth": to_map, "segments": to_labels}


@dataclass(frozen=True, eq=False)
class SceneSource:
    """The parts of a scene before any of them is read."""

    name: str
    # Files of the parts, relative to `folder`; for an array, words that stand for it in messages.
    files: SceneFiles
    folder: Path = Path()
    arrays: Mapping[str, Any] | None = None
    rig: StereoRig | None = None
    # The builtin name or the files that identify the scene; None if a part is an array.
    origin: str | SceneFiles | None = None

    def load(self) -> dict[str, Any]:
        """Read the parts and return the fields of their `Scene`. Raises: PictureError."""
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
        parts = {} if first is None else frame_parts(first.picture, files, first.video.name)
        if files.left is not None:
            left, right = (
                Stored(as_picture(part, arrays[part]).copy(), None, str(path))
                if part in arrays
                else read_stored(cast(Path, path), notes.append)
                for part, path in (("left", files.left), ("right", files.right))
            )
            parts |= to_views(left, right, files.non_finite, notes.append)._asdict()
        warnings: list[str] = []
        page, photo = None, paths.get("photo", Path())
        if (vectors := vector_format(photo)) == "svg":
            page = read_svg(photo, content_bytes(photo), warnings.append)
        elif vectors == "pdf":
            page = read_pdf(photo, content_bytes(photo), files.page, warnings.append)
        if page is not None:
            parts["photo"] = page.picture
            if page.labels is not None and files.segments is None:
                parts["segments"] = page.labels
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
            if rig_file := find_rig(paths["left"], paths["right"], shape):
                shown_path = rig_file.relative_to(self.folder) if rig_file.is_relative_to(self.folder) else rig_file
                notes.append(f"{rig_file.name} states the cameras of the pair; write `rig: {shown_path}` to use it")
        fields = combine_parts(files, parts, rig, notes, warnings, page)
        for note in notes:
            log.info("%s", note)
        for warning in warnings:
            log.warning("%s", warning)
        return fields | {
            "name": self.name,
            "relief_m": files.relief_m,
            "frames": first and first.video,
            "notes": (*notes, *warnings),
            "warnings": tuple(warnings),
            "files": self.origin,
        }


def make_source(arguments: Mapping[str, Any]) -> SceneSource:
    """Return the source for a `Scene`'s arguments, by their key in `SceneFiles`. Raises: ArgumentError, ConfigError."""
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
    sources = {
        part: value for part, value in {**parts, "rig": rig}.items() if value is not None and part not in verbatim
    }
    paths = {
        part: as_path(cast(Any, value), part).absolute()
        for part, value in sources.items()
        if isinstance(value, str | PathLike)
    }
    names = {part: Path(f"the array given as {part}") for part in sources.keys() - paths.keys()}
    files = _validate({**paths, **names, **options, **verbatim}, calibration)
    if not names:
        return SceneSource(name or scene_name(files), files, origin=files)
    arrays = {part: sources[part] for part in names if part != "rig"}
    return SceneSource(name or "arrays", files, arrays=arrays, rig=rig if isinstance(rig, StereoRig) else None)


def _validate(values: Mapping[str, Any], calibration: Calibration | None) -> SceneFiles:
    cameras: dict[str, float] = {}
    if calibration is not None:
        cameras = {"focal_px": calibration.focal_px, "baseline_m": calibration.baseline_m}
        cameras |= {"offset_px": calibration.offset_px} if calibration.offset_px else {}
    options = {**values, **cameras}
    try:
        return SceneFiles.model_validate(options)
    except ValidationError as error:
        raise ConfigError(*(text for _, text in sentences_about(error, SceneFiles, options, ("scene",)))) from error


def scene_name(files: SceneFiles) -> str:
    """Return a name for the scene of these files: its main file, or its camera."""
    return f"camera {files.video}" if isinstance(files.video, int) else str(getattr(files, files.main))


def _read(part: str, path: Path, files: SceneFiles, notify: Notify) -> dict[str, np.ndarray]:
    if part == "stereo":
        return read_pair(path, cast("Layout | None", files.layout), files.non_finite, notify)._asdict()
    if part in _DISPARITIES:
        return {part: read_truth(path, *_scale(part, files), notify)}
    if part not in PICTURES:
        return {part: _READERS[part](path, notify)}
    may_shrink = part == "photo" and all(
        getattr(files, other) is None for other in ("crop", "segments", "disparity", "depth")
    )
    picture = read_picture(path, files.non_finite, notify, reduce=may_shrink)
    depth = None
    if part == "photo" and files.photo_depth and files.disparity is None and files.depth is None:
        depth = read_phone_depth(path, (picture.shape[0], picture.shape[1]), notify)
    return {part: picture} if depth is None else {part: picture, PHONE_DEPTH: depth}


def _scale(part: str, files: SceneFiles) -> tuple[TruthScale | None, tuple[float, ...]]:
    """Return the scale of a map of disparity, and its numbers for no data."""
    return getattr(files, f"{part}_scale"), as_numbers(files.nodata) if part == "disparity" else ()


def _convert(part: str, values: np.ndarray, files: SceneFiles) -> dict[str, np.ndarray]:
    """Convert a copy of an array to the part of a scene, or to its two views."""
    name = str(getattr(files, part))
    if part in _DISPARITIES:
        return {part: to_truth(values.copy(), name, *_scale(part, files))}
    if part not in PICTURES:
        return {part: _CONVERTERS[part](values.copy(), name)}
    picture = to_picture(values.copy(), name, files.non_finite)
    return halves(picture, cast("Layout | None", files.layout), name)._asdict() if part == "stereo" else {part: picture}
