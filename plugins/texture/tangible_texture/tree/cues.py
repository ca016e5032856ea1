"""How strongly a picture changes at each cell, and in which direction: in brightness and in what windows hold."""

from collections.abc import Iterable, Mapping

import numpy as np
from jaxtyping import Float32

from tangible_core.compiled import KERNEL, in_turns, njit
from tangible_core.runtime import plain_opencv

from ..signal.smoothing import gaussian

FINE_CELLS = 0.6
"""The standard deviation of the window of the change of brightness, in cells."""
WINDOW_CELLS = 1.5
"""The standard deviation of the narrowest window of shares, in cells."""
LEVELS = 3
EMPTY = 1e-4
"""A share that is added to all: the square root of nearly nothing must not change fast."""

Tensors = Float32[np.ndarray, "cues 3 h w"]
"""The structure tensor of each cue at each cell: across-across, across-down, down-down."""


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
    import cv2

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
    """Add the outer product of central differences; the border is repeated."""
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
