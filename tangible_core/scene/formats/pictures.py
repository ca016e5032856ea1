"""Pictures, maps of numbers, true disparities and label pictures in files.

The colours of our label pictures are known whatever program saved them.
"""

from collections.abc import Sequence
from functools import cache
from pathlib import Path
from typing import Annotated, Any, Literal, cast

import numpy as np
from jaxtyping import Float, Float32, Int32, UInt8
from pydantic import Field

from ...data.pictures import check_finite, check_picture, opaque
from ...errors import PictureError
from ...runtime.opencv import cv2, plain_opencv
from .decoding import content_bytes, decode_values
from .kinds import JPEG
from .multi_picture import Notify, ignore
from .reducing import decode_reduced

TruthScale = Annotated[float, Field(gt=0, allow_inf_nan=False)] | Literal["sintel"]
NonFinite = Literal["error", "mask"]

# Share of a JPEG's pixels that most colours have less of where compression made them.
FEW_PIXELS = 1e-3
MAX_LABELS = 4096
"""Largest number of labels in a label picture; a picture with more colours is taken for a photo."""


def read_picture(
    path: Path, non_finite: NonFinite = "error", notify: Notify = ignore, reduce: bool = False
) -> np.ndarray:
    """Read a picture file as (h, w[, 3|4]) RGB(A), upright by its EXIF orientation: uint8, uint16, or its own dtype.

    A palette becomes colours, transparency a fourth channel. `.npy` and `.npz` files hold the array itself.
    non_finite: NaN and infinity raise an error, or, for `mask`, stay in the array.
    notify: receives a remark if the file holds more pictures, of which the first is taken, or if it is reduced.
    reduce: halve the sides of a JPEG, PNG or TIFF that is too large, up to three times, while it is decoded.
    Raises: PictureError if the file is missing, not a picture, damaged, cut short or too large.
    """
    data = content_bytes(path)
    if reduce and (picture := decode_reduced(path, data, notify)) is not None:
        return to_picture(picture, str(path), non_finite)
    return to_picture(decode_values(path, data, notify), str(path), non_finite)


def to_picture(values: np.ndarray, name: str, non_finite: NonFinite = "error") -> np.ndarray:
    """Return an array as `read_picture` does. Raises: PictureError if it is not a picture, or holds NaN or infinity."""
    if non_finite == "error":
        return check_picture(values, name)
    check_picture(np.nan_to_num(values, posinf=0, neginf=0), name)
    return values


def read_map(path: Path, notify: Notify = ignore, exact: bool = False) -> Float[np.ndarray, "h w"]:
    """Read a map of numbers: .npy, .npz, .pfm, .tif, or the raw values of any grey picture.

    exact: keep numbers in 64 bits that 32 do not hold.
    NaN stands for infinity, for transparent pixels, and for a GeoTIFF's value for no data (GDAL's tag).
    Raises: PictureError as `read_picture`, or if there is more than one number a pixel.
    """
    return to_map(decode_values(path, content_bytes(path), notify, "map"), str(path), exact)


def to_map(values: np.ndarray, name: str, exact: bool = False) -> Float[np.ndarray, "h w"]:
    """Return an array as `read_map` does, NaN where it is masked. Raises: PictureError for several numbers a pixel."""
    masked_map: Any = values if np.ma.isMaskedArray(values) and values.dtype.kind in "buif" else None
    if masked_map is not None:
        values = cast(np.ndarray, masked_map.astype(np.result_type(masked_map.dtype, np.float32)).filled(np.nan))
    opaque_mask = opaque(values) if values.ndim == 3 and values.shape[2] == 4 else None
    if values.ndim == 3 and values.shape[2] in (3, 4) and not np.any(values[..., :3] != values[..., :1]):
        values = values[..., 0]
    if values.ndim != 2 or values.size == 0 or values.dtype.kind not in "buif":
        raise PictureError(
            f"{name}: a map must have one number per pixel, (h, w), not {values.shape} of {values.dtype}"
        )
    with np.errstate(over="ignore"):
        numbers = values.astype(np.result_type(values.dtype, np.float32) if exact else np.float32)
    valid_mask = np.isfinite(numbers) if opaque_mask is None else np.isfinite(numbers) & opaque_mask
    return np.where(valid_mask, numbers, numbers.dtype.type(np.nan))


