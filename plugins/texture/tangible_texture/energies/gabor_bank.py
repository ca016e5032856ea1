"""Gabor filters and their banks (Jain & Farrokhnia, Pattern Recognition 24, 1991)."""

from collections.abc import Sequence
from math import ceil, cos, floor, log, log2, pi, sin, sqrt, tan
from typing import NamedTuple

import numpy as np
from jaxtyping import Complex128

# The wavelength of the highest octave, px: sqrt(2)/4 cycles a pixel; one octave wide, it ends near Nyquist's.
SHORTEST_PX = 2 * sqrt(2)
HALF = sqrt(log(2) / 2)


class Gabor(NamedTuple):
    """A Gabor function: a wave under a Gaussian that is sigma_px wide along it and sigma_px / gamma across it."""

    wavelength_px: float
    theta_rad: float
    """Direction of the wave, from right (growing columns) to down (growing rows); 0 is vertical stripes."""
    sigma_px: float
    gamma: float

    @property
    def frequency(self) -> tuple[float, float]:
        """The frequency (down, right), in cycles a pixel."""
        return sin(self.theta_rad) / self.wavelength_px, cos(self.theta_rad) / self.wavelength_px


def sigma_of_bandwidth(wavelength_px: float, octaves: float = 1.0) -> float:
    """Return sigma = lambda / pi sqrt(ln 2 / 2) (2^b + 1) / (2^b - 1) in px, for a width of b octaves at half height.

    >>> round(sigma_of_bandwidth(8.0), 4)
    4.4974
    """
    return wavelength_px * HALF / pi * (2**octaves + 1) / (2**octaves - 1)


def octaves(lambda_max_px: float) -> tuple[float, ...]:
    """Return wavelengths 2 sqrt 2, 4 sqrt 2, ... px up to lambda_max_px, for a picture of any size; at least the first.

    >>> [round(each, 2) for each in octaves(24)]
    [2.83, 5.66, 11.31, 22.63]
    """
    count = 1 + floor(log2(max(lambda_max_px, SHORTEST_PX) / SHORTEST_PX) + 1e-9)
    return tuple(SHORTEST_PX * 2**i for i in range(count))


def printed_wavelengths(width_px: int) -> tuple[float, ...]:
    """Return rising wavelengths in px of the printed frequencies, 0.25 -+ 2^(i - 0.5) / N cycles a pixel.

    i = 1..log2(N / 8). The paper has widths N that are powers of two. For another width i ends at the whole part of
    log2(N / 8), with N itself in the formula; under 16 px, where no i is left, 0.25 alone remains.

    >>> [round(1 / each, 3) for each in printed_wavelengths(32)]
    [0.338, 0.294, 0.206, 0.162]
    """
    last = floor(log2(max(width_px, 8) / 8) + 1e-9)
    offsets = [2 ** (i - 0.5) / width_px for i in range(last, 0, -1)]
    frequencies = [0.25 + offset for offset in offsets] + [0.25 - offset for offset in reversed(offsets)]
    return tuple(1 / frequency for frequency in frequencies or (0.25,))


def bank(
    wavelengths_px: Sequence[float], orientations: int = 6, bandwidth: float = 1.0, gamma: float | None = None
) -> list[Gabor]:
    """Return filters of every wavelength in every orientation 0, 180 / n, ... degrees, sorted by wavelength."""
    # Neighbouring orientations meet at half height: 0.80 for 6 orientations and one octave.
    if gamma is None:
        ratio = (2**bandwidth - 1) / (2**bandwidth + 1)
        gamma = min(1.0, tan(pi / (2 * orientations)) / ratio) if orientations > 1 else 1.0
    return [
        Gabor(wavelength, i * pi / orientations, sigma_of_bandwidth(wavelength, bandwidth), gamma)
        for wavelength in wavelengths_px
        for i in range(orientations)
    ]


def kernel(gabor: Gabor, reach: float = 3.5) -> Complex128[np.ndarray, "n n"]:
    """Sample the filter in space to `reach` sigma on each side: its real part is even, its imaginary part odd."""
    # exp(-(x'^2 + gamma^2 y'^2) / (2 sigma^2)) exp(2 pi i x' / lambda), x' = x cos t + y sin t, y' = -x sin t + y cos
    # t; scaled so that a wave of its own frequency and amplitude a gives a response of magnitude a, minus the multiple
    # of the Gaussian that makes the response to flat grey zero.
    radius = ceil(reach * gabor.sigma_px / min(1.0, gabor.gamma))
    y, x = np.mgrid[-radius : radius + 1, -radius : radius + 1].astype(np.float64)
    along = x * cos(gabor.theta_rad) + y * sin(gabor.theta_rad)
    across = -x * sin(gabor.theta_rad) + y * cos(gabor.theta_rad)
    envelope = np.exp(-(along**2 + (gabor.gamma * across) ** 2) / (2 * gabor.sigma_px**2))
    envelope *= 2 / envelope.sum()
    wave = np.exp(2j * pi * along / gabor.wavelength_px)
    return envelope * (wave - (envelope * wave).sum() / 2)
