"""The parts of a scene, read from files or given as arrays, framed and combined to its fields."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

import numpy as np

from ..data import Calibration, DisparityMap, SegmentMap, Views
from ..data.pictures import fill_non_finite, used_range
from ..drawing import PictureKind
from ..errors import PictureError
from .formats.multi_picture import Notify
from .formats.pictures import without
from .framing import OFFSET, apply_framing, cut_out, measured_size
from .rig import StereoRig, rectify_views
from .scene_files import SceneFiles, as_numbers
from .vectors import VectorPage, frame_texts, rank_labels
from .video.files import still

PICTURES = {"left", "right", "photo", "stereo"}
PHONE_DEPTH = "phone depth"
_UNIT_CAMERA = Calibration(focal_px=1.0, baseline_m=1.0)  # the cameras whose disparity is one over the depth
_DEPTH_UNIT_M = 0.001
# Baseline from which millimetres are more likely than metres, unless the pictures were taken from the air.
FAR_APART_M = 10.0


def combine_parts(
    files: SceneFiles,
    parts: dict[str, np.ndarray],
    rig: StereoRig | None,
    notes: list[str],
    warnings: list[str],
    page: VectorPage | None = None,
) -> dict[str, Any]:
    """Frame the parts and return them as fields of a `Scene`. page: what vectors say of the photo."""
    if files.video is not None:
        files = still(files)
    elif files.stereo is not None:
        files = files.model_copy(update={"left": files.stereo, "right": files.stereo, "stereo": None})
    _check_sizes(files, parts)
    whole = parts[files.main].shape
    map_size = measured_size(files, parts["height"].shape) if files.height else None
    parts = apply_framing(parts, files, warnings.append)
    opaque_mask = None if files.height else _cut_out(parts, files, notes.append)
    has_mask = files.non_finite == "mask" and files.main in PICTURES
    known_mask = _both(_fill(parts, files.main) if has_mask else None, opaque_mask)
    _stretch(parts, Path(getattr(files, files.main)).name, warnings.append)
    camera = files.calibration or (_UNIT_CAMERA if files.depth else None)
    views = None if files.height else Views(parts[files.main], parts.get("right"), camera)
    if rig is not None and views is not None:
        views, known_mask = rectify_views(views, rig)
        opaque_mask = None
    if views is not None and views.calibration is not None and views.calibration.baseline_m >= FAR_APART_M:
        cure = "rig_unit_m: 0.001" if rig is not None else f"baseline_m: {views.calibration.baseline_m:g} mm"
        notes.append(
            f"the cameras stand {views.calibration.baseline_m:.4g} m apart; if these are millimetres, write `{cure}`"
        )
    for values in (known_mask, opaque_mask, parts.get("height"), parts.get("truth")):
        if values is not None:
            values.flags.writeable = False
    return {
        "views": views,
        "stated_kind": PictureKind(files.kind) if files.kind else page and page.kind,
        "disparity": _disparity(parts, files, camera),
        **_statements(parts, files, page, whole),
        "height": parts.get("height"),
        "offset": float(parts.get(OFFSET, 0.0)),
        "measured": map_size,
        "truth": parts.get("truth"),
        "known": known_mask,
        "shown": opaque_mask,
    }


def _statements(
    parts: Mapping[str, np.ndarray], files: SceneFiles, page: VectorPage | None, whole: tuple[int, ...]
) -> dict[str, Any]:
    """Return the segments, and what vectors say of them: names, texts and the title."""
    segments = SegmentMap(parts["segments"]) if "segments" in parts and (page is None or files.segments) else None
    if page is None:
        return {"segments": segments}
    statements = {
        "segments": segments,
        "title": page.title,
        "texts": frame_texts(page.texts, whole, files.crop, files.rotate),
    }
    if segments is not None or "segments" not in parts:
        return statements
    present, labels = rank_labels(parts["segments"])  # a crop may leave some out
    return statements | {
        "segments": SegmentMap(labels),
        "segment_names": tuple(page.names[number] for number in present),
    }


def _disparity(parts: Mapping[str, np.ndarray], files: SceneFiles, camera: Calibration | None) -> DisparityMap | None:
    if PHONE_DEPTH in parts:
        return DisparityMap(parts[PHONE_DEPTH], unit="relative")
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
                f"{size[0]} x {size[1]}; all parts of a scene must be of one size; if they belong "
                f"together, resize {cure}"
            )


def _fill(parts: dict[str, np.ndarray], main: str) -> np.ndarray | None:
    """Fill non-finite pixels of the pictures; return the mask of the main one, None if it was finite everywhere."""
    masks: dict[str, np.ndarray] = {}
    for name in parts.keys() & PICTURES:
        parts[name], masks[name] = fill_non_finite(parts[name])
    return None if masks[main].all() else masks[main]


def _cut_out(parts: dict[str, np.ndarray], files: SceneFiles, notify: Notify) -> np.ndarray | None:
    """Drop the fourth channel of the pictures; return the mask of the main one, None if it was opaque everywhere."""
    masks: dict[str, np.ndarray] = {}
    for name in [part for part in parts if part in PICTURES and parts[part].shape[2:] == (4,)]:
        parts[name], masks[name] = cut_out(parts[name], str(getattr(files, name)))
    main = masks.get(files.main)
    if main is None or main.all():
        return None
    notify(f"{100 * (1 - main.mean()):.0f} % of {Path(getattr(files, files.main)).name} is transparent: flat ground")
    return main


def _stretch(parts: dict[str, np.ndarray], name: str, notify: Notify) -> None:
    """Stretch pictures of more than 8 bits that use little of their range to all of it, both views alike."""
    pictures = {part: values for part, values in parts.items() if part in PICTURES}
    if (value_range := used_range(*pictures.values())) is not None:
        parts.update({part: value_range.stretch(values) for part, values in pictures.items()})
        notify(value_range.sentence(name))


def _both(one: np.ndarray | None, other: np.ndarray | None) -> np.ndarray | None:
    return other if one is None else one if other is None else one & other
