"""True disparity in files, as the kits of benchmarks store it."""

from pathlib import Path
from typing import Annotated, Literal

import numpy as np
from jaxtyping import Float32
from pydantic import Field

from ..errors import PictureError
from .frames import Say, unsaid
from .picture_files import bytes_of, map_of, read_map, values_of

TruthScale = Annotated[float, Field(gt=0, allow_inf_nan=False)] | Literal["sintel"]


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
