"""Pictures as numpy arrays: checks and conversions (`scene.formats.pictures` reads and writes files).

A picture is (h, w), (h, w, 3) or (h, w, 4) RGB(A); uint8, uint16, bool, or floating point in 0..1. Whole numbers of any
other type are understood where they are those of 8 or 16 bits, and floating point in 0..255 or 0..65535 as well.
"""

from typing import Any, NamedTuple, cast

import numpy as np
from jaxtyping import Bool, Float32, UInt8

from ..errors import PictureError
from .arguments import as_picture

# The weights of R and B in luma (ITU-R BT.601); the weight of G is the rest of 1.
RED, BLUE = np.float32(0.299), np.float32(0.114)


MOST = 65535  # the largest value of a picture: 16 bits
# Share of its range below which the values of a picture are one: less than a step of 16 bits.
FAINT = 1e-5
# Share of its range, from black to white, that a picture of more than 8 bits uses if it is full: 14 bits of 16.
USED_SHARE = 0.25
# The largest value of a float picture in 0..1, two stops above white; one that exceeds it is in 0..255.
BRIGHTEST = 4.0


def check_picture(picture: np.ndarray, name: str = "picture") -> np.ndarray:
    """Return the array itself if it is a picture; whole numbers of another type become uint8 or uint16.

    Raises: PictureError if the shape or the type is wrong, the picture is empty, a value is NaN or infinite, or a whole
    number is negative or beyond 16 bits.
    """
    picture = as_picture(name, picture)
    if picture.ndim not in (2, 3) or (picture.ndim == 3 and picture.shape[2] not in (3, 4)):
        raise PictureError(f"{name}: a picture is (h, w) or (h, w, 3|4), not {picture.shape}")
    if picture.size == 0:
        raise PictureError(f"{name}: the picture is empty, {picture.shape}")
    if picture.dtype.kind in "iu" and picture.dtype.str[1:] not in ("u1", "u2"):
        return _of_16_bits(picture, name)
    if picture.dtype.kind not in "bfu":
        raise PictureError(f"{name}: a picture holds whole numbers, bool or float (0..1), not {picture.dtype}")
    check_finite(picture, name)
    return picture


def _of_16_bits(picture: np.ndarray, name: str) -> np.ndarray:
    """Return whole numbers of any type as uint8, or uint16 where one exceeds 255."""
    low, high = int(picture.min()), int(picture.max())
    if low < 0 or high > MOST:
        raise PictureError(
            f"{name}: holds whole numbers from {low} to {high}; those of a picture run from 0 to 255, or to {MOST}; "
            "scale it first"
        )
    return picture.astype(np.min_scalar_type(high))


def is_one_colour(picture: np.ndarray) -> bool:
    """Return True if all pixels are equal; the first row decides it for most pictures."""
    first = picture[:1, :1]
    return bool(np.all(picture[:1] == first)) and bool(np.all(picture == first))


def check_finite(values: np.ndarray, name: str) -> None:
    """Raise a PictureError with the number of NaN or infinite values and the place of the first, if there are any."""
    if values.dtype.kind == "f" and not (finite := np.isfinite(values)).all():
        row, column = np.argwhere(~finite)[0][:2]
        raise PictureError(
            f"{name}: {np.count_nonzero(~finite)} values are NaN or infinite, the first at row {row}, column {column}; "
            "fill or cut them first"
        )


def fill_non_finite(picture: np.ndarray) -> tuple[np.ndarray, Bool[np.ndarray, "h w"]]:
    """Return the picture with each NaN or infinite pixel replaced by the nearest finite one, and the finite mask."""
    finite: np.ndarray = np.all(np.isfinite(np.atleast_3d(picture)), axis=2)
    if not finite.any():
        raise PictureError(f"none of the {finite.size} pixels is finite; use a picture with finite pixels")
    return fill_from_nearest(picture, finite), finite


def fill_from_nearest(picture: np.ndarray, valid_mask: Bool[np.ndarray, "h w"]) -> np.ndarray:
    """Return the picture with each unknown pixel replaced by the nearest valid one; at least one must be valid."""
    from scipy import ndimage  # pyright: ignore[reportMissingTypeStubs]

    nearest = cast(Any, ndimage).distance_transform_edt(~valid_mask, return_distances=False, return_indices=True)
    return picture[nearest[0], nearest[1]]


def opaque(picture: np.ndarray) -> Bool[np.ndarray, "h w"]:
    """Return a mask of the opaque pixels: those with an alpha of at least one half; all if there is no alpha."""
    if picture.ndim == 2 or picture.shape[2] == 3:
        return np.ones(picture.shape[:2], np.bool_)
    return is_opaque(picture[..., 3])


def is_opaque(alpha: np.ndarray) -> Bool[np.ndarray, "h w"]:
    """Return a mask of the pixels whose opacity is at least one half."""
    if alpha.dtype.kind in "iu":
        return alpha > np.iinfo(alpha.dtype).max // 2
    return alpha if alpha.dtype == np.bool_ else alpha >= 0.5


