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

OFFSET = "offset"  # the part of a framed scene that is the offset that was taken off its heights
SAMPLED = 4_000_000  # approximate number of pixels of a photo from which percentiles are computed


def apply_framing(parts: Mapping[str, np.ndarray], files: SceneFiles, warn: Notify = ignore) -> dict[str, np.ndarray]:
    """Crop and rotate all parts of a scene; then invert and clip the photo or the heights. Raises: PictureError."""
    parts_framed = {part: _rotate(_crop(values, files), files.rotate) for part, values in parts.items()}
    if files.main == "height":
        parts_framed["height"], offset = _heights(parts_framed["height"], files, warn)
        parts_framed[OFFSET] = np.array(offset)
    elif files.main == "photo":
        parts_framed["photo"] = _tones(parts_framed["photo"], files)
    return parts_framed


def measured_size(files: SceneFiles, shape: tuple[int, ...] | None = None) -> MeasuredSize | None:
    """Return the size that a height map states, or the one on the ground, of its cropped part; None without either."""
    if files.height is None:
        return None
    # An inverted map keeps its proportions alone.
    metadata = None if files.invert or files.cell_m else read_heights_metadata(files.height)
    map_size = metadata or _ground(files.height, files.cell_m, shape)
    if map_size is None:
        return None
    whole, (all_rows, all_columns) = map_size.size, map_size.shape
    _, _, columns, rows = files.crop or (0, 0, all_columns, all_rows)
    size_m = whole.width_m * columns / all_columns, whole.length_m * rows / all_rows
    width_m, length_m = size_m[::-1] if files.rotate in (90, 270) else size_m
    return whole._replace(width_m=width_m, length_m=length_m)


def _ground(path: Path, cell_m: float | tuple[float, float] | None, shape: tuple[int, ...] | None) -> Ground | None:
    if cell_m is None:
        return read_ground(path)
    rows, columns = shape or read_map(path).shape
    return Ground(cell_m if isinstance(cell_m, tuple) else (cell_m, cell_m), (rows, columns))


def cut_out(picture: np.ndarray, name: str) -> tuple[np.ndarray, Bool[np.ndarray, "h w"]]:
    """Drop a picture's fourth channel, filling what it hides; return the opaque mask too. Raises: PictureError."""
    mask = opaque(picture)
    if not mask.any():
        raise PictureError(f"{name}: all of the picture is transparent; there is nothing to feel")
    colours = np.ascontiguousarray(picture[..., :3])
    return colours if mask.all() else fill_from_nearest(colours, mask), mask


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
    values = without(values, *as_numbers(files.nodata))
    _warn_of_nodata(values, files, warn)
    values, offset = in_32_bits(values)
    finite = values[np.isfinite(values)]
    if files.clip is not None and finite.size:
        values = np.clip(values, *np.percentile(finite, files.clip).astype(np.float32))
    return (-values, -offset) if files.invert else (values, offset)


def _warn_of_nodata(values: Float[np.ndarray, "h w"], files: SceneFiles, warn: Notify) -> None:
    marks = undeclared_nodata(values)
    if not marks:
        return
    name, texts = Path(str(files.height)).name, [number_text(mark) for mark in marks]
    others = values[np.isfinite(values) & ~np.isin(values, marks)]
    low, high = (f"{end:.6g}" for end in (others.min(), others.max()))
    marks_given = [f"{mark:.16g}" for mark in as_numbers(files.nodata)]
    line = ", ".join([*marks_given, *texts])
    warn(
        f"{100 * (1 - others.size / np.count_nonzero(np.isfinite(values))):.2g} % of {name} is "
        f"{' or '.join(texts)}, far from all other heights ({low} to {high}), and flattens them; if it stands for "
        f"no data, write `nodata: {f'[{line}]' if ',' in line else line}` under `scene:`"
    )


def _tones(picture: np.ndarray, files: SceneFiles) -> np.ndarray:
    if files.clip is None and not files.invert:
        return picture
    result = picture.copy()
    tones = result if result.ndim == 2 else result[..., :3]
    if files.clip is not None and tones.dtype != np.bool_:
        low, high = _range(picture, files.clip)
        np.clip(tones, low, high, out=tones)
    if files.invert:
        tones[...] = ~tones if tones.dtype.kind in "bu" else max(1.0, float(np.nanmax(tones, initial=0))) - tones
    return result


def _range(picture: np.ndarray, percent: tuple[float, float]) -> np.ndarray:
    step = max(1, round((picture.shape[0] * picture.shape[1] / SAMPLED) ** 0.5))
    some = picture[::step, ::step]
    brightness = some.astype(np.float32) if some.ndim == 2 else luma(some[..., :3].astype(np.float32))
    brightness = brightness[np.isfinite(brightness) & opaque(some)]
    ends = np.percentile(brightness, percent) if brightness.size else np.array([some.min(), some.max()])
    return ends.astype(picture.dtype)
