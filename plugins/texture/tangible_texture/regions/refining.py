"""Refining of regions from a coarse grid to the pixel."""

import numpy as np
from jaxtyping import Bool, Float32, Int32, Int64

from .borders import ACROSS, DOWN
from .watershed import UNSEEN, watershed


def refine_labels(
    labels: Int32[np.ndarray, "r c"],
    rows: Int64[np.ndarray, "h"],
    columns: Int64[np.ndarray, "w"],
    height: Float32[np.ndarray, "h w"],
) -> Int32[np.ndarray, "h w"]:
    """Refine labels of cells to labels of pixels: cells along borders are flooded again from within.

    Parameters: the row and the column of cells that each row and column of pixels lies in; height >= 0: borders belong
    on its crests.
    """
    inside = inner_cells(labels)
    has_inside = np.bincount(labels[inside], minlength=int(labels.max()) + 1) > 0
    markers = np.where(inside | ~has_inside[labels], labels, np.int32(UNSEEN))
    return watershed(height, markers[np.ix_(rows, columns)])


def inner_cells(labels: Int32[np.ndarray, "r c"]) -> Bool[np.ndarray, "r c"]:
    """Return a mask of the cells whose 4 neighbours have the same label."""
    inside = np.ones(labels.shape, np.bool_)
    for first, second in (DOWN, ACROSS):
        same = labels[first] == labels[second]
        inside[first] &= same
        inside[second] &= same
    return inside
