"""The surface of an interval as a participant's page has it: without any name, so that it does not tell what it is."""

from base64 import b64encode
from dataclasses import asdict
from typing import Any

import numpy as np

from tangible_core.data import HapticSurface
from tangible_core.scene import middle_pixels, reduced_map, reduced_shape

MAX_CELLS = 200_000
"""The most cells: the page draws nothing, and needs heights only to hold the hand over the surface."""


def surface_for_page(surface: HapticSurface, number: int) -> dict[str, Any]:
    """Return heights, labels and materials as JSON data. number: of the surface in this session."""
    shape = reduced_shape(surface.height_m.shape, max(1.0, (surface.height_m.size / MAX_CELLS) ** 0.5))
    height_m = np.ascontiguousarray(reduced_map(surface.height_m, shape), "<f4")
    labels = None if surface.labels is None else middle_pixels(surface.labels, shape)
    materials = [{**asdict(material), "name": ""} for material in surface.materials or ()] if labels is not None else []
    meta = {
        "digest": str(number),
        "name": "",
        "shows": "surface",
        "rows": shape[0],
        "columns": shape[1],
        "extent_m": list(surface.extent_m),
        "height_m": [float(height_m.min()), float(height_m.max())],
        "levels": [{"step": 1, "rows": shape[0], "columns": shape[1]}],
        "labels": 0 if labels is None else int(labels.max()) + 1,
        "label_bytes": 2,
        "materials": materials,
        "parts": None,
        "photo": False,
        "fine_photo": None,
        "layers": {},
    }
    return {
        "meta": meta,
        "heights": b64encode(height_m.tobytes()).decode(),
        "labels": "" if labels is None else b64encode(labels.astype("<u2").tobytes()).decode(),
        "kinds": list(range(len(materials))),
    }