def without(values: Float[np.ndarray, "h w"], *nodata: float) -> Float[np.ndarray, "h w"]:
    """Replace these values of a map, also rounded to 32 bits, by NaN."""
    if not nodata:
        return values
    with np.errstate(over="ignore"):
        marks = np.array(nodata, np.float64)
        marks = np.concatenate([marks, marks.astype(np.float32)]).astype(values.dtype)
    return np.where(np.isin(values, marks), values.dtype.type(np.nan), values)


def read_labels(path: Path, notify: Notify = ignore) -> Int32[np.ndarray, "h w"]:
    """Read a label picture as 0..n-1, each of them present, in the order of its grey values, indices or colours.

    One of ours keeps its order in whatever form another program saved it.
    Raises: PictureError as `read_picture`, or if it holds too many labels to be a label picture.
    """
    data = content_bytes(path)
    values = decode_values(path, data, notify, "labels")
    colours = decode_values(path, data, ignore) if values.ndim == 2 and values.dtype == np.uint8 else values
    is_coloured = colours.ndim == 3 and colours.dtype == np.uint8
    labels = labels_by_colour(colours, str(path)) if is_coloured else None
    labels = to_labels(values, str(path)) if labels is None else labels
    if data.startswith(JPEG) and np.median(np.bincount(labels.ravel())) < labels.size * FEW_PIXELS:
        raise PictureError(
            f"{path}: holds {labels.max() + 1} labels, most of a few pixels: JPEG mixes the colours of segments; save "
            "the picture losslessly, as PNG"
        )
    return labels


def to_labels(values: np.ndarray, name: str) -> Int32[np.ndarray, "h w"]:
    """Return an array as `read_labels` does. Raises: PictureError if it has too many labels, or is not a picture."""
    if values.ndim == 3 and values.dtype.kind == "u" and values.shape[2] <= 4:
        values = values.astype(np.uint64) @ (1 << 16 * np.arange(values.shape[2], dtype=np.uint64))
    if values.ndim != 2 or values.size == 0 or values.dtype.kind not in "buif":
        raise PictureError(
            f"{name}: a label picture must have one label per pixel, not {values.shape} of {values.dtype}"
        )
    check_finite(values, name)
    distinct, labels = _rank(values)
    if distinct.size > MAX_LABELS:
        raise PictureError(
            f"{name}: holds {distinct.size} labels, but at most {MAX_LABELS} are allowed; give each segment one flat "
            "colour and save the picture losslessly, as PNG"
        )
    return labels.reshape(values.shape).astype(np.int32, copy=False)


def _rank(values: np.ndarray) -> tuple[np.ndarray, np.ndarray]:
    """Return the distinct values in order, and the rank of each value; np.unique takes seconds on a large picture."""
    if values.dtype.kind != "u" or values.dtype.itemsize > 2:
        return np.unique(values, return_inverse=True)
    present = np.bincount(values.reshape(-1)) > 0
    return np.flatnonzero(present), (np.cumsum(present, dtype=np.int32) - 1)[values]


def read_truth(
    path: Path, scale: TruthScale | None = None, nodata: Sequence[float] = (), notify: Notify = ignore
) -> Float32[np.ndarray, "h w"]:
    """Read true or given disparity, in pixels, NaN where unknown, as the kits of benchmarks store it.

    scale: None for numbers in pixels; the number of file units a pixel, where 0 or less is unknown; or `sintel` for
    red * 4 + green / 64 + blue / 16384, which cannot mark unknown pixels. nodata: numbers of the file for no data.
    Raises: PictureError as `read_map`.
    """
    purpose = "picture" if scale == "sintel" else "map"
    return to_truth(decode_values(path, content_bytes(path), notify, purpose), str(path), scale, nodata)


