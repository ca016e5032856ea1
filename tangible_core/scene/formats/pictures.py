"""Pictures, maps of numbers, true disparities and label pictures in files."""

from pathlib import Path
from typing import Annotated, Any, Literal, cast

import numpy as np
from jaxtyping import Float32, Int32
from pydantic import Field

from ...data.pictures import check_finite, check_picture, opaque
from ...errors import PictureError
from .decoding import bytes_of, values_of
from .multi_picture import Say, unsaid
from .tiff_tags import TIFF, stated_nodata

TruthScale = Annotated[float, Field(gt=0, allow_inf_nan=False)] | Literal["sintel"]
NonFinite = Literal["error", "mask"]

MAX_LABELS = 4096
"""More than this in a label picture, and it is a photo."""


def read_picture(path: Path, non_finite: NonFinite = "error", say: Say = unsaid) -> np.ndarray:
    """A picture file as (h, w[, 3|4]) RGB(A), upright as its EXIF orientation says: uint8, uint16, or what it holds.

    A palette becomes colours, transparency a fourth channel. `.npy` and `.npz` files hold the array itself.
    non_finite: what becomes of NaN and infinity: an error, or, for `mask`, nothing: they are in what is returned.
    say: hears of more pictures in the file, of which the first is taken.
    Raises: PictureError if the file is missing, no picture, damaged, cut short or too large.
    """
    return picture_of(_read(path, say), str(path), non_finite)


def picture_of(values: np.ndarray, name: str, non_finite: NonFinite = "error") -> np.ndarray:
    """An array as `read_picture` returns it. Raises: PictureError if it is no picture, or holds NaN or infinity."""
    if non_finite == "error":
        return check_picture(values, name)
    check_picture(np.nan_to_num(values), name)
    return values


def read_map(path: Path, say: Say = unsaid) -> Float32[np.ndarray, "h w"]:
    """A map of numbers (.npy, .npz, .pfm, .tif, or any grey picture as its raw values); infinities become NaN.

    So does what is transparent, and what a GeoTIFF states to be no data (GDAL's tag).
    Raises: PictureError as `read_picture`, or if there is more than one number a pixel.
    """
    data = bytes_of(path)
    found = map_of(values_of(path, data, say), str(path))
    nodata = stated_nodata(data) if data[:4] in TIFF else None
    if nodata is None:
        return found
    known = without(found, nodata)
    if missing := np.count_nonzero(np.isnan(known)) - np.count_nonzero(np.isnan(found)):
        say(f"{100 * missing / known.size:.1f} % of {path.name} is {nodata:g}, which it states to be no data")
    return known


def map_of(values: np.ndarray, name: str) -> Float32[np.ndarray, "h w"]:
    """An array as `read_map` returns it, NaN where it is masked.

    Raises: PictureError if there is more than one number a pixel.
    """
    masked: Any = values if np.ma.isMaskedArray(values) and values.dtype.kind in "buif" else None
    if masked is not None:
        values = cast(np.ndarray, masked.astype(np.float64).filled(np.nan))
    shown = opaque(values) if values.ndim == 3 and values.shape[2] == 4 else None
    if values.ndim == 3 and values.shape[2] in (3, 4) and not np.any(values[..., :3] != values[..., :1]):
        values = values[..., 0]
    if values.ndim != 2 or values.size == 0 or values.dtype.kind not in "buif":
        raise PictureError(
            f"{name}: a map must have one number per pixel, (h, w), not {values.shape} of {values.dtype}"
        )
    with np.errstate(over="ignore"):
        numbers = values.astype(np.float32)
    known = np.isfinite(numbers) if shown is None else np.isfinite(numbers) & shown
    return np.where(known, numbers, np.float32(np.nan))


