"""Heights that came in steps, as those of an 8-bit picture do, made smooth again without leaving their steps."""

from typing import Annotated, Literal

import numpy as np
from jaxtyping import Float32
from pydantic import Field

from tangible_core.runtime.opencv import plain_opencv

Filter = Literal["auto", "never"] | Annotated[float, Field(gt=0, le=64)]
"""What a renderer's option `dequantise` may be."""

FEWEST_STEPS, MOST_STEPS = 16, 255
"""Fewer are terraces that somebody meant; more than 8 bits have are fine enough as they are."""
SIGMA_CELLS, PASSES, ROUNDS = 4.0, 5, 8


def dequantise(height_m: Float32[np.ndarray, "h w"], cells: Filter = "auto") -> Float32[np.ndarray, "h w"]:
    """Heights on a lattice of equal steps, 16 to 255 of them, smoothed within half a step; others as they are.

    A height that came in 8 bits is known to half a step. Of the surfaces within these bounds a smooth one is sought:
    low-passed and clipped to the bounds, 8 times in turn. The low-pass is 1 - (1 - G)^5, G a Gaussian of `cells` cells
    (auto: 4), flat enough to leave the slope of a wave of 64 cells within 0.3 degrees. Beyond the border the heights go
    on as their odd reflection. So no place moves by more than half a step, planes stay planes, cliffs and spikes stay.
    Source: projections onto convex sets (Youla & Webb, IEEE Trans. Medical Imaging 1, 1982).
    """
    if cells == "never" or (step_m := lattice_step(height_m)) == 0:
        return height_m
    sigma = SIGMA_CELLS if cells == "auto" else cells
    lowest, highest = height_m - step_m / 2, height_m + step_m / 2
    smooth = height_m
    for _ in range(ROUNDS):
        smooth = np.clip(_low_pass(smooth, sigma), lowest, highest)
    return smooth


def lattice_step(height_m: Float32[np.ndarray, "h w"]) -> float:
    """The step in metres if the heights take 17 values or more, all on one lattice of at most 255 steps, otherwise 0.

    >>> lattice_step(np.float32(0.5) * np.arange(40, dtype=np.float32)[None, :])
    0.5
    """
    sample = np.unique(height_m.ravel()[:: 1 + height_m.size // 2**16])
    if sample.size > MOST_STEPS + 1:  # a few tell that there are too many
        return 0.0
    levels = np.unique(height_m).astype(np.float64)
    if not FEWEST_STEPS < levels.size <= MOST_STEPS + 1:
        return 0.0
    span = levels[-1] - levels[0]
    steps = np.arange(levels.size - 1, MOST_STEPS + 1)
    places = np.outer(steps, (levels - levels[0]) / span)
    fits = np.abs(places - np.rint(places)).max(axis=1) <= 0.01  # float32 rounds
    return float(span / steps[fits.argmax()]) if fits.any() else 0.0


def _low_pass(values: Float32[np.ndarray, "h w"], sigma: float) -> Float32[np.ndarray, "h w"]:
    residual = values
    for _ in range(PASSES):
        residual = residual - _gauss(residual, sigma)
    return values - residual


def _gauss(values: Float32[np.ndarray, "h w"], sigma: float) -> Float32[np.ndarray, "h w"]:
    import cv2

    reach = int(np.ceil(4 * sigma))
    extended = np.pad(values, reach, mode="reflect", reflect_type="odd")
    with plain_opencv():
        blurred = cv2.GaussianBlur(extended, (2 * reach + 1, 2 * reach + 1), sigma)
    return np.asarray(blurred[reach:-reach, reach:-reach], np.float32)
