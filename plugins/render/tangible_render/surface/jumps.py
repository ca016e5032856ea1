"""Detection of jumps in heights, and their easing, so that a cubic spline does not overshoot."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool, Float32, Float64

# Least ratio, at a jump, of the fourth difference to nearby second ones: 3 at a step, 2 at a kink, 0.6 on a wave.
JUMP = 1.5
BORDER_JUMP, BORDER_CELLS = 0.9, 12
"""The ratio at the border, where a step has 1, and the cells whose second differences it is compared with."""
# The largest fourth difference due to rounding in float32, as a share of the greatest height.
ROUNDING = 2.0**-17
# The neighbours of a jump that belong to it, in cells to each side: oblique edges jump a little in each row.
REACH = 2


def jumps(height_m: Float32[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    """Return a mask of the cells at steps, kinks, spikes and noise, where a spline would ring; not of long waves."""
    mask = np.zeros(height_m.shape, bool)
    with np.errstate(over="ignore", invalid="ignore"):
        rounding = ROUNDING * np.abs(height_m).max()
        for heights, at in ((height_m, mask), (height_m.T, mask.T)):
            for lines in _blocks(heights) if len(heights) > 2 * REACH else ():
                at[2:-2, lines] |= _exceed_nearby(np.diff(heights[:, lines], 2, axis=0), rounding)
    if not mask.any():
        return mask
    return _dilate(mask)


def _dilate(mask: Bool[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    """Return True within REACH rows and columns of a cell. (OpenCV would be half of a small installation.)"""
    rows = mask.copy()
    for reach in range(1, REACH + 1):
        rows[reach:] |= mask[:-reach]
        rows[:-reach] |= mask[reach:]
    wide = rows.copy()
    for reach in range(1, REACH + 1):
        wide[:, reach:] |= rows[:, :-reach]
        wide[:, :-reach] |= rows[:, reach:]
    return wide


def ease(values: Float64[np.ndarray, "h w"], at: Bool[np.ndarray, "h w"]) -> None:
    """Move the values at jumps, in place, so that a cubic spline through each column does not overshoot."""
    # A spline lies within the range of its coefficients, so the values become coefficients; half its height is added to
    # a single peak, which keeps it. The values are moved to those of that spline.
    for columns in _blocks(values):
        if not (here := at[:, columns]).any():
            continue
        coefficients = values[:, columns].copy()
        coefficients[1:-1] += here[1:-1] * _peaks(np.diff(values[:, columns], axis=0))
        spline_values = coefficients[1:-1] + np.diff(coefficients, 2, axis=0) / 6
        np.copyto(values[1:-1, columns], spline_values, where=here[1:-1])


def _blocks(lines: np.ndarray) -> Iterator[slice]:
    """Return slices of columns whose intermediate arrays fit the cache."""
    count = max(2**16 // len(lines), 16)
    return (slice(first, first + count) for first in range(0, lines.shape[1], count))


def _exceed_nearby(second: Float32[np.ndarray, "n w"], rounding: np.floating) -> Bool[np.ndarray, "m w"]:
    """Return True where fourth differences are large against the second ones up to two cells away, column by column."""
    fourth, size = np.abs(np.diff(second, 2, axis=0)), np.abs(second)
    nearby = np.maximum(np.maximum(size[:-2], size[1:-1]), size[2:])
    np.maximum(nearby[1:], size[:-3], out=nearby[1:])
    np.maximum(nearby[:-1], size[3:], out=nearby[:-1])
    nearby *= JUMP
    nearby[0] = BORDER_JUMP * size[:BORDER_CELLS].max(axis=0)
    nearby[-1] = BORDER_JUMP * size[-BORDER_CELLS:].max(axis=0)
    return fourth > np.maximum(nearby, rounding)


def _peaks(steps: Float64[np.ndarray, "n w"]) -> Float64[np.ndarray, "m w"]:
    """Return half the height of a single peak above its neighbours, or of a pit below (negative); otherwise 0."""
    up, down = steps[:-1], -steps[1:]
    return np.where(up * down > 0, np.sign(up) * np.minimum(np.abs(up), np.abs(down)) / 2, 0.0)
