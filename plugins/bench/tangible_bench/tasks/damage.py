"""Controlled damage to pictures; each function returns uint8, (h, w) or (h, w, 3), without transparency."""

import numpy as np
from jaxtyping import UInt8

from tangible_core.data import full_scale
from tangible_core.runtime import plain_opencv

Bytes = UInt8[np.ndarray, "..."]


def noise(picture: np.ndarray, sd: float, seed: int) -> Bytes:
    """Add white Gaussian noise, independent in each channel. sd: standard deviation, grey levels of 255."""
    values = grey_levels(picture)
    return round_levels(values + np.random.default_rng(seed).normal(0, sd, values.shape))


def gain(picture: np.ndarray, factor: float) -> Bytes:
    """Change the exposure: multiply every value by `factor`."""
    return round_levels(grey_levels(picture) * factor)


def offset(picture: np.ndarray, levels: float) -> Bytes:
    """Change the brightness: add grey levels of 255."""
    return round_levels(grey_levels(picture) + levels)


def light(picture: np.ndarray, share: float) -> Bytes:
    """Light the picture from one side: multiply by 1 - share at the left border, rising to 1 + share at the right."""
    values = grey_levels(picture)
    slope = np.linspace(1 - share, 1 + share, values.shape[1])
    return round_levels(values * (slope if values.ndim == 2 else slope[:, None]))


def gamma(picture: np.ndarray, exponent: float) -> Bytes:
    """Change the tone curve to (value / 255) ** exponent * 255."""
    return round_levels(255 * (grey_levels(picture) / 255) ** exponent)


def jpeg(picture: np.ndarray, quality: float) -> Bytes:
    """Compress the picture as JPEG and read it again. quality: 1 to 100."""
    from io import BytesIO

    from PIL import Image

    file = BytesIO()
    Image.fromarray(round_levels(grey_levels(picture))).save(file, "JPEG", quality=round(quality))
    return np.asarray(Image.open(file))


def blur(picture: np.ndarray, sigma_px: float) -> Bytes:
    """Blur with a Gaussian of this standard deviation, reflected at the borders."""
    import cv2

    with plain_opencv():
        return round_levels(cv2.GaussianBlur(grey_levels(picture), (0, 0), sigma_px, borderType=cv2.BORDER_REFLECT))


def shift_down(picture: np.ndarray, rows_px: float) -> Bytes:
    """Move the picture down (up if negative) with linear interpolation; the border row is repeated."""
    values = grey_levels(picture)
    whole, part = divmod(-rows_px, 1)
    rows = np.arange(len(values), dtype=np.int64) + int(whole)
    upper, lower = (values.take(rows + step, axis=0, mode="clip") for step in (0, 1))
    return round_levels((1 - part) * upper + part * lower)


def grey_levels(picture: np.ndarray) -> np.ndarray:
    """Return grey levels as float64, (h, w) or (h, w, 3), 0 to 255."""
    colours = picture[..., :3] if picture.ndim == 3 else picture
    return np.clip(colours.astype(np.float64) * (255 / full_scale(picture)), 0, 255)


def round_levels(values: np.ndarray) -> Bytes:
    """Round grey levels to those of a picture."""
    return np.rint(np.clip(values, 0, 255)).astype(np.uint8)
