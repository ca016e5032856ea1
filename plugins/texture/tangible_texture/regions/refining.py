"""Refining of regions from a coarse grid to the pixel."""

import numpy as np
from jaxtyping import Bool, Float32, Int32, Int64

from ..signal.slopes import slopes
from ..signal.smoothing import gaussian
from .borders import ACROSS, DOWN
from .watershed import UNSEEN, watershed

FINE = 0.35
"""The standard deviation of the Gaussian before slopes of pixels are measured, in sides of a cell."""


def refine_regions(
    cells: Int32[np.ndarray, "r c"], paint: Float32[np.ndarray, "h w channels"]
) -> Int32[np.ndarray, "h w"]:
    """Flood the cells along borders again, pixel by pixel, up to the steepest slopes of any channel."""
    shape = paint.shape[:2]
    if cells.shape == shape:
        return cells
    sigma_px = FINE * shape[0] / cells.shape[0]
    steep = np.zeros(shape, np.float32)
    for channel in range(paint.shape[2]):
        smooth = gaussian(np.ascontiguousarray(paint[..., channel : channel + 1]), sigma_px)
        np.maximum(steep, slopes(smooth)[0], out=steep)
    rows, columns = (np.arange(side) * cell // side for side, cell in zip(shape, cells.shape, strict=True))
    return refine_labels(cells, rows, columns, steep)


def refine_labels(
    labels: Int32[np.ndarray, "r c"],
    rows: Int64[np.ndarray, "h"],
    columns: Int64[np.ndarray, "w"],
    height: Float32[np.ndarray, "h w"],
) -> Int32[np.ndarray, "h w"]:
    """Refine labels of cells to labels of pixels: cells along borders are flooded again, up to the crests of height."""
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
