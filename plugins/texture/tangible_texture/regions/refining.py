"""Regions found on a coarse grid, to the pixel."""

import numpy as np
from jaxtyping import Bool, Float32, Int32

from .borders import ACROSS, DOWN
from .watershed import UNSEEN, watershed


def refine_labels(
    labels: Int32[np.ndarray, "r c"], step: int, height: Float32[np.ndarray, "h w"]
) -> Int32[np.ndarray, "h w"]:
    """Labels of every step-th pixel as labels of every pixel: the cells beside borders are flooded anew, from within.

    Parameters: height >= 0, whose crests are where borders belong.
    """
    rows, columns = height.shape
    markers = np.where(_inside(labels), labels, np.int32(UNSEEN))
    return watershed(height, markers.repeat(step, axis=0)[:rows].repeat(step, axis=1)[:, :columns])


def _inside(labels: Int32[np.ndarray, "r c"]) -> Bool[np.ndarray, "r c"]:
    """Where all 4 neighbours have the same label; all of a region that is too narrow to have such a place."""
    inside = np.ones(labels.shape, np.bool_)
    for first, second in (DOWN, ACROSS):
        same = labels[first] == labels[second]
        inside[first] &= same
        inside[second] &= same
    kept = np.bincount(labels[inside], minlength=int(labels.max()) + 1) > 0
    return inside if kept.all() else inside | ~kept[labels]
