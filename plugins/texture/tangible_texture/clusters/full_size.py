"""Labels of pixels from classes of cells: evidence in wide and narrow windows, neighbours, then interpolation."""

import cv2
import numpy as np
from jaxtyping import Float32, Int32

from tangible_core.compiled import exponential, in_blocks, logarithms, njit
from tangible_core.runtime import plain_opencv

from ..features.features import Window
from .discriminants import evidence, one_hot, scatters
from .neighbourhood import EVIDENCE, mean_field

NARROW = 0.6
SURE = 1e-6  # the least membership, so that its logarithm stays finite


def fine_memberships(
    wide: Window, labels: Int32[np.ndarray, "m"], narrow: Window
) -> Float32[np.ndarray, "k rows columns"]:
    """Compute the membership of each narrow cell in each class of wide cells, from both windows and its neighbours."""
    own = one_hot(labels, int(labels.max()) + 1)
    towards = resize_planes(evidence(wide.planes, scatters(wide.planes, own)), wide.shape, narrow.shape)
    soft = resize_planes(own, wide.shape, narrow.shape)
    near = evidence(narrow.planes, scatters(narrow.planes, one_hot(soft.argmax(axis=0), len(own))))
    both = np.float32(EVIDENCE * NARROW) * near + np.float32(EVIDENCE * (1 - NARROW)) * towards
    return mean_field(both, soft, narrow.shape, 2.0, 4).reshape(-1, *narrow.shape)


def resize_planes(planes: Float32[np.ndarray, "k m"], shape: tuple[int, int], to: tuple[int, int]) -> np.ndarray:
    """Interpolate planes of cells between the centres of a coarse grid: (k, n)."""
    with plain_opencv():
        return np.stack(
            [cv2.resize(plane.reshape(shape), to[::-1], interpolation=cv2.INTER_LINEAR).ravel() for plane in planes]
        )


def pixel_labels(
    memberships: Float32[np.ndarray, "k rows columns"], cell_px: int, shape: tuple[int, int]
) -> tuple[Int32[np.ndarray, "h w"], Float32[np.ndarray, "h w"]]:
    """Return the strongest class of each pixel, and 1 - q / p of its membership p and the second strongest q."""
    labels, confidence = np.empty(shape, np.int32), np.empty(shape, np.float32)
    # Logarithms are interpolated between the centres of cells.
    logs = logarithms(np.maximum(memberships, np.float32(SURE)))
    in_blocks(shape[0], lambda start, stop: _fill(logs, cell_px, start, stop, labels, confidence))
    return labels, confidence


@njit(cache=True, nogil=True)
def _fill(logs, cell_px, start, stop, labels, confidence):
    classes, rows, columns = logs.shape
    width = labels.shape[1]
    between, wide = np.empty(columns, np.float32), np.empty(width)
    best, second, at = np.empty(width), np.empty(width), np.empty(width, np.int32)
    left, right = np.empty(width, np.int64), np.empty(width)
    for column in range(width):
        left[column], right[column] = _place(column, cell_px, columns)
    for row in range(start, stop):
        above, down = _place(row, cell_px, rows)
        below = min(above + 1, rows - 1)
        best[:], second[:], at[:] = -np.inf, -np.inf, 0
        # Class by class, so that each inner loop runs along memory; the best two of each pixel are all that is kept.
        for k in range(classes):
            for cell in range(columns):
                between[cell] = logs[k, above, cell] + down * (logs[k, below, cell] - logs[k, above, cell])
            for column in range(width):
                one, other = between[left[column]], between[min(left[column] + 1, columns - 1)]
                wide[column] = one + right[column] * (other - one)
            for column in range(width):
                value, most = wide[column], best[column]
                second[column] = max(second[column], min(value, most))
                at[column] = k if value > most else at[column]
                best[column] = max(value, most)
        for column in range(width):
            labels[row, column] = at[column]
            confidence[row, column] = np.float32(1) - exponential(second[column] - best[column])


@njit(cache=True, nogil=True)
def _place(pixel, cell_px, cells):
    """Return the cell whose centre is at or before a pixel, and the pixel's offset from it, 0..1 of a cell."""
    at = min(max((pixel + np.float32(0.5)) / cell_px - np.float32(0.5), np.float32(0)), np.float32(cells - 1))
    before = int(at)
    return before, at - np.float32(before)
