"""A small picture of a scene: what was seen, and what is felt. A whole sheet takes ten times as long as the making."""

import io
from pathlib import Path

import numpy as np
from jaxtyping import UInt8

from ..data.pictures import to_rgb8
from ..files.writing import atomic_write
from ..pipeline.pipeline import Pipeline
from ..runtime.opencv import plain_opencv

CARD = "card.jpg"
SIDE_PX = 160
LIGHT = np.array([-1.0, 1.0, 1.2])
"""From the upper left, as maps are lit."""


def write_card(pipeline: Pipeline, folder: Path) -> str:
    """Write the picture and the lit relief beside each other; the name of the file. Raises: OutputError."""
    from PIL import Image

    parts = [_lit(pipeline.relief.height_m, pipeline.relief.pitch_m)]
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
