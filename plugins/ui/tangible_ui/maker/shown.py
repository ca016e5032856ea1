"""A surface as pages fetch it: raw arrays in files named by content."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from tangible_core.data import HapticSurface
from tangible_core.data.pictures import to_grey
from tangible_core.pipeline.pipeline import Pipeline


def show(pipeline: Pipeline, surface: HapticSurface, digest: str, folder: Path) -> dict[str, Any]:
    """Write what pages draw, and return what they need to know of it."""
    at = folder / digest
    at.mkdir(exist_ok=True)
    rows, columns = surface.height_m.shape
    (at / "height.f32").write_bytes(np.ascontiguousarray(surface.height_m, "<f4").tobytes())
    labels = surface.labels if surface.labels is not None else np.zeros((rows, columns), np.int32)
    (at / "labels.u16").write_bytes(labels.astype("<u2").tobytes())
    _write_photo(pipeline, at / "photo.jpg")
    return {
        "digest": digest,
        "name": pipeline.scene.name,
        "rows": rows,
        "columns": columns,
        "extent_m": list(surface.extent_m),
        "height_m": [float(surface.height_m.min()), float(surface.height_m.max())],
        "materials": [asdict(each) for each in surface.materials or ()],
        "photo": pipeline.scene.views is not None,
    }


def _write_photo(pipeline: Pipeline, path: Path) -> None:
    views = pipeline.scene.views
    if views is None:
        return
    picture = views.left
    if picture.dtype != np.uint8:
        picture = np.round(255 * np.clip(to_grey(picture), 0, 1)).astype(np.uint8)
    Image.fromarray(picture).convert("RGB").save(path, quality=88)
