"""The card of a scene: a small picture of its input and its product, as a whole sheet takes ten times as long."""

import io
from pathlib import Path

import numpy as np
from jaxtyping import UInt8

from tangible_core.data import to_rgb8
from tangible_core.files import atomic_write
from tangible_core.pipeline import Pipeline
from tangible_core.runtime import plain_opencv

CARD = "card.jpg"
SIDE_PX = 160
LIGHT = np.array([-1.0, 1.0, 1.2])
"""The direction to the light: from the upper left, as on maps."""


def write_card(pipeline: Pipeline, folder: Path) -> str:
    """Write the picture and its product next to each other; return the name of the file. Raises: OutputError."""
    from PIL import Image

    parts = [_draw_product(pipeline)]
    if pipeline.scene.views is not None:
        parts.insert(0, _resize(to_rgb8(pipeline.scene.views.left)))
    height = max(part.shape[0] for part in parts)
    whole = np.full((height, sum(part.shape[1] for part in parts), 3), 255, np.uint8)
    at = 0
    for part in parts:
        whole[: part.shape[0], at : at + part.shape[1]] = part
        at += part.shape[1]
    packed = io.BytesIO()
    Image.fromarray(whole).save(packed, "JPEG", quality=80)
    with atomic_write(folder / CARD) as file:
        file.write(packed.getvalue())
    return CARD


def _draw_product(pipeline: Pipeline) -> UInt8[np.ndarray, "r c 3"]:
    """Draw the wanted product if it is a map of the picture, or else the relief."""
    want = pipeline.config.want
    if want in ("views", "disparity") and pipeline.disparity is not None:
        return _grey(pipeline.disparity.disparity_px)
    if want == "parts" and (parts := pipeline.make(want)) is not None:
        return _grey(parts.labels)
    if want in ("segments", "materials") and pipeline.segments is not None:
        return _grey(pipeline.segments.labels)
    return _shade(pipeline.relief.height_m, pipeline.relief.pitch_m)


def _grey(values: np.ndarray) -> UInt8[np.ndarray, "r c 3"]:
    """Draw values in grey, from black for the lowest (and for unknown) to white for the highest."""
    values = np.asarray(values, np.float32)
    known = np.isfinite(values)
    low, high = (float(values[known].min()), float(values[known].max())) if known.any() else (0.0, 0.0)
    share = np.where(known, (values - low) / max(high - low, 1e-9), 0).astype(np.float32)
    return np.repeat(np.rint(255 * np.clip(_resize(share), 0, 1)).astype(np.uint8)[..., None], 3, axis=2)


def _resize(picture: np.ndarray) -> np.ndarray:
    import cv2

    scale = SIDE_PX / max(picture.shape[:2])
    size = tuple(max(1, round(side * scale)) for side in picture.shape[1::-1])
    with plain_opencv():
        return cv2.resize(picture, (size[0], size[1]), interpolation=cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR)


def _shade(height_m: np.ndarray, pitch_m: tuple[float, float]) -> UInt8[np.ndarray, "r c 3"]:
    """Shade heights as lit from the upper left."""
    small = _resize(np.asarray(height_m, np.float32))
    enlarged = height_m.shape[1] / small.shape[1]
    down, right = (
        np.gradient(small, axis=axis) / (pitch * enlarged) if small.shape[axis] > 1 else np.zeros_like(small)
        for axis, pitch in ((0, pitch_m[1]), (1, pitch_m[0]))
    )
    shade = (-right * LIGHT[0] + down * LIGHT[1] + LIGHT[2]) / np.sqrt(1 + right**2 + down**2) / np.linalg.norm(LIGHT)
    grey = np.rint(255 * np.clip(shade, 0, 1)).astype(np.uint8)
    return np.repeat(grey[..., None], 3, axis=2)
