"""Refining of regions to the pixel, and removal of small parts and of seams between two textures."""

import cv2
import numpy as np
from jaxtyping import Bool, Float32, Int32, Int64

from ..signal.smoothing import gaussian, slopes
from .borders import ACROSS, DOWN
from .watershed import UNSEEN, watershed

# The standard deviation of the Gaussian before slopes of pixels are measured, in sides of a cell.
FINE = 0.35


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


def remove_seams(
    labels: Int32[np.ndarray, "rows columns"], radius: int
) -> tuple[Int32[np.ndarray, "rows columns"], Bool[np.ndarray, "rows columns"]]:
    """Give parts too narrow for a disc of this radius to the nearest wide segment; return the unchanged cells too."""
    from scipy.ndimage import distance_transform_edt

    disc = cv2.getStructuringElement(cv2.MORPH_ELLIPSE, (2 * radius + 1, 2 * radius + 1))
    frame = np.pad(labels, 2 * radius, mode="symmetric")
    inner = tuple(slice(2 * radius, 2 * radius + side) for side in labels.shape)
    wide = np.zeros(labels.shape, np.bool_)
    for label in range(int(labels.max()) + 1):
        wide |= cv2.morphologyEx((frame == label).astype(np.uint8), cv2.MORPH_OPEN, disc)[inner] > 0
    if not wide.any():
        return labels, ~wide
    nearest = distance_transform_edt(~wide, return_distances=False, return_indices=True)
    _, numbers = np.unique(labels[tuple(np.asarray(nearest))], return_inverse=True)
    return numbers.reshape(labels.shape).astype(np.int32), wide


def remove_small_parts(
    classes: Int32[np.ndarray, "h w"], steep: Float32[np.ndarray, "h w"], flat: float, smallest_px: int
) -> Int32[np.ndarray, "h w"]:
    """Give parts (4 neighbours) of fewer flat pixels to the adjacent classes, up to the steepest pixels in between."""
    # An edge from dark to bright is not a segment of grey: pixels steeper than `flat` are in no part.
    markers = np.full(classes.shape, UNSEEN, np.int32)
    for label in range(int(classes.max()) + 1):
        _add_large_parts(markers, (classes == label) & (steep <= flat), label, smallest_px)
    if markers.max() == UNSEEN:
        return np.zeros_like(classes)
    return watershed(steep, markers)


def _add_large_parts(markers: Int32[np.ndarray, "h w"], mask: np.ndarray, label: int, smallest_px: int) -> None:
    count, parts = cv2.connectedComponents(mask.view(np.uint8), connectivity=4)
    numbers = np.asarray(parts, np.int32)
    large = np.bincount(numbers.ravel(), minlength=count) >= smallest_px
    large[0] = False
    markers[large[numbers]] = label
