"""Levels of detail: a grid at its size, at half of it, and so on, down to what a page draws at once."""

import numpy as np
from jaxtyping import Float32, Shaped

MOST_CELLS = 350_000
"""Size limit of the coarsest level, cells: software draws it in a fraction of a second; 640 x 480 is drawn as it is."""
MOST_SIDE = 4096
"""Greatest side of a level: every WebGL 2 has textures of this size."""


def count(shape: tuple[int, int]) -> int:
    """Return the number of levels of a grid of (rows, columns)."""
    levels = 1
    while shape[0] * shape[1] > MOST_CELLS or max(shape) > MOST_SIDE:
        shape, levels = (-(-shape[0] // 2), -(-shape[1] // 2)), levels + 1
    return levels


def means(values: Float32[np.ndarray, "h w"], levels: int) -> list[Float32[np.ndarray, "..."]]:
    """Return the levels of values: level k is the mean over blocks of 2^k x 2^k cells, smaller at the end."""
    found = [values]
    rows, columns = (np.ones(side) for side in values.shape)
    for _ in range(levels - 1):
        half = _halve_rows(_halve_rows(found[-1], rows).T, columns).T
        found.append(np.ascontiguousarray(half))
        rows, columns = _pair_weights(rows), _pair_weights(columns)
    return found


def middles(labels: Shaped[np.ndarray, "h w"], levels: int) -> list[Shaped[np.ndarray, "..."]]:
    """Return the levels of labels: level k has the label at the middle of each block of 2^k x 2^k cells."""
    found = [labels]
    for level in range(1, levels):
        step = 2**level
        places = (np.minimum(np.arange(0, side, step) + step // 2, side - 1) for side in labels.shape)
        found.append(labels[np.ix_(*places)])
    return found


def _halve_rows(values: Float32[np.ndarray, "h w"], weights: np.ndarray) -> Float32[np.ndarray, "n w"]:
    """Return weighted means of rows in pairs; a last row without a partner stays."""
    pairs = len(values) // 2
    found = values[0::2].copy()
    share = weights[1::2] / (weights[0::2][:pairs] + weights[1::2])
    found[:pairs] += (values[1::2] - values[0::2][:pairs]) * share[:, None].astype(np.float32)
    return found


def _pair_weights(weights: np.ndarray) -> np.ndarray:
    return np.add.reduceat(weights, np.arange(0, len(weights), 2))
