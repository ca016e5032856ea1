"""Pictures as numpy arrays: what is accepted, and what is made of it.

A picture is (h, w), (h, w, 3) or (h, w, 4) RGB(A); uint8, uint16, bool, or floating point in 0..1.
"""

from io import BytesIO
from pathlib import Path
from typing import Any

import numpy as np
from jaxtyping import Float32, UInt8

from .errors import PictureError
from .files import atomic_write

LUMA = np.array([0.299, 0.587, 0.114], np.float32)
"""ITU-R BT.601 weights of R, G, B."""


def check_picture(picture: np.ndarray, name: str = "picture") -> np.ndarray:
    """The array itself, if it is a picture.

    Raises: PictureError naming what is wrong: the shape, the type, an empty picture, or the first place that is
    NaN or infinite.
    """
    if picture.ndim not in (2, 3) or (picture.ndim == 3 and picture.shape[2] not in (3, 4)):
        raise PictureError(f"{name}: a picture is (h, w) or (h, w, 3|4), not {picture.shape}")
    if picture.size == 0:
        raise PictureError(f"{name}: the picture is empty, {picture.shape}")
    if picture.dtype.kind not in "bf" and picture.dtype.str[1:] not in ("u1", "u2"):
        raise PictureError(
            f"{name}: a picture is uint8, uint16, bool or float (0..1), not {picture.dtype}; convert it first"
        )
    check_finite(picture, name)
    return picture


def check_finite(values: np.ndarray, name: str) -> None:
    """Raises: PictureError naming how many values are NaN or infinite, and where the first one is."""
    if values.dtype.kind == "f" and not (finite := np.isfinite(values)).all():
        row, column = np.argwhere(~finite)[0][:2]
        raise PictureError(
            f"{name}: {np.count_nonzero(~finite)} values are NaN or infinite, the first at row {row}, column {column}; "
            "fill or cut them first"
        )


def full_scale(picture: np.ndarray) -> float:
    """The value that stands for white: 255, 65535, 1, or the largest magnitude in a float picture that goes over 1."""
    if picture.dtype.kind == "f":
        return max(1.0, float(np.max(np.abs(picture))))
    return 1.0 if picture.dtype == np.bool_ else float(np.iinfo(picture.dtype).max)


def to_grey(picture: np.ndarray) -> Float32[np.ndarray, "h w"]:
    """Luma in 0..1 (ITU-R BT.601), transparency over white.

    Raises: PictureError as `check_picture`.
    """
    values = _scaled(picture)
    if values.ndim == 2:
        return values
    grey = values[..., :3] @ LUMA
    return grey if values.shape[2] == 3 else 1 - values[..., 3] * (1 - grey)


def to_rgb8(picture: np.ndarray) -> UInt8[np.ndarray, "h w 3"]:
    """Eight bits a channel, transparency over white, for drawing and for libraries that read nothing else."""
    if picture.dtype == np.uint8 and picture.ndim == 3 and picture.shape[2] == 3:
        return picture
    values = _scaled(picture)
    if values.ndim == 2:
        values = np.repeat(values[..., None], 3, axis=2)
    elif values.shape[2] == 4:
        values = 1 - values[..., 3:] * (1 - values[..., :3])
    return np.rint(np.clip(values, 0, 1) * 255).astype(np.uint8)


def _scaled(picture: np.ndarray) -> Float32[np.ndarray, "..."]:
    check_picture(picture)
    return np.asarray(picture / full_scale(picture), np.float32)


def read_picture(path: Path) -> np.ndarray:
    """A picture file as (h, w[, 3|4]) RGB(A), uint8 or uint16, turned as its EXIF orientation says.

    Raises: PictureError if the file is missing, is no picture, is truncated or is too large to be one.
    """
    from PIL import Image, ImageOps, UnidentifiedImageError

    data = _read_bytes(path)
    try:
        with Image.open(BytesIO(data)) as image:
            image.load()
            deep = data[:8] == b"\x89PNG\r\n\x1a\n" and data[24] == 16
            if not deep:
                image = ImageOps.exif_transpose(image)
                return np.asarray(image.convert(_plain_mode(image.mode)))
    except UnidentifiedImageError:
        pass  # OpenCV reads some that Pillow does not, such as 16-bit colour TIFF
    except (OSError, SyntaxError, ValueError, Image.DecompressionBombError) as error:
        raise PictureError(f"{path}: cannot be read as a picture: {error}") from error
    return _read_with_opencv(path, data)


def read_map(path: Path) -> Float32[np.ndarray, "h w"]:
    """A map of numbers (.npy, .pfm, .tif, or any grey picture as its raw values); infinities become NaN.

    Raises: PictureError if the file is missing, is no map, or has no single channel.
    """
    if path.suffix == ".npy":
        _read_bytes(path)
        try:
            values = np.load(path, allow_pickle=False)
        except (ValueError, EOFError, OSError) as error:
            raise PictureError(f"{path}: cannot be read as an array: {error}") from error
    elif path.suffix == ".pfm":
        values = _read_with_opencv(path, _read_bytes(path))
    else:
        values = read_picture(path)
    if values.ndim == 3 and values.shape[2] in (3, 4) and not np.any(values[..., :3] != values[..., :1]):
        values = values[..., 0]
    if values.ndim != 2 or values.size == 0 or values.dtype.kind not in "buif":
        raise PictureError(f"{path}: a map is one number a pixel, (h, w), not {values.shape} of {values.dtype}")
    numbers = values.astype(np.float32)
    return np.where(np.isfinite(numbers), numbers, np.float32(np.nan))


def write_png(path: Path, picture: np.ndarray) -> None:
    """Write a picture as PNG, whole or not at all (see `atomic_write`)."""
    from PIL import Image

    with atomic_write(path) as file:
        Image.fromarray(to_rgb8(picture)).save(file, format="PNG")


def _read_bytes(path: Path) -> bytes:
    try:
        return path.read_bytes()
    except FileNotFoundError as error:
        raise PictureError(f"{path}: there is no such file") from error
    except OSError as error:
        raise PictureError(f"{path}: cannot be read: {error.strerror}") from error


def _plain_mode(mode: str) -> str:
    """The Pillow mode that keeps what a picture holds: grey, RGB or RGBA, 8 bits or what the file has."""
    if mode in ("L", "RGB", "RGBA", "I;16", "F"):
        return mode
    return {"1": "L", "LA": "RGBA", "PA": "RGBA", "I": "I;16", "I;16B": "I;16"}.get(
        mode, "RGBA" if "A" in mode else "RGB"
    )


def _read_with_opencv(path: Path, data: bytes) -> np.ndarray:
    import cv2

    values: Any
    try:
        values = cv2.imdecode(np.frombuffer(data, np.uint8), cv2.IMREAD_UNCHANGED) if data else None
    except cv2.error as error:
        raise PictureError(f"{path}: cannot be read as a picture: {error.err}") from error
    if values is None:
        raise PictureError(f"{path}: is no picture this program can read; use PNG, JPEG, TIFF, PFM or NPY")
    if values.ndim == 3:
        values = cv2.cvtColor(values, cv2.COLOR_BGRA2RGBA if values.shape[2] == 4 else cv2.COLOR_BGR2RGB)
    return values
