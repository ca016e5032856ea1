"""Where heights jump, and heights beside a jump that a cubic spline passes without swinging over it."""

from collections.abc import Iterator

import numpy as np
from jaxtyping import Bool, Float32, Float64

JUMP = 1.5
"""Heights jump where the fourth difference is more than this many times the second ones up to two cells away: 3 at a
step, 2 at a kink, 0.6 on a wave of 8 cells."""
BORDER_JUMP, BORDER_CELLS = 0.9, 12
"""The same at the border, where less is known: a step between the last two cells comes to 1 there."""
ROUNDING = 2.0**-17
"""Fourth differences below this part of the greatest height are float32's rounding."""
REACH = 2
"""Cells to each side of one that takes part in a jump which take part too: edges at an angle jump a bit in each row."""


def jumps(height_m: Float32[np.ndarray, "h w"]) -> Bool[np.ndarray, "h w"]:
    """The cells at steps, kinks, spikes and noise, where a cubic spline through all heights would ring.

    Waves of 8 cells and longer have none. Heights alone tell, not what they go on as beyond the border.
    """
    import cv2

    found = np.zeros(height_m.shape, bool)
    with np.errstate(over="ignore", invalid="ignore"):
        rounding = ROUNDING * np.abs(height_m).max()
        for heights, at in ((height_m, found), (height_m.T, found.T)):
            for lines in _blocks(heights) if len(heights) > 2 * REACH else ():
                at[2:-2, lines] |= _stand_out(np.diff(heights[:, lines], 2, axis=0), rounding)
    if not found.any():
        return found
    return cv2.dilate(found.view(np.uint8), np.ones((2 * REACH + 1, 2 * REACH + 1), np.uint8)).view(bool)


def ease(values: Float64[np.ndarray, "h w"], at: Bool[np.ndarray, "h w"]) -> None:
    """Move the values at jumps, in place, so that a cubic spline through each column does not swing over.

    A spline lies within the range of its coefficients, so these are to be the values themselves; to a lone peak, what
    keeps its height is added, half of how far it stands out. The values are moved to where such a spline passes.
    """
    for columns in _blocks(values):
        if not (here := at[:, columns]).any():
            continue
        wanted = values[:, columns].copy()
        wanted[1:-1] += here[1:-1] * _peaks(np.diff(values[:, columns], axis=0))
        passed = wanted[1:-1] + np.diff(wanted, 2, axis=0) / 6
        np.copyto(values[1:-1, columns], passed, where=here[1:-1])


def _blocks(lines: np.ndarray) -> Iterator[slice]:
    """So many columns at a time that what is made of them stays near the processor."""
    count = max(2**16 // len(lines), 16)
    return (slice(first, first + count) for first in range(0, lines.shape[1], count))


def _stand_out(second: Float32[np.ndarray, "n w"], rounding: np.floating) -> Bool[np.ndarray, "m w"]:
    """Whether fourth differences are large beside the second ones up to two cells away, column by column."""
    fourth, size = np.abs(np.diff(second, 2, axis=0)), np.abs(second)
    nearby = np.maximum(np.maximum(size[:-2], size[1:-1]), size[2:])
    np.maximum(nearby[1:], size[:-3], out=nearby[1:])
    np.maximum(nearby[:-1], size[3:], out=nearby[:-1])
    nearby *= JUMP
    nearby[0] = BORDER_JUMP * size[:BORDER_CELLS].max(axis=0)
    nearby[-1] = BORDER_JUMP * size[-BORDER_CELLS:].max(axis=0)
    return fourth > np.maximum(nearby, rounding)


def _peaks(steps: Float64[np.ndarray, "n w"]) -> Float64[np.ndarray, "m w"]:
    """Half of how far a lone peak is above its neighbours, or a lone pit below (then negative); otherwise 0."""
    up, down = steps[:-1], -steps[1:]
    return np.where(up * down > 0, np.sign(up) * np.minimum(np.abs(up), np.abs(down)) / 2, 0.0)
