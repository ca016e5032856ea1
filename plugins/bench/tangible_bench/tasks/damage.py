"""Controlled damage to pictures: each function returns uint8, (h, w) or (h, w, 3); transparency is dropped."""

import numpy as np
from jaxtyping import UInt8

from tangible_core.data.pictures import full_scale
from tangible_core.runtime.opencv import plain_opencv

Bytes = UInt8[np.ndarray, "..."]


def noise(picture: np.ndarray, sd: float, seed: int) -> Bytes:
    """White Gaussian noise, independent in each channel; sd in grey levels of 255."""
    values = grey_levels(picture)
    return rounded(values + np.random.default_rng(seed).normal(0, sd, values.shape))


def gain(picture: np.ndarray, factor: float) -> Bytes:
    """Another exposure: every value times `factor`."""
    return rounded(grey_levels(picture) * factor)


def offset(picture: np.ndarray, levels: float) -> Bytes:
    """More light everywhere, or less: so many grey levels of 255 are added."""
    return rounded(grey_levels(picture) + levels)


def light(picture: np.ndarray, share: float) -> Bytes:
    """Light from one side: every value times 1 - share at the left border, rising to 1 + share at the right one."""
    values = grey_levels(picture)
    slope = np.linspace(1 - share, 1 + share, values.shape[1])
    return rounded(values * (slope if values.ndim == 2 else slope[:, None]))


def gamma(picture: np.ndarray, exponent: float) -> Bytes:
    """Another tone curve: (value / 255) ** exponent * 255."""
    return rounded(255 * (grey_levels(picture) / 255) ** exponent)


def jpeg(picture: np.ndarray, quality: float) -> Bytes:
    """There and back through JPEG at this quality, 1..100."""
    from io import BytesIO

    from PIL import Image

    file = BytesIO()
    Image.fromarray(rounded(grey_levels(picture))).save(file, "JPEG", quality=round(quality))
    return np.asarray(Image.open(file))


def blur(picture: np.ndarray, sigma_px: float) -> Bytes:
    """A Gaussian of this standard deviation, reflected at the borders."""
    import cv2

    with plain_opencv():
        return rounded(cv2.GaussianBlur(grey_levels(picture), (0, 0), sigma_px, borderType=cv2.BORDER_REFLECT))


def shift_down(picture: np.ndarray, rows_px: float) -> Bytes:
    """Moved down by a fraction of a pixel (up where negative), linear in between, the border row repeated."""
    values = grey_levels(picture)
    whole, part = divmod(-rows_px, 1)
    rows = np.arange(len(values), dtype=np.int64) + int(whole)
    upper, lower = (values.take(rows + step, axis=0, mode="clip") for step in (0, 1))
    return rounded((1 - part) * upper + part * lower)


def grey_levels(picture: np.ndarray) -> np.ndarray:
    """float64 (h, w) or (h, w, 3), 0..255."""
    colours = picture[..., :3] if picture.ndim == 3 else picture
    return np.clip(colours.astype(np.float64) * (255 / full_scale(picture)), 0, 255)


def rounded(values: np.ndarray) -> Bytes:
    """Grey levels as a picture holds them."""
    return np.rint(np.clip(values, 0, 255)).astype(np.uint8)
