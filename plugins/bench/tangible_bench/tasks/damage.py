"""Controlled damage to pictures, uint8, (h, w) or (h, w, 3); and transforms of scenes, labels and all."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float64, UInt8

from tangible_core.data import full_scale
from tangible_core.runtime import cv2, plain_opencv
from tangible_core.testing.synthetic import KnownSegments, in_order

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


Places = Float64[np.ndarray, "2 h w"]  # the (row, column) in the scene of each new pixel


def quarter(scene: KnownSegments, turns: float) -> KnownSegments:
    """Turn the scene by n right angles to the left; no value changes."""
    return replace(scene, picture=np.rot90(scene.picture, int(turns)), labels=np.rot90(scene.labels, int(turns)))


def flip(scene: KnownSegments, axis: float) -> KnownSegments:
    """Mirror the scene along an axis: 0 top for bottom, 1 left for right; no value changes."""
    return replace(scene, picture=np.flip(scene.picture, int(axis)), labels=np.flip(scene.labels, int(axis)))


def rotate(scene: KnownSegments, degrees: float) -> KnownSegments:
    """Turn the scene to the left about its centre, and crop it to a rectangle of the same proportions."""
    h, w = scene.labels.shape
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
    # Without empty corners: a rectangle w x h that is turned needs w |cos| + h |sin| by w |sin| + h |cos|.
    share = min(w / (w * abs(cos) + h * abs(sin)), h / (w * abs(sin) + h * abs(cos)))
    rows, columns = _from_centre((max(1, int(h * share)), max(1, int(w * share))))
    return _sample(scene, np.stack([cos * rows + sin * columns, cos * columns - sin * rows]))


def scale(scene: KnownSegments, factor: float) -> KnownSegments:
    """Scale the scene; before it gets smaller it is blurred, against aliasing."""
    h, w = scene.labels.shape
    places = _from_centre((max(1, round(h * factor)), max(1, round(w * factor)))) / factor
    return _sample(scene, places, blur_px=0.5 * np.sqrt(max(0.0, 1 / factor**2 - 1)))


def _from_centre(shape: tuple[int, int]) -> Places:
    """Return the row and column of each pixel, 0 in the middle of the picture."""
    return np.indices(shape, np.float64) - (np.reshape(shape, (2, 1, 1)) - 1) / 2


def _sample(scene: KnownSegments, places: Places, blur_px: float = 0.0) -> KnownSegments:
    """Sample a scene at places from its centre: the picture bicubic, mirrored at the border; labels the nearest."""
    h, w = scene.labels.shape
    rows, columns = places + (np.reshape((h, w), (2, 1, 1)) - 1) / 2
    values = grey_levels(scene.picture).astype(np.float32)
    across, down = columns.astype(np.float32), rows.astype(np.float32)
    with plain_opencv():
        if blur_px:
            values = cv2.GaussianBlur(values, (0, 0), blur_px, borderType=cv2.BORDER_REFLECT)
        picture = cv2.remap(values, across, down, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REFLECT)
    nearest = (np.rint(rows).clip(0, h - 1).astype(np.int64), np.rint(columns).clip(0, w - 1).astype(np.int64))
    return KnownSegments(round_levels(picture), in_order(scene.labels[nearest]))
