"""Geometric transforms of scenes with known segments: the true labels move with the pixels."""

from dataclasses import replace

import numpy as np
from jaxtyping import Float64

from tangible_core.runtime import plain_opencv
from tangible_core.testing.synthetic import KnownSegments, in_order

from .damage import grey_levels, round_levels

Places = Float64[np.ndarray, "2 h w"]
"""The (row, column) in the scene of each new pixel."""


def quarter(scene: KnownSegments, turns: float) -> KnownSegments:
    """Turn the scene by n right angles to the left; no value changes."""
    return replace(scene, picture=np.rot90(scene.picture, int(turns)), labels=np.rot90(scene.labels, int(turns)))


def flip(scene: KnownSegments, axis: float) -> KnownSegments:
    """Mirror the scene along an axis: 0 top for bottom, 1 left for right; no value changes."""
    return replace(scene, picture=np.flip(scene.picture, int(axis)), labels=np.flip(scene.labels, int(axis)))


def rotate(scene: KnownSegments, degrees: float) -> KnownSegments:
    """Turn the scene to the left about its centre, and crop it to a rectangle of the same proportions.

    The crop has no empty corners: a rectangle w x h turned by an angle needs w |cos| + h |sin| by w |sin| + h |cos|.
    """
    h, w = scene.labels.shape
    cos, sin = np.cos(np.radians(degrees)), np.sin(np.radians(degrees))
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
    import cv2

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
