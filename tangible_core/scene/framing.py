"""The part of a picture that becomes the surface, and its orientation: crop, rotation, inversion, clipping, no data."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Bool, Float32

from ..data.pictures import fill_from_nearest, luma, opaque, size_in_words
from ..errors import PictureError
from .formats.height_maps import MeasuredSize, read_heights_metadata
from .formats.pictures import without
from .scene_files import SceneFiles

SAMPLED = 4_000_000
"""Approximate number of pixels of a photo from which percentiles are computed."""


def apply_framing(parts: Mapping[str, np.ndarray], files: SceneFiles) -> dict[str, np.ndarray]:
    """Crop and rotate all parts of a scene; then invert and clip the photo or the heights, as `files` has it.

    Raises: PictureError for a crop beyond the picture.
    """
    framed = {part: _rotate(_crop(values, files), files.rotate) for part, values in parts.items()}
    if files.main == "height":
        framed["height"] = _heights(framed["height"], files)
    elif files.main == "photo":
        framed["photo"] = _tones(framed["photo"], files)
    return framed


def measured_size(files: SceneFiles) -> MeasuredSize | None:
    """Return the size that a height map states, of its cropped part; None without metadata, and for an inverted map.

    Raises: PictureError for metadata with wrong values.
    """
    metadata = None if files.height is None or files.invert else read_heights_metadata(files.height)
    if metadata is None:
        return None
    whole = metadata.size
    _, _, columns, rows = files.crop or (0, 0, metadata.columns, metadata.rows)
    size_m = whole.width_m * columns / metadata.columns, whole.length_m * rows / metadata.rows
    width_m, length_m = size_m[::-1] if files.rotate in (90, 270) else size_m
    return MeasuredSize(width_m, length_m, whole.high_m)


def cut_out(picture: np.ndarray, name: str) -> tuple[np.ndarray, Bool[np.ndarray, "h w"]]:
    """Drop the fourth channel of a picture and fill what it hides; return also the mask of opaque pixels.

    Raises: PictureError if the whole picture is transparent.
    """
    shown = opaque(picture)
    if not shown.any():
        raise PictureError(f"{name}: all of the picture is transparent; there is nothing to feel")
    colours = np.ascontiguousarray(picture[..., :3])
    return colours if shown.all() else fill_from_nearest(colours, shown), shown


def _crop(values: np.ndarray, files: SceneFiles) -> np.ndarray:
    if files.crop is None:
        return values
    x, y, width, height = files.crop
    if x + width > values.shape[1] or y + height > values.shape[0]:
        raise PictureError(
            f"{getattr(files, files.main)}: crop {list(files.crop)} reaches beyond the picture, which is "
            f"{size_in_words(values)}; crop is [x, y, width, height] in its pixels, from its upper left corner"
        )
    return np.ascontiguousarray(values[y : y + height, x : x + width])


def _rotate(values: np.ndarray, clockwise_deg: int) -> np.ndarray:
    return np.ascontiguousarray(np.rot90(values, -clockwise_deg // 90)) if clockwise_deg else values


def _heights(values: Float32[np.ndarray, "h w"], files: SceneFiles) -> Float32[np.ndarray, "h w"]:
    if files.nodata is not None:
        values = without(values, *(files.nodata if isinstance(files.nodata, tuple) else (files.nodata,)))
    known = values[np.isfinite(values)]
    if files.clip is not None and known.size:
        values = np.clip(values, *np.percentile(known, files.clip).astype(np.float32))
    return -values if files.invert else values


def _tones(picture: np.ndarray, files: SceneFiles) -> np.ndarray:
    """Clip every channel to percentiles of the brightness, and exchange light and dark."""
    if files.clip is None and not files.invert:
        return picture
    changed = picture.copy()
    tones = changed if changed.ndim == 2 else changed[..., :3]
    if files.clip is not None and tones.dtype != np.bool_:
        low, high = _range(picture, files.clip)
        np.clip(tones, low, high, out=tones)
    if files.invert:
        tones[...] = ~tones if tones.dtype.kind in "bu" else max(1.0, float(np.nanmax(tones, initial=0))) - tones
    return changed


def _range(picture: np.ndarray, percent: tuple[float, float]) -> np.ndarray:
    step = max(1, round((picture.shape[0] * picture.shape[1] / SAMPLED) ** 0.5))
    some = picture[::step, ::step]
    brightness = some.astype(np.float32) if some.ndim == 2 else luma(some[..., :3].astype(np.float32))
    brightness = brightness[np.isfinite(brightness) & opaque(some)]
    ends = np.percentile(brightness, percent) if brightness.size else np.array([some.min(), some.max()])
    return ends.astype(picture.dtype)
