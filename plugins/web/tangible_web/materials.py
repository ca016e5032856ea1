"""A surface and its materials as pages have them."""

from collections.abc import Sequence
from typing import Any

import numpy as np

from tangible_core.data import Material


def distinct_materials(materials: Sequence[Material]) -> tuple[list[Material], np.ndarray]:
    """Return the distinct materials, and the index of each label's material among them, (labels,) uint16."""
    places = {material: place for place, material in enumerate(dict.fromkeys(materials))}
    return list(places), np.array([places[material] for material in materials], "<u2")


def surface_facts(
    digest: str,
    name: str,
    height_m: np.ndarray,
    extent_m: tuple[float, float],
    labels: np.ndarray | None,
    materials: list[dict[str, Any]],
    **more: Any,
) -> dict[str, Any]:
    """Return the facts of a surface, by default of one level, without parts, picture and layers."""
    rows, columns = height_m.shape
    facts = {
        "digest": digest,
        "name": name,
        "shows": "surface",
        "rows": rows,
        "columns": columns,
        "extent_m": list(extent_m),
        "height_m": [float(height_m.min()), float(height_m.max())],
        "levels": [{"step": 1, "rows": rows, "columns": columns}],
        "labels": 0 if labels is None else int(labels.max()) + 1,
        "label_bytes": 2,
        "materials": materials,
        "parts": None,
        "photo": False,
        "fine_photo": None,
        "layers": {},
    }
    return facts | more
