"""Refining of regions from a coarse grid to the pixel."""

import numpy as np
from jaxtyping import Bool, Float32, Int32

from .borders import ACROSS, DOWN
from .watershed import UNSEEN, watershed


def refine_labels(
    labels: Int32[np.ndarray, "r c"], step: int, height: Float32[np.ndarray, "h w"]
) -> Int32[np.ndarray, "h w"]:
    """Refine labels of every step-th pixel to labels of every pixel: cells along borders are flooded again from within.

    Parameters: height >= 0; borders belong on its crests.
    """
    rows, columns = height.shape
    markers = np.where(_inside(labels), labels, np.int32(UNSEEN))
    return watershed(height, markers.repeat(step, axis=0)[:rows].repeat(step, axis=1)[:, :columns])


def _inside(labels: Int32[np.ndarray, "r c"]) -> Bool[np.ndarray, "r c"]:
    """Return a mask of cells whose 4 neighbours have the same label, and of regions without any such cell."""
    inside = np.ones(labels.shape, np.bool_)
    for first, second in (DOWN, ACROSS):
        same = labels[first] == labels[second]
        inside[first] &= same
        inside[second] &= same
    has_inside = np.bincount(labels[inside], minlength=int(labels.max()) + 1) > 0
    return inside if has_inside.all() else inside | ~has_inside[labels]