def without(values: Float32[np.ndarray, "h w"], *nodata: float) -> Float32[np.ndarray, "h w"]:
    """NaN where a map holds one of these values, as 32 bits hold it."""
    with np.errstate(over="ignore"):
        marks = np.array(nodata, np.float64).astype(np.float32)
    return np.where(np.isin(values, marks), np.float32(np.nan), values)


def read_labels(path: Path, say: Say = unsaid) -> Int32[np.ndarray, "h w"]:
    """A label picture as 0..n-1, each of them present, in the order of its grey values, palette indices or colours.

    Raises: PictureError as `read_picture`, or if it holds too many labels to be a label picture.
    """
    return labels_of(_read(path, say, indices=True), str(path))


def labels_of(values: np.ndarray, name: str) -> Int32[np.ndarray, "h w"]:
    """An array as `read_labels` returns it. Raises: PictureError if it holds too many labels, or is no picture."""
    if values.ndim == 3 and values.dtype.kind == "u" and values.shape[2] <= 4:
        values = values.astype(np.uint64) @ (1 << 16 * np.arange(values.shape[2], dtype=np.uint64))
    if values.ndim != 2 or values.size == 0 or values.dtype.kind not in "buif":
        raise PictureError(
            f"{name}: a label picture must have one label per pixel, not {values.shape} of {values.dtype}"
        )
    check_finite(values, name)
    known, labels = _ranked(values)
    if known.size > MAX_LABELS:
        raise PictureError(
            f"{name}: holds {known.size} labels, but at most {MAX_LABELS} are allowed; give each segment one flat "
            "colour and save the picture losslessly, as PNG"
        )
    return labels.reshape(values.shape).astype(np.int32, copy=False)


def _ranked(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """The values that there are, in order, and which of them each is; sorting millions of small ones takes seconds."""
    if values.dtype.kind != "u" or values.dtype.itemsize > 2:
        return np.unique(values, return_inverse=True)
    there = np.bincount(values.reshape(-1)) > 0
    return np.flatnonzero(there), (np.cumsum(there, dtype=np.int32) - 1)[values]


def _read(path: Path, say: Say, indices: bool = False) -> np.ndarray:
    """The raw values of any file that holds an array; `indices` keeps those of a palette."""
    return values_of(path, bytes_of(path), say, indices)


def read_truth(path: Path, scale: TruthScale | None = None, say: Say = unsaid) -> Float32[np.ndarray, "h w"]:
    """True disparity in px, NaN where unknown.

    scale: None for numbers that are pixels; how many of the file's units are a pixel, 0 or less being unknown; or
    `sintel` for red * 4 + green / 64 + blue / 16384, which cannot mark what is unknown.
    Raises: PictureError as `read_map`.
    """
    if scale == "sintel":
        return _unpacked(values_of(path, bytes_of(path), say), str(path))
    return _in_pixels(read_map(path, say), scale)


def truth_of(values: np.ndarray, name: str, scale: TruthScale | None = None) -> Float32[np.ndarray, "h w"]:
    """An array as `read_truth` returns it. Raises: PictureError."""
    return _unpacked(values, name) if scale == "sintel" else _in_pixels(map_of(values, name), scale)


def _in_pixels(stored: Float32[np.ndarray, "h w"], scale: float | None) -> Float32[np.ndarray, "h w"]:
    if scale is None:
        return stored
    return np.where(stored > 0, stored / np.float32(scale), np.float32(np.nan))


def _unpacked(values: np.ndarray, name: str) -> Float32[np.ndarray, "h w"]:
    """Source: the kit of MPI Sintel stereo, sintel_io.py."""
    if values.ndim != 3 or values.shape[2] != 3 or values.dtype != np.uint8:
        raise PictureError(
            f"{name}: Sintel's disparities are pictures of three channels of 8 bits, not {values.shape} of "
            f"{values.dtype}; leave `truth_scale: sintel` out"
        )
    red, green, blue = np.moveaxis(values.astype(np.float32), 2, 0)
    return 4 * red + green / 64 + blue / 16384
