"""Materials as pages have them: each once, and the index of each label's."""

from collections.abc import Sequence

import numpy as np

from tangible_core.data import Material


def distinct_materials(materials: Sequence[Material]) -> tuple[list[Material], np.ndarray]:
    """Return the distinct materials, and the index of each label's material among them, (labels,) uint16."""
    places = {fromkey: place for place, fromkey in enumerate(dict.fromkeys(materials))}
    return list(places), np.array([places[material] for material in materials], "<u2")
