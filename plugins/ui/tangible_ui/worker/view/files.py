"""Views as pages fetch them: raw arrays in files at every level of detail, in a folder named by content."""

import json
import shutil
from collections.abc import Callable
from contextlib import suppress
from dataclasses import asdict
from functools import partial
from pathlib import Path
from tempfile import mkdtemp
from typing import Any

import numpy as np
from jaxtyping import Float32, Shaped
from PIL import Image

from tangible_core.data import to_rgb8
from tangible_core.errors import OutputError
from tangible_web.materials import distinct_materials, surface_facts

from .surface_view import Layer, SurfaceView

KEPT = 3  # folders that are kept: tabs may still fetch from the one before
ABOUT = "about.json"
MAX_PREVIEW = 1_000_000  # maximum number of pixels of the picture that is drawn first
MAX_FINE_SIDE = 16_384  # greatest side of a picture that browsers decode, pixels

# Size limit of the coarsest level, cells: software draws it in a fraction of a second; 640 x 480 is drawn as it is.
MAX_CELLS = 350_000
MAX_SIDE = 4096  # greatest side of a level: every WebGL 2 has textures of this size


def show(view: SurfaceView, folder: Path) -> dict[str, Any]:
    """Write a view's files atomically, level 0 the finest, and return the message `scene`. Raises: OutputError."""
    at = folder / view.digest
    about = _about(view)
    leave(at, "what is to be drawn", partial(_write, view, about))
    (at / ABOUT).touch()
    sweep(folder, f"*/{ABOUT}", KEPT)
    return about


def leave(at: Path, what: str, write: Callable[[Path], None]) -> None:
    """Fill a folder that pages fetch from, atomically; an existing one stays. Raises: OutputError."""
    if at.exists():
        return
    part = None
    try:
        part = Path(mkdtemp(prefix=".part-", dir=at.parent))
        write(part)
        _put(part, at)
    except OSError as error:
        why = error.strerror or error
        raise OutputError(f"{at.parent}: {what} cannot be written: {why}; free some space") from error
    finally:
        if part is not None:
            shutil.rmtree(part, ignore_errors=True)


def sweep(folder: Path, pattern: str, count: int) -> None:
    """Remove all but the newest folders that match, or have a file that does; also those of a killed process."""
    folders: list[tuple[int, Path]] = []
    for path in folder.glob(pattern):
        with suppress(OSError):  # another thread swept it
            folders.append((path.stat().st_mtime_ns, path))
    for _, old in sorted(folders)[:-count]:
        shutil.rmtree(old if old.is_dir() else old.parent, ignore_errors=True)


def label_type(labels: np.ndarray) -> str:
    """Return the smallest data type that holds the labels."""
    return "<u2" if int(labels.max(initial=0)) < 2**16 else "<u4"


