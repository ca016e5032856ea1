"""A picture reduced to cells, and what each cell holds: shares of brightness, colour, roughness and direction."""

from collections.abc import Mapping

import cv2
import numpy as np
from jaxtyping import Float32

from tangible_core.data import luma
from tangible_core.runtime import plain_opencv

from ..signal.smoothing import gaussian

CELLS = 40_000
"""The most cells of a picture, so that the same picture at another size has the same regions."""
BINS = 12
RANGES = {"brightness": (0.0, 1.0), "red": (-0.4, 0.4), "yellow": (-0.5, 0.5)}
"""Lowest and highest bin, as shares of the picture's range; symmetric, so that a negative has the same bins."""
ROUGH_BINS, ROUGHEST = 8, 0.8
RARE = 0.001
"""The share of the darkest and of the brightest values that the picture's range does not have to hold."""
WEAK = 0.02
"""The deviation or slope of brightness that is half way between smooth and rough."""
AROUND_CELLS = 2.0
"""The standard deviation of the window whose mean roughness is measured against, in cells."""

Plane = Float32[np.ndarray, "h w"]
Planes = Float32[np.ndarray, "d h w"]


def reduce_to_cells(paint: Float32[np.ndarray, "H W c"]) -> Float32[np.ndarray, "h w c"]:
    """Return means over equal cells, CELLS at most; a small picture has one cell a pixel."""
    rows, columns = paint.shape[:2]
    side = max(1.0, (rows * columns / CELLS) ** 0.5)
    size = max(1, round(columns / side)), max(1, round(rows / side))
    with plain_opencv():
        return cv2.resize(paint, size, interpolation=cv2.INTER_AREA).reshape(size[1], size[0], paint.shape[2])


def opponent_colours(cells: Float32[np.ndarray, "h w c"]) -> Planes | None:
    """Return brightness 0..1, red - green and both - blue, as shares of the picture's range; None if that is empty."""
    values = np.sort(cells, axis=None)
    rare = int(RARE * values.size)
    low, high = values[rare], values[-1 - rare]
    if not high > low:
        return None
    even = (cells - low) / (high - low)
    if cells.shape[2] == 1:
        return np.stack([even[..., 0], np.zeros_like(even[..., 0]), np.zeros_like(even[..., 0])])
    red, green, blue = np.moveaxis(even, 2, 0)
    return np.stack([luma(even), red - green, (red + green) / 2 - blue])


def shares(colours: Planes) -> Mapping[str, Float32[np.ndarray, "_ h w"]]:
    """Return how much of each kind a cell holds: soft histograms of one value, whose shares sum to 1 in every cell."""
    kinds = {name: _bins(plane, *RANGES[name], BINS) for name, plane in zip(RANGES, colours, strict=True)}
    apart = np.abs(colours[0] - gaussian(colours[0], AROUND_CELLS))
    rough = gaussian(apart / (apart + np.float32(WEAK)), 0.7)
    with plain_opencv():
        across, down = (cv2.Sobel(colours[0], cv2.CV_32F, *order, scale=1 / 8) for order in ((1, 0), (0, 1)))
    return {**kinds, "roughness": _bins(rough, 0, ROUGHEST, ROUGH_BINS), "direction": _directions(across, down)}


def _bins(plane: Plane, low: float, high: float, count: int) -> Planes:
    """Divide each value between the two bins that it lies between, by its distance from their centres."""
    at = np.clip((plane - np.float32(low)) * np.float32((count - 1) / (high - low)), 0, np.float32(count - 1))
    return np.maximum(0, 1 - np.abs(at - np.arange(count, dtype=np.float32)[:, None, None]))


def _directions(across: Plane, down: Plane) -> Planes:
    """Return the shares of four directions of the slope, 45 degrees apart, and of no slope."""
    square = across * across + down * down
    steep = np.sqrt(square)
    steep = steep / (steep + np.float32(WEAK))
    least = np.float32(1e-12)
    # The squares of the positive parts of cos 2t, -cos 2t, sin 2t and -sin 2t sum to 1 for every angle t.
    cosine, sine = (across * across - down * down) / (square + least), 2 * across * down / (square + least)
    ways = [steep * np.square(np.maximum(part, 0)) for part in (cosine, -cosine, sine, -sine)]
    return np.stack([*ways, 1 - steep])