def to_truth(
    values: np.ndarray, name: str, scale: TruthScale | None = None, nodata: Sequence[float] = ()
) -> Float32[np.ndarray, "h w"]:
    """Return an array as `read_truth` does. Source: the kit of MPI Sintel, sintel_io.py. Raises: PictureError."""
    if scale != "sintel":
        numbers = without(to_map(values, name), *nodata)
        return numbers if scale is None else np.where(numbers > 0, numbers / np.float32(scale), np.float32(np.nan))
    if values.ndim != 3 or values.shape[2] != 3 or values.dtype != np.uint8:
        raise PictureError(
            f"{name}: Sintel's disparities are pictures of three channels of 8 bits, not {values.shape} of "
            f"{values.dtype}; leave the scale `sintel` out"
        )
    red, green, blue = np.moveaxis(values.astype(np.float32), 2, 0)
    return 4 * red + green / 64 + blue / 16384


MAX_IN_PALETTE = 256
"""Largest number of colours in the palette of a PNG."""
SPARE = 24
"""Number of unused colours in the palette, for new parts in a paint program that keeps to the palette."""
# Levels of red, green and blue among which colours are chosen: more colours than a label picture may have labels.
STEPS = 21
# Bounds of the colours in CIELAB: black and white are a paint program's defaults, and strong colours glare.
DARKEST, LIGHTEST, MAX_CHROMA = 30.0, 92.0, 85.0


@cache
def distinct_colours(count: int) -> UInt8[np.ndarray, "n 3"]:
    """Choose n colours, each as far as possible, in CIELAB, from all before it; fewer colours are the first of these.

    Source: Gonzalez, Clustering to minimize the maximum intercluster distance (1985).
    """
    steps = np.rint(np.linspace(0, 255, STEPS)).astype(np.uint8)
    colours = np.stack(np.meshgrid(steps, steps, steps, indexing="ij"), axis=-1).reshape(-1, 3)
    with plain_opencv():
        lab = cv2.cvtColor(colours[None].astype(np.float32) / 255, cv2.COLOR_RGB2LAB)[0]
    chroma = np.hypot(lab[:, 1], lab[:, 2])
    pleasant = (lab[:, 0] >= DARKEST) & (lab[:, 0] <= LIGHTEST) & (chroma <= MAX_CHROMA)
    colours, lab, chroma = colours[pleasant], lab[pleasant], chroma[pleasant]
    indices = [int(chroma.argmax())]
    far = np.linalg.norm(lab - lab[indices[0]], axis=1)
    while len(indices) < count:
        indices.append(int(far.argmax()))
        far = np.minimum(far, np.linalg.norm(lab - lab[indices[-1]], axis=1))
    distinct = colours[indices]
    distinct.flags.writeable = False
    return distinct


def labels_by_colour(picture: UInt8[np.ndarray, "h w c"], name: str) -> Int32[np.ndarray, "h w"] | None:
    """Return labels in a palette of ours; None for any other picture. Raises: PictureError for mixed colours."""
    codes, places = np.unique(_codes(picture), return_inverse=True)
    ours = {int(code): number for number, code in enumerate(_codes(distinct_colours(MAX_IN_PALETTE)))}
    numbers = np.array([ours.get(int(code), -1) for code in codes[: 2 * MAX_IN_PALETTE]])
    valid_mask = numbers >= 0
    if valid_mask.sum() < 2 or numbers.max() >= 2 * valid_mask.sum() + SPARE:
        return None
    if len(codes) == valid_mask.sum():
        return np.argsort(np.argsort(numbers)).astype(np.int32)[places].reshape(picture.shape[:2])
    pixels = np.bincount(places.ravel())
    share = 1 - pixels[: len(numbers)][valid_mask].sum() / pixels.sum()
    if share > 0.5 or len(codes) < 2 * valid_mask.sum():
        return None
    raise PictureError(
        f"{name}: in {100 * share:.2g} % of its pixels, colours of parts are mixed: another program smoothed, scaled "
        "or compressed it; save it as PNG, without smoothing and at its own size"
    )


def _codes(colours: UInt8[np.ndarray, "*n c"]) -> Int32[np.ndarray, "*n"]:
    red, green, blue = np.moveaxis(colours[..., :3].astype(np.int32), -1, 0)
    return red << 16 | green << 8 | blue
