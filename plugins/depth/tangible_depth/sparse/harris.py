"""Harris corners and edges, the features that are matched (Harris & Stephens 1988)."""

from math import exp

import cv2
import numpy as np
from jaxtyping import Float, Float64, Int64

from tangible_core.runtime import plain_opencv


def gaussian_window(sigma_px: float) -> Float64[np.ndarray, "n"]:
    """Compute exp(-u^2 / (2 sigma^2)) out to three sigma, scaled to sum to one; w(u, v) is the product of two."""
    reach = int(np.ceil(3 * sigma_px))
    weights = np.array([exp(-0.5 * (at / sigma_px) ** 2) for at in range(-reach, reach + 1)])
    return weights / weights.sum()


def harris_response(
    grey: Float[np.ndarray, "h w"], window: np.ndarray | None = None, k: float = 0.04
) -> Float[np.ndarray, "h w"]:
    """Compute R = det M - k (tr M)^2 of every pixel in the picture's float type; window: weights along one axis."""
    # R > 0 at a corner, < 0 along an edge, near 0 where flat; a picture multiplied by c has R multiplied by c^4.
    weights = gaussian_window(1.0) if window is None else window
    slope, one = np.array([-1.0, 0.0, 1.0]), np.ones(1)
    with plain_opencv():
        x = cv2.sepFilter2D(grey, -1, slope, one, borderType=cv2.BORDER_REFLECT_101)
        y = cv2.sepFilter2D(grey, -1, one, slope, borderType=cv2.BORDER_REFLECT_101)
        a, b, c = (
            cv2.sepFilter2D(product, -1, weights, weights, borderType=cv2.BORDER_REFLECT_101)
            for product in (x * x, y * y, x * y)
        )
    trace = a + b
    return a * b - c * c - k * trace * trace


def corners(response: Float[np.ndarray, "h w"], least: float, most: int) -> Int64[np.ndarray, "n 2"]:
    """Find at most `most` corners as (column, row), strongest first: R over `least` and largest of its 3 x 3 pixels."""
    peak = (response > least) & (response >= cv2.dilate(response, np.ones((3, 3), np.uint8)))
    rows, columns = np.nonzero(peak)
    order = np.argsort(-response[rows, columns], kind="stable")[:most]
    return np.column_stack([columns[order], rows[order]])


def row_edges(response: Float[np.ndarray, "h w"], least: float) -> Int64[np.ndarray, "n 2"]:
    """Find edges across rows, as (column, row) in reading order: R is under -least and lowest among its neighbours."""
    # An edge along a row cannot be located by a search along rows.
    beside = np.pad(response, ((0, 0), (1, 1)), constant_values=np.inf)
    valley = (response < -least) & (response <= beside[:, :-2]) & (response < beside[:, 2:])
    rows, columns = np.nonzero(valley)
    return np.column_stack([columns, rows])


def least_response(contrast: float, k: float = 0.04) -> float:
    """Return the |R| of an edge whose slope is `contrast` grey levels a pixel, to tell features from noise."""
    # A ramp of slope g has X = 2 g.
    return k * (2 * contrast) ** 4
