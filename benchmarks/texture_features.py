"""Energies of the Gabor bank alone: their time, and how far they are from the whole bank in float64."""

from collections.abc import Sequence
from functools import partial
from math import ceil

import numpy as np

from tangible_core.data.pictures import to_grey
from tangible_texture.energies.gabor_bank import Gabor, bank, kernel, octaves
from tangible_texture.energies.local_energy import local_energy, smoothing_px

from .figures import Figure
from .texture_scenes import some
from .turns import in_turns

LONGEST_PX, STEP_PX, SIGMA_PX = 24.0, 4, 4.0
REACH = 6.0
"""Standard deviations at which kernels and windows of the reference end."""
ROUNDS = 15


def figures() -> list[Figure]:
    """Return the promise about features."""
    greys = [to_grey(scene.picture) for scene in some().values()]
    wavelengths_px = octaves(LONGEST_PX)
    filters = bank(wavelengths_px)
    energies = partial(local_energy, wavelengths_px=wavelengths_px, step_px=STEP_PX, sigma_px=SIGMA_PX)
    times = in_turns({str(i): partial(energies, grey) for i, grey in enumerate(greys)}, ROUNDS)
    milliseconds = 1e3 * float(np.median([each.seconds for each in times.values()]))
    errors = np.max([_errors(energies(grey), _whole_bank(grey, filters)) for grey in greys[:2]], axis=0)
    worst = filters[int(errors.argmax())]
    return [
        Figure(
            f"features alone: {len(filters)} filters, energy in windows of {SIGMA_PX:g} px every {STEP_PX} px",
            "<= 8 ms; within 1 % of the full-resolution bank in float64, every filter",
            f"{milliseconds:.1f} ms; worst filter {100 * errors.max():.2f} % (root of the mean square over that of the "
            f"bank's; {worst.wavelength_px:.1f} px, {np.degrees(worst.theta_rad):.0f} degrees), "
            f"median {100 * np.median(errors):.2f} %",
            milliseconds <= 8 and errors.max() <= 0.01,
        )
    ]


def _errors(found: np.ndarray, whole: np.ndarray) -> np.ndarray:
    """Of each filter, over the picture."""
    return np.sqrt(np.square(found - whole).mean(axis=(1, 2)) / np.square(whole).mean(axis=(1, 2)))


def _whole_bank(grey: np.ndarray, filters: Sequence[Gabor]) -> np.ndarray:
    """By the definition: each kernel in space, its energy at every pixel, a Gaussian mean round each cell's centre."""
    values = grey.astype(np.float64)
    values = (values - values.mean()) / values.std()
    return np.stack([_smoothed_energy(values, each) for each in filters])


def _smoothed_energy(values: np.ndarray, gabor: Gabor) -> np.ndarray:
    sigma_px = smoothing_px(gabor, SIGMA_PX)
    waves, margin = kernel(gabor, REACH), ceil(REACH * sigma_px)
    around = np.pad(values, margin + len(waves) // 2, mode="symmetric")
    shape = [side + len(waves) for side in around.shape]
    response = np.fft.ifft2(np.fft.fft2(around, shape) * np.fft.fft2(waves, shape))
    inside = len(waves) - 1
    energy = np.abs(response[inside : around.shape[0], inside : around.shape[1]]) ** 2
    down, across = (_window(side, margin, sigma_px) for side in values.shape)
    return down @ energy @ across.T


def _window(side: int, margin: int, sigma_px: float) -> np.ndarray:
    """(cells, pixels with margin): weights of each cell."""
    centres = (np.arange(ceil(side / STEP_PX)) + 0.5) * STEP_PX - 0.5 + margin
    weights = np.exp(-0.5 * ((np.arange(side + 2 * margin) - centres[:, None]) / sigma_px) ** 2)
    return weights / weights.sum(axis=1, keepdims=True)
