"""A picture reduced to cells, what each of them holds, and how strongly that changes there, by direction."""

from collections.abc import Iterable, Mapping

import cv2
import numpy as np
from jaxtyping import Float32

from tangible_core.compiled import KERNEL, in_turns, njit
from tangible_core.data import luma
from tangible_core.runtime import plain_opencv

from ..signal.smoothing import gaussian

# The most cells of a picture, so that the same picture at another size has the same regions.
CELLS = 40_000
BINS = 12
# Lowest and highest bin, as shares of the picture's range; symmetric, so that a negative has the same bins.
RANGES = {"brightness": (0.0, 1.0), "red": (-0.4, 0.4), "yellow": (-0.5, 0.5)}
ROUGH_BINS, ROUGHEST = 8, 0.8
# The share of the darkest and of the brightest values that the picture's range does not have to hold.
RARE = 0.001
WEAK = 0.02  # the deviation or slope of brightness that is half way between smooth and rough
# The standard deviation of the window whose mean roughness is measured against, in cells.
AROUND_CELLS = 2.0

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


FINE_CELLS = 0.6
WINDOW_CELLS = 1.5
LEVELS = 3
# A share that is added to all: the square root of nearly nothing must not change fast.
EMPTY = 1e-4

# The structure tensor of each cue at each cell: across-across, across-down, down-down.
Tensors = Float32[np.ndarray, "cues 3 h w"]


def tensors(brightness: Float32[np.ndarray, "h w"], shares: Mapping[str, Float32[np.ndarray, "_ h w"]]) -> Tensors:
    """Compute the tensors of brightness, and of each kind of shares in windows of LEVELS widths."""
    # A change of several planes has a structure tensor, the sum of the outer products of their gradients: its largest
    # eigenvalue is the square of the steepest change, and n' T n that of the change along n (Di Zenzo, CVGIP 33, 1986).
    # Gradients of square roots of shares measure Hellinger's distance between the windows on both sides (Martin,
    # Fowlkes & Malik, IEEE TPAMI 26, 2004).
    result = np.zeros((1 + LEVELS * len(shares), 3, *brightness.shape), np.float32)

    @plain_opencv()
    def work(kinds: Iterable[tuple[int, np.ndarray]]) -> None:
        for at, planes in kinds:
            _add_windows(planes, result[1 + LEVELS * at :][:LEVELS])

    in_turns(list(enumerate(shares.values())), work)
    _add_outer(gaussian(brightness, FINE_CELLS), result[0])
    return result


def _add_windows(planes: Float32[np.ndarray, "d h w"], result: Float32[np.ndarray, "levels 3 h w"]) -> None:
    for level in range(LEVELS):
        if level:
            size = (planes.shape[2] + 1) // 2, (planes.shape[1] + 1) // 2
            planes = np.stack([cv2.resize(plane, size, interpolation=cv2.INTER_AREA) for plane in planes])
        tensor = np.zeros((3, *planes.shape[1:]), np.float32)
        for plane in planes:
            _add_outer(np.sqrt(gaussian(plane, WINDOW_CELLS) + np.float32(EMPTY)), tensor)
        for at in range(3):
            result[level, at] = cv2.resize(tensor[at], result.shape[:1:-1], interpolation=cv2.INTER_LINEAR)


def weighted_strength(tensors: Tensors, weights: Float32[np.ndarray, "cues"]) -> Float32[np.ndarray, "h w"]:
    """Return the sum over cues of a weight times the square root of the steepest change."""
    result = np.zeros(tensors.shape[2:], np.float32)
    _add_strengths(tensors.reshape(*tensors.shape[:2], -1), weights, result.reshape(-1))
    return result


def border_tensors(borders: Float32[np.ndarray, "h w"]) -> Tensors:
    """Return the tensors of a map of borders, 0..1, whose strengths are the map and its square in every direction."""
    result = np.zeros((2, 3, *borders.shape), np.float32)
    result[:, ::2] = np.stack([borders**4, borders**8])[:, None]
    return result


@njit(**KERNEL)
def _add_outer(plane, tensor):
    rows, columns = plane.shape
    half = np.float32(0.5)
    for row in range(rows):
        above, below = max(row - 1, 0), min(row + 1, rows - 1)
        for column in range(columns):
            across = half * (plane[row, min(column + 1, columns - 1)] - plane[row, max(column - 1, 0)])
            down = half * (plane[below, column] - plane[above, column])
            tensor[0, row, column] += across * across
            tensor[1, row, column] += across * down
            tensor[2, row, column] += down * down


@njit(**KERNEL)
def _add_strengths(tensors, weights, result):
    half = np.float32(0.5)
    for cue in range(len(tensors)):
        weight = weights[cue]
        for at in range(result.size):
            xx, xy, yy = tensors[cue, 0, at], tensors[cue, 1, at], tensors[cue, 2, at]
            apart = half * (xx - yy)
            largest = half * (xx + yy) + np.sqrt(apart * apart + xy * xy)
            result[at] += weight * np.sqrt(np.sqrt(largest))
