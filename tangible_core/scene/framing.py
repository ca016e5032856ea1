"""What of a picture is felt, and which way round: crop, turn, invert, clip, and what is no data."""

from collections.abc import Mapping

import numpy as np
from jaxtyping import Float32

from ..data.pictures import luma, opaque, size_in_words
from ..errors import PictureError
from .formats.height_maps import Measured, said_of
from .formats.pictures import without
from .scene_files import SceneFiles

SAMPLED = 4_000_000
"""Pixels of a photo that percentiles are taken of, about."""


def framed(held: Mapping[str, np.ndarray], files: SceneFiles) -> dict[str, np.ndarray]:
    """All parts of a scene cropped and turned; then the photo or the heights as `files` says.

    Raises: PictureError for a crop beyond the picture.
    """
    found = {part: _turned(_cropped(values, files), files.rotate) for part, values in held.items()}
    if files.main == "height":
        found["height"] = _heights(found["height"], files)
    elif files.main == "photo":
        found["photo"] = _tones(found["photo"], files)
    return found


def measured(files: SceneFiles) -> Measured | None:
    """The size that a height map says it has, of the part that is felt; None for a map of any other numbers.

    One that is turned upside down (`invert`) is a map of any other numbers, too.
    Raises: PictureError if what it says is nonsense.
    """
    said = None if files.height is None or files.invert else said_of(files.height)
    if said is None:
        return None
    whole = said.measured
    _, _, columns, rows = files.crop or (0, 0, said.columns, said.rows)
    size_m = whole.width_m * columns / said.columns, whole.length_m * rows / said.rows
    width_m, length_m = size_m[::-1] if files.rotate in (90, 270) else size_m
    return Measured(width_m, length_m, whole.high_m)


def _cropped(values: np.ndarray, files: SceneFiles) -> np.ndarray:
    if files.crop is None:
        return values
    x, y, width, height = files.crop
    if x + width > values.shape[1] or y + height > values.shape[0]:
        raise PictureError(
            f"{getattr(files, files.main)}: crop {list(files.crop)} reaches beyond the picture, which is "
            f"{size_in_words(values)}; crop is [x, y, width, height] in its pixels, from its upper left corner"
        )
    return np.ascontiguousarray(values[y : y + height, x : x + width])


def _turned(values: np.ndarray, clockwise_deg: int) -> np.ndarray:
    return np.ascontiguousarray(np.rot90(values, -clockwise_deg // 90)) if clockwise_deg else values


def _heights(values: Float32[np.ndarray, "h w"], files: SceneFiles) -> Float32[np.ndarray, "h w"]:
    if files.nodata is not None:
        values = without(values, *(files.nodata if isinstance(files.nodata, tuple) else (files.nodata,)))
    known = values[np.isfinite(values)]
    if files.clip is not None and known.size:
        values = np.clip(values, *np.percentile(known, files.clip).astype(np.float32))
    return -values if files.invert else values


def _tones(picture: np.ndarray, files: SceneFiles) -> np.ndarray:
    """Every channel within the percentiles of the brightness, and turned round: light becomes dark."""
    if files.clip is None and not files.invert:
        return picture
    found = picture.copy()
    tones = found if found.ndim == 2 else found[..., :3]
    if files.clip is not None and tones.dtype != np.bool_:
        low, high = _range(picture, files.clip)
        np.clip(tones, low, high, out=tones)
    if files.invert:
        tones[...] = ~tones if tones.dtype.kind in "bu" else max(1.0, float(np.nanmax(tones, initial=0))) - tones
    return found


def _range(picture: np.ndarray, percent: tuple[float, float]) -> np.ndarray:
    step = max(1, round((picture.shape[0] * picture.shape[1] / SAMPLED) ** 0.5))
    some = picture[::step, ::step]
    brightness = some.astype(np.float32) if some.ndim == 2 else luma(some[..., :3].astype(np.float32))
    brightness = brightness[np.isfinite(brightness) & opaque(some)]
    ends = np.percentile(brightness, percent) if brightness.size else np.array([some.min(), some.max()])
    return ends.astype(picture.dtype)