def _about(view: SurfaceView) -> dict[str, Any]:
    rows, columns = view.relief.height_m.shape
    steps = [2**level for level in range(count_levels((rows, columns)))]
    return surface_facts(
        view.digest,
        view.name,
        view.relief.height_m,
        view.relief.extent_m,
        view.labels,
        [asdict(material) for material in distinct_materials(view.materials)[0]],
        shows=view.shows,
        levels=[{"step": step, "rows": -(-rows // step), "columns": -(-columns // step)} for step in steps],
        label_bytes=2 if view.labels is None else np.dtype(label_type(view.labels)).itemsize,
        parts=None if view.names is None else list(view.names),
        photo=view.picture is not None,
        fine_photo=None if view.picture is None else _fine_size(view.picture),
        layers={name: _layer_facts(layer) for name, layer in view.layers.items()},
    )


def _layer_facts(layer: Layer) -> dict[str, Any]:
    rows, columns = layer.values.shape
    return {"unit": layer.unit, "low": layer.low, "high": layer.high, "rows": rows, "columns": columns}


def _write(view: SurfaceView, about: dict[str, Any], part: Path) -> None:
    _write_arrays(view, len(about["levels"]), part)
    if view.picture is not None:
        _write_picture(view.picture, part)
    (part / ABOUT).write_text(json.dumps(about))


def _put(part: Path, at: Path) -> None:
    """Rename the folder to its place; if another thread put the same there first, that stays."""
    try:
        part.rename(at)
    except OSError:
        if not all((at / path.name).is_file() for path in part.iterdir()):
            raise


def _write_arrays(view: SurfaceView, count: int, part: Path) -> None:
    for level, height_m in enumerate(means(view.relief.height_m, count)):
        _raw(part / f"height-{level}.f32", height_m, "<f4")
    if view.labels is not None:
        kind = label_type(view.labels)
        for level, labels in enumerate(middles(view.labels, count)):
            _raw(part / f"labels-{level}.u", labels, kind)
    _raw(part / "materials.u16", distinct_materials(view.materials)[1], "<u2")
    for name, layer in view.layers.items():
        _raw(part / f"{name}.f32", layer.values, "<f4")


def _raw(path: Path, values: np.ndarray, kind: str) -> None:
    path.write_bytes(np.ascontiguousarray(values, kind).data)


def _fine_size(picture: np.ndarray) -> tuple[int, int] | None:
    """Return width and height of the fine picture; None if the preview is as large."""
    rows, columns = picture.shape[:2]
    if rows * columns <= MAX_PREVIEW and max(rows, columns) <= MAX_SIDE:
        return None
    return _size((columns, rows), rows * columns, MAX_FINE_SIDE)


def _size(size: tuple[int, int], most_pixels: int, most_side: int) -> tuple[int, int]:
    width, height = size
    share = min(1.0, (most_pixels / (width * height)) ** 0.5, most_side / max(size))
    return max(1, round(share * width)), max(1, round(share * height))


def _write_picture(picture: np.ndarray, part: Path) -> None:
    """Write the preview, and the fine picture if that is larger."""
    whole = as_image(picture)
    if (fine := _fine_size(picture)) is not None:
        _save(whole, fine, part / "photo-fine.jpg")
    _save(whole, _size(whole.size, MAX_PREVIEW, MAX_SIDE), part / "photo.jpg")


def as_image(picture: np.ndarray) -> Image.Image:
    """Return a picture as a browser shows it."""
    return Image.fromarray(picture if picture.dtype == np.uint8 else to_rgb8(picture)).convert("RGB")


def write_whole(picture: np.ndarray, path: Path) -> None:
    """Write a picture at full size, up to what browsers decode."""
    whole = as_image(picture)
    _save(whole, _size(whole.size, whole.width * whole.height, MAX_FINE_SIDE), path)


def _save(whole: Image.Image, size: tuple[int, int], path: Path) -> None:
    small = whole if size == whole.size else whole.resize(size, Image.Resampling.BOX, reducing_gap=2.0)
    small.save(path, quality=88)


def count_levels(shape: tuple[int, int]) -> int:
    """Return the number of levels of a grid of (rows, columns)."""
    levels = 1
    while shape[0] * shape[1] > MAX_CELLS or max(shape) > MAX_SIDE:
        shape, levels = (-(-shape[0] // 2), -(-shape[1] // 2)), levels + 1
    return levels


def means(values: Float32[np.ndarray, "h w"], levels: int) -> list[Float32[np.ndarray, "..."]]:
    """Return the levels of values: level k is the mean over blocks of 2^k x 2^k cells, smaller at the end."""
    levels_ = [values]
    rows, columns = (np.ones(side) for side in values.shape)
    for _ in range(levels - 1):
        half = _halve_rows(_halve_rows(levels_[-1], rows).T, columns).T
        levels_.append(np.ascontiguousarray(half))
        rows, columns = _pair_weights(rows), _pair_weights(columns)
    return levels_


def middles(labels: Shaped[np.ndarray, "h w"], levels: int) -> list[Shaped[np.ndarray, "..."]]:
    """Return the levels of labels: level k has the label at the middle of each block of 2^k x 2^k cells."""
    levels_ = [labels]
    for level in range(1, levels):
        step = 2**level
        places = (np.minimum(np.arange(0, side, step) + step // 2, side - 1) for side in labels.shape)
        levels_.append(labels[np.ix_(*places)])
    return levels_


def _halve_rows(values: Float32[np.ndarray, "h w"], weights: np.ndarray) -> Float32[np.ndarray, "n w"]:
    """Return weighted means of rows in pairs; a last row without a partner stays."""
    pairs = len(values) // 2
    half = values[0::2].copy()
    share = weights[1::2] / (weights[0::2][:pairs] + weights[1::2])
    half[:pairs] += (values[1::2] - values[0::2][:pairs]) * share[:, None].astype(np.float32)
    return half


def _pair_weights(weights: np.ndarray) -> np.ndarray:
    return np.add.reduceat(weights, np.arange(0, len(weights), 2))
