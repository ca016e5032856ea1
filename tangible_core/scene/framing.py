"""The part of a picture that becomes the surface, and its orientation: crop, rotation, inversion, clipping, no data."""

from collections.abc import Mapping
from pathlib import Path

import numpy as np
from jaxtyping import Bool, Float, Float32

from ..data.pictures import fill_from_nearest, luma, opaque, size_in_words
from ..errors import PictureError
from .formats.ground import Ground, read_ground
from .formats.height_maps import MeasuredSize, read_heights_metadata
from .formats.map_numbers import in_32_bits, number_text, undeclared_nodata
from .formats.multi_picture import Notify, ignore
from .formats.pictures import read_map, without
from .scene_files import SceneFiles, as_numbers

OFFSET = "offset"
"""The part of a framed scene that is the offset that was taken off its heights."""
SAMPLED = 4_000_000
"""Approximate number of pixels of a photo from which percentiles are computed."""


def apply_framing(parts: Mapping[str, np.ndarray], files: SceneFiles, warn: Notify = ignore) -> dict[str, np.ndarray]:
    """Crop and rotate all parts of a scene; then invert and clip the photo or the heights, as `files` has it.

    warn: receives the remark that heights look like no data. Raises: PictureError for a crop beyond the picture.
    """
    framed = {part: _rotate(_crop(values, files), files.rotate) for part, values in parts.items()}
    if files.main == "height":
        framed["height"], offset = _heights(framed["height"], files, warn)
        framed[OFFSET] = np.array(offset)
    elif files.main == "photo":
        framed["photo"] = _tones(framed["photo"], files)
    return framed


def measured_size(files: SceneFiles, shape: tuple[int, ...] | None = None) -> MeasuredSize | None:
    """Return the size that a height map states, or the one on the ground, of its cropped part; None without either.

    shape: rows and columns of the whole map, where they are known. An inverted map keeps its proportions alone.
    Raises: PictureError for metadata with wrong values.
    """
    if files.height is None:
        return None
    metadata = None if files.invert or files.cell_m else read_heights_metadata(files.height)
    stated = metadata or _ground(files.height, files.cell_m, shape)
    if stated is None:
        return None
    whole, (all_rows, all_columns) = stated.size, stated.shape
    _, _, columns, rows = files.crop or (0, 0, all_columns, all_rows)
    size_m = whole.width_m * columns / all_columns, whole.length_m * rows / all_rows
    width_m, length_m = size_m[::-1] if files.rotate in (90, 270) else size_m
    return whole._replace(width_m=width_m, length_m=length_m)


def _ground(path: Path, cell_m: float | tuple[float, float] | None, shape: tuple[int, ...] | None) -> Ground | None:
    """Return the cells of a map on the ground: the given ones, or those that its file states."""
    if cell_m is None:
        return read_ground(path)
    rows, columns = shape or read_map(path).shape
    return Ground(cell_m if isinstance(cell_m, tuple) else (cell_m, cell_m), (rows, columns))


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


def _heights(
    values: Float[np.ndarray, "h w"], files: SceneFiles, warn: Notify
) -> tuple[Float32[np.ndarray, "h w"], float]:
    """Return the heights less an offset, and this offset."""
    values = without(values, *as_numbers(files.nodata))
    _warn_of_nodata(values, files, warn)
    values, offset = in_32_bits(values)
    known = values[np.isfinite(values)]
    if files.clip is not None and known.size:
        values = np.clip(values, *np.percentile(known, files.clip).astype(np.float32))
    return (-values, -offset) if files.invert else (values, offset)


def _warn_of_nodata(values: Float[np.ndarray, "h w"], files: SceneFiles, warn: Notify) -> None:
    marks = undeclared_nodata(values)
    if not marks:
        return
    name, texts = Path(str(files.height)).name, [number_text(mark) for mark in marks]
    others = values[np.isfinite(values) & ~np.isin(values, marks)]
    low, high = (f"{end:.6g}" for end in (others.min(), others.max()))
    given = [f"{mark:.16g}" for mark in as_numbers(files.nodata)]
    line = ", ".join([*given, *texts])
    warn(
        f"{100 * (1 - others.size / np.count_nonzero(np.isfinite(values))):.2g} % of {name} is "
        f"{' or '.join(texts)}, far from all other heights ({low} to {high}), and flattens them; if it stands for "
        f"no data, write `nodata: {f'[{line}]' if ',' in line else line}` under `scene:`"
    )


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
