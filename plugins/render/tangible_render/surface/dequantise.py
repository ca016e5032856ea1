"""Heights in equal steps, such as from 8-bit pictures: their smoothing within half a step, and grey levels."""

from typing import Annotated, Literal

import numpy as np
from jaxtyping import Float32, UInt8
from pydantic import Field

from tangible_core.runtime import cv2, plain_opencv

Filter = Literal["auto", "never"] | Annotated[float, Field(gt=0, le=64)]

FEWEST_STEPS = 16  # the least number of steps that are smoothed: fewer are intended terraces
# The largest number of steps that are smoothed, that of 8 bits: more are fine enough.
MAX_STEPS = 255
SIGMA_CELLS = 4.0
PASSES = 5
ROUNDS = 8


def dequantise(height_m: Float32[np.ndarray, "h w"], cells: Filter = "auto") -> Float32[np.ndarray, "h w"]:
    """Smooth heights on a lattice of 16 to 255 equal steps within half a step; return other heights unchanged."""
    if cells == "never" or (step_m := lattice_step(height_m)) == 0:
        return height_m
    # Low-passed and clipped to half a step, in turn (projections onto convex sets, Youla & Webb, IEEE Trans. Medical
    # Imaging 1, 1982). The low-pass 1 - (1 - G)^5 keeps the slope of a wave of 64 cells within 0.3 degrees; beyond the
    # border heights continue as their odd reflection: planes, cliffs and spikes stay.
    sigma = SIGMA_CELLS if cells == "auto" else cells
    lowest, highest = height_m - step_m / 2, height_m + step_m / 2
    smooth = height_m
    for _ in range(ROUNDS):
        smooth = np.clip(_low_pass(smooth, sigma), lowest, highest)
    return smooth


def lattice_step(height_m: Float32[np.ndarray, "h w"]) -> float:
    """Return the step, m, if the heights take 17 values or more on one lattice of at most 255 steps, otherwise 0.

    >>> lattice_step(np.float32(0.5) * np.arange(40, dtype=np.float32)[None, :])
    0.5
    """
    sample = np.unique(height_m.ravel()[:: 1 + height_m.size // 2**16])
    if sample.size > MAX_STEPS + 1:  # a sample is enough to see that there are too many
        return 0.0
    levels = np.unique(height_m).astype(np.float64)
    if not FEWEST_STEPS < levels.size <= MAX_STEPS + 1:
        return 0.0
    span = levels[-1] - levels[0]
    steps = np.arange(levels.size - 1, MAX_STEPS + 1)
    places = np.outer(steps, (levels - levels[0]) / span)
    fits = np.abs(places - np.rint(places)).max(axis=1) <= 0.01  # the rounding of float32
    return float(span / steps[fits.argmax()]) if fits.any() else 0.0


def grey_levels(height_m: Float32[np.ndarray, "h w"]) -> UInt8[np.ndarray, "h w"]:
    """Return heights in 256 steps: 0 on the base plane, 255 at the highest point; all 0 for a surface of height 0."""
    highest = height_m.max()
    return np.rint(height_m / highest * 255).astype(np.uint8) if highest > 0 else np.zeros(height_m.shape, np.uint8)


def _low_pass(values: Float32[np.ndarray, "h w"], sigma: float) -> Float32[np.ndarray, "h w"]:
    residual = values
    for _ in range(PASSES):
        residual = residual - _gauss(residual, sigma)
    return values - residual


def _gauss(values: Float32[np.ndarray, "h w"], sigma: float) -> Float32[np.ndarray, "h w"]:
    reach = int(np.ceil(4 * sigma))
    frame = np.pad(values, reach, mode="reflect", reflect_type="odd")
    with plain_opencv():
        smooth = cv2.GaussianBlur(frame, (2 * reach + 1, 2 * reach + 1), sigma)
    return np.asarray(smooth[reach:-reach, reach:-reach], np.float32)
