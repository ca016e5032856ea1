"""A small picture of a scene: what was seen, and what was made. A whole sheet takes ten times as long as the making."""

import io
from pathlib import Path

import numpy as np
from jaxtyping import UInt8

from tangible_core.data.pictures import to_rgb8
from tangible_core.files.writing import atomic_write
from tangible_core.pipeline.pipeline import Pipeline
from tangible_core.runtime.opencv import plain_opencv

CARD = "card.jpg"
SIDE_PX = 160
LIGHT = np.array([-1.0, 1.0, 1.2])
"""From the upper left, as maps are lit."""


def write_card(pipeline: Pipeline, folder: Path) -> str:
    """Write the picture and what was made of it beside each other; the name of the file. Raises: OutputError."""
    from PIL import Image

    parts = [_made(pipeline)]
    if pipeline.views is not None:
        parts.insert(0, _small(to_rgb8(pipeline.views.left)))
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


def _made(pipeline: Pipeline) -> UInt8[np.ndarray, "r c 3"]:
    """What is wanted, where that is a map of the picture; else the relief."""
    want = pipeline.config.want
    if want in ("views", "disparity") and pipeline.disparity is not None:
        return _grey(pipeline.disparity.disparity_px)
    if want == "parts" and pipeline.parts is not None:
        return _grey(pipeline.parts.labels)
    if want in ("segments", "materials") and pipeline.segments is not None:
        return _grey(pipeline.segments.labels)
    return _lit(pipeline.relief.height_m, pipeline.relief.pitch_m)


def _grey(values: np.ndarray) -> UInt8[np.ndarray, "r c 3"]:
    """From the lowest, black, to the highest, white; what is unknown is black."""
    values = np.asarray(values, np.float32)
    known = np.isfinite(values)
    low, high = (float(values[known].min()), float(values[known].max())) if known.any() else (0.0, 0.0)
    share = np.where(known, (values - low) / max(high - low, 1e-9), 0).astype(np.float32)
    return np.repeat(np.rint(255 * np.clip(_small(share), 0, 1)).astype(np.uint8)[..., None], 3, axis=2)


def _small(picture: np.ndarray) -> np.ndarray:
    import cv2

    scale = SIDE_PX / max(picture.shape[:2])
    size = tuple(max(1, round(side * scale)) for side in picture.shape[1::-1])
    with plain_opencv():
        return cv2.resize(picture, (size[0], size[1]), interpolation=cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR)


def _lit(height_m: np.ndarray, pitch_m: tuple[float, float]) -> UInt8[np.ndarray, "r c 3"]:
    """As grey levels, lit from the upper left; 2 mm over 2 mm is half dark."""
    small = _small(np.asarray(height_m, np.float32))
    enlarged = height_m.shape[1] / small.shape[1]
    down, right = (
        np.gradient(small, axis=axis) / (pitch * enlarged) if small.shape[axis] > 1 else np.zeros_like(small)
        for axis, pitch in ((0, pitch_m[1]), (1, pitch_m[0]))
    )
    shade = (-right * LIGHT[0] + down * LIGHT[1] + LIGHT[2]) / np.sqrt(1 + right**2 + down**2) / np.linalg.norm(LIGHT)
    grey = np.rint(255 * np.clip(shade, 0, 1)).astype(np.uint8)
    return np.repeat(grey[..., None], 3, axis=2)
