"""The channels of a picture, and planes of features, one value a cell: capping, averaging, standardising."""

from collections.abc import Iterable

import cv2
import numpy as np
from jaxtyping import Float32

from tangible_core.compiled import in_turns, njit
from tangible_core.data import check_picture, full_scale, luma
from tangible_core.runtime import plain_opencv


def channels(picture: np.ndarray, colour: bool) -> Float32[np.ndarray, "h w c"]:
    """Return red, green and blue over white; or grey, if `colour` is False or there is none. Raises: PictureError."""
    picture = check_picture(picture)
    white = full_scale(picture)
    paint = np.atleast_3d(picture)[..., :3]
    has_colour = any(np.any(paint[..., 0] != paint[..., other]) for other in range(1, paint.shape[2]))
    values = _share(paint if has_colour else paint[..., :1], white)
    if picture.ndim == 3 and picture.shape[2] == 4:
        opaque = _share(picture[..., 3:], white)
        values = values * opaque + (1 - opaque)
    if values.shape[2] == 3 and not colour:
        values = luma(values)[..., None]
    # The largest magnitude is 1 for any scale, so that later squares neither overflow nor vanish.
    top = max(float(values.max()), -float(values.min()))
    return np.ascontiguousarray(values / top if top else values, np.float32)


def _share(values: np.ndarray, white: float) -> Float32[np.ndarray, "h w c"]:
    """Return values as shares of white, divided in single precision at least, so that every dtype gives the same."""
    return np.asarray((values if values.dtype.kind == "f" else values.astype(np.float32)) / white, np.float32)


CELL_PX = 4
# The standard deviation of the window in which energies are averaged before windows of cells, px.
ENERGY_SIGMA_PX = 4.0
RARE = 0.985  # the quantile of a plane that limits its values: a scratch is not a texture
MIN_RARE = 1.5  # the largest value of a plane, as a multiple of its RARE quantile
# The number of parallel partial sums: a constant, so that the order of sums is the same on every processor.
LANES = 64
STILL = 1e-6  # the least standard deviation of an informative plane, features being of the order of 1


def cap_rare_values(planes: Float32[np.ndarray, "d h w"]) -> Float32[np.ndarray, "d h w"]:
    """Limit rare huge values, in place."""

    def work(share: Iterable[int]) -> None:
        for i in share:
            at = int(RARE * (planes[i].size - 1))
            highest = MIN_RARE * np.partition(planes[i], at, axis=None)[at]
            np.minimum(planes[i], highest, out=planes[i])

    in_turns(list(range(len(planes))), work)
    return planes


def window_means(
    planes: Float32[np.ndarray, "d h w"],
    sigma_cells: float,
    step: int = 1,
    out: Float32[np.ndarray, "d rows columns"] | None = None,
) -> Float32[np.ndarray, "d rows columns"]:
    """Compute Gaussian means in windows of sigma_cells, then of step x step cells, to `out` (`planes` if step is 1)."""
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
    """Replace planes by standardised square roots, in place; a constant plane becomes 0."""
    # Square roots have similar spreads where means differ.
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
def _total(values, is_squared):
    """Sum the values, or their squares, in LANES partial sums."""
    # No order of sums depends on the processor's vectors, and squares need no extra memory.
    lanes, whole = np.zeros(LANES), values.size // LANES * LANES
    for i in range(0, whole, LANES):
        for j in range(LANES):
            value = values[i + j]
            lanes[j] += value * value if is_squared else value
    total = 0.0
    for j in range(LANES):
        total += lanes[j]
    for i in range(whole, values.size):
        total += values[i] * values[i] if is_squared else values[i]
    return total
