"""Regions of cells refined to the pixel."""

import numpy as np
from jaxtyping import Float32, Int32

from ..regions.refining import refine_labels
from ..signal.slopes import slopes
from ..signal.smoothing import gaussian

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