def full_scale(picture: np.ndarray, *others: np.ndarray) -> float:
    """Return the value of white: 1, 255 or 65535; of a float picture that fits none of these, its largest magnitude."""
    if picture.dtype.kind == "f":
        largest = max(float(np.max(np.abs(values))) for values in (picture, *others))
        return next((white for white in (255.0, float(MOST)) if BRIGHTEST < largest <= white), max(1.0, largest))
    return 1.0 if picture.dtype == np.bool_ else float(np.iinfo(picture.dtype).max)


class UsedRange(NamedTuple):
    """The values between black and white that a picture of more than 8 bits uses, where these are few."""

    low: float
    high: float
    white: float

    def stretch(self, picture: np.ndarray) -> np.ndarray:
        """Return a picture in which these values run from black to white; those beyond are clipped."""
        share = (np.clip(picture, self.low, self.high).astype(np.float64) - self.low) / (self.high - self.low)
        values = share * self.white
        return (np.rint(values) if picture.dtype.kind == "u" else values).astype(picture.dtype)

    def sentence(self, name: str) -> str:
        """Return the remark that a picture is stretched."""
        part = 100 * (self.high - self.low) / self.white
        return (
            f"{name} uses {part:.2g} % of its range ({self.low:.6g} to {self.high:.6g} of {self.white:g}); it is "
            "stretched to all of it"
        )


def used_range(*pictures: np.ndarray) -> UsedRange | None:
    """Return the range that these pictures use together; None if it is not small, or they have 8 bits.

    A thermal camera writes tenths of kelvins into 16 bits: its pictures are next to black as they are.
    """
    if not pictures or any(picture.dtype.itemsize == 1 for picture in pictures):
        return None
    tones = [picture[..., :3] if picture.ndim == 3 else picture for picture in pictures]
    low, high = float(min(map(np.min, tones))), float(max(map(np.max, tones)))
    white = max(map(full_scale, tones))
    return UsedRange(low, high, white) if FAINT * white < high - low <= USED_SHARE * white else None


def to_grey(picture: np.ndarray) -> Float32[np.ndarray, "h w"]:
    """Convert a picture to luma in 0..1 (ITU-R BT.601), transparency over white.

    Raises: PictureError as `check_picture`.
    """
    values = _to_unit_range(picture)
    if values.ndim == 2:
        return values
    grey = luma(values)
    return grey if values.shape[2] == 3 else grey * values[..., 3] + (1 - values[..., 3])


def luma(values: Float32[np.ndarray, "h w c"]) -> Float32[np.ndarray, "h w"]:
    """Return the luma of the first three channels: exactly v where all three are v.

    Computed element by element: every BLAS and processor sums a matrix product in another order.
    """
    red, green, blue = values[..., 0], values[..., 1], values[..., 2]
    grey, bluer = red - green, blue - green
    grey *= RED
    grey += green
    bluer *= BLUE
    grey += bluer
    return grey


def to_rgb8(picture: np.ndarray) -> UInt8[np.ndarray, "h w 3"]:
    """Convert a picture to 8 bits a channel, transparency over white, for drawing and libraries that need it."""
    if picture.dtype == np.uint8 and picture.ndim == 3 and picture.shape[2] == 3:
        return picture
    return np.rint(np.clip(to_rgb(picture), 0, 1) * 255).astype(np.uint8)


def to_rgb(picture: np.ndarray) -> Float32[np.ndarray, "h w 3"]:
    """Convert a picture to RGB in 0..1, transparency over white. Raises: PictureError as `check_picture`."""
    values = _to_unit_range(picture)
    if values.ndim == 2:
        return np.repeat(values[..., None], 3, axis=2)
    return values if values.shape[2] == 3 else 1 - values[..., 3:] * (1 - values[..., :3])


def _to_unit_range(picture: np.ndarray) -> Float32[np.ndarray, "..."]:
    picture = check_picture(picture)
    white = full_scale(picture)
    if picture.dtype.kind == "f":
        return np.asarray(picture / white, np.float32)
    return picture.astype(np.float32) / np.float32(white)


def check_same_shape(name: str, values: np.ndarray, other: str, others: np.ndarray) -> None:
    """Raise a PictureError if the values are not (h, w) with at least one pixel, or differ in size from the others."""
    if values.ndim != 2 or values.size == 0:
        raise PictureError(f"{name} is (h, w) with at least one pixel, not {values.shape}")
    if values.shape != others.shape:
        raise PictureError(
            f"{name} is {size_in_words(values)} and {other} is {size_in_words(others)}; they must be of one size"
        )


def size_in_words(picture: np.ndarray) -> str:
    """Return width x height, such as 640 x 480."""
    return f"{picture.shape[1]} x {picture.shape[0]}"
