"""What a picture's texture is like, cell by cell: planes of features, averaged in windows."""

# ruff: noqa: ANN001, ANN202 -- numba takes the types from the call

from collections.abc import Iterable

import numpy as np
from jaxtyping import Float32
from numba import njit

from tangible_core.compiled.threads import in_turns
from tangible_core.runtime.opencv import plain_opencv

CELL_PX = 4
ENERGY_SIGMA_PX = 4.0
RARE = 0.985
"""Quantile of a plane above which values are held down, to LEAST_RARE times its value: a scratch is no texture."""
LEAST_RARE = 1.5
LANES = 64
STILL = 1e-6
"""Standard deviation under which a plane says nothing, features being of the order of 1."""


def cap_rare_values(planes: Float32[np.ndarray, "d h w"]) -> Float32[np.ndarray, "d h w"]:
    """Rare huge values held down, in place."""

    def work(share: Iterable[int]) -> None:
        for i in share:
            at = int(RARE * (planes[i].size - 1))
            highest = LEAST_RARE * np.partition(planes[i], at, axis=None)[at]
            np.minimum(planes[i], highest, out=planes[i])

    in_turns(list(range(len(planes))), work)
    return planes


def window_means(
    planes: Float32[np.ndarray, "d h w"],
    sigma_cells: float,
    step: int = 1,
    out: Float32[np.ndarray, "d rows columns"] | None = None,
) -> Float32[np.ndarray, "d rows columns"]:
    """Gaussian means in windows of sigma_cells, then means of step x step cells; mirrored outside.

    out: where they are written; it may be `planes` where step is 1.
    """
    import cv2

    rows, columns = (-(-side // step) for side in planes.shape[1:])
    means = np.empty((len(planes), rows, columns), np.float32) if out is None else out

    @plain_opencv()
    def work(share: Iterable[int]) -> None:
        room = np.empty(planes.shape[1:], np.float32) if step > 1 else None
        for i in share:
            smooth = means[i] if room is None else room
            cv2.GaussianBlur(planes[i], (0, 0), sigma_cells, dst=smooth, borderType=cv2.BORDER_REFLECT)
            if room is not None:
                cv2.resize(smooth, (columns, rows), dst=means[i], interpolation=cv2.INTER_AREA)

    in_turns(list(range(len(planes))), work)
    return means


def standardise_roots(planes: Float32[np.ndarray, "d n"]) -> None:
    """Square roots, which make spreads alike where means are not, of mean 0 and deviation 1; a still plane is 0."""
    in_turns(list(range(len(planes))), lambda share: [_standardise(planes[i]) for i in share])


@njit(cache=True, nogil=True)
def _standardise(plane):
    for i in range(plane.size):
        plane[i] = np.sqrt((plane[i] if plane[i] > 0 else np.float32(0)) + np.float32(1e-6))
    mean = np.float32(_total(plane, False) / plane.size)
    for i in range(plane.size):
        plane[i] -= mean
    deviation = np.sqrt(_total(plane, True) / plane.size)
    plane *= np.float32(1 / deviation) if deviation > STILL else np.float32(0)


@njit(cache=True, nogil=True)
def _total(values, squared):
    """The sum, of the squares if asked, in lanes of a fixed number.

    So no order depends on how many values the processor adds at once, and squares need no memory of their own.
    """
    lanes, whole = np.zeros(LANES), values.size // LANES * LANES
    for i in range(0, whole, LANES):
        for j in range(LANES):
            value = values[i + j]
            lanes[j] += value * value if squared else value
    total = 0.0
    for j in range(LANES):
        total += lanes[j]
    for i in range(whole, values.size):
        total += values[i] * values[i] if squared else values[i]
    return total
