"""Which wavelengths a texture has: the radial spectrum of a tile, the spectrum of a line."""

from math import exp, log2

import numpy as np
from jaxtyping import Float, Float64

from .waves import powers_of_two

STEP_OCTAVES = 1 / 48
BLUR_OCTAVES = 1 / 8
"""Standard deviation of the Gaussian over the bins."""

Spectrum = tuple[Float64[np.ndarray, " bins"], Float64[np.ndarray, " bins"]]
"""Wavelengths in metres, from long to short, and the power of each per octave, 1 in sum."""


def radial_spectrum(tile: Float[np.ndarray, "n n"], width_m: float) -> Spectrum:
    """Power of a square tile by wavelength, whatever its direction; all zeros for a tile of zeros.

    Under Hann's window; bins of STEP_OCTAVES, blurred over BLUR_OCTAVES.
    """
    return _by_octave(np.asarray(tile, np.float64), width_m)


def line_spectrum(values: Float[np.ndarray, " n"], length_m: float) -> Spectrum:
    """The same of equally spaced values along a line."""
    return _by_octave(np.asarray(values, np.float64), length_m)


def peak_wavelength_m(spectrum: Spectrum) -> float:
    """The wavelength of the greatest power, NaN where there is none."""
    wavelength_m, power = spectrum
    return float(wavelength_m[np.argmax(power)]) if power.any() else float("nan")


def _by_octave(values: Float64[np.ndarray, "..."], side_m: float) -> Spectrum:
    count = len(values)
    index = np.arange(count)
    turns2 = np.minimum(index, count - index) ** 2
    window, radius2 = np.ones(()), np.zeros(())
    for _ in values.shape:
        window = np.multiply.outer(window, np.hanning(count + 2)[1:-1])
        radius2 = np.add.outer(radius2, turns2)
    spectrum = np.fft.fftn((values - np.average(values, weights=window)) * window)
    power = np.square(spectrum.real) + np.square(spectrum.imag)
    edges = np.arange(1, log2(max(count / 2, 3)), STEP_OCTAVES)  # from two periods a side on, so that one is seen
    squared = powers_of_two(2 * np.append(edges, edges[-1] + STEP_OCTAVES))
    # Not np.histogram: it sorts, and where values are equal every processor sorts in another order.
    bins = np.searchsorted(squared, radius2.ravel(), "right") - 1
    inside = (bins >= 0) & (bins < edges.size)
    blurred = _blurred(np.bincount(bins[inside], power.ravel()[inside], edges.size))
    return side_m / powers_of_two(edges + STEP_OCTAVES / 2), blurred / max(blurred.sum(), 1e-300)


def _blurred(power: Float64[np.ndarray, " bins"]) -> Float64[np.ndarray, " bins"]:
    """By a Gaussian of BLUR_OCTAVES over the bins; np.convolve is a BLAS's."""
    reach = round(3 * BLUR_OCTAVES / STEP_OCTAVES)
    bell = np.array([exp(-0.5 * (at * STEP_OCTAVES / BLUR_OCTAVES) ** 2) for at in range(-reach, reach + 1)])
    around = np.lib.stride_tricks.sliding_window_view(np.pad(power, reach), len(bell))
    return np.einsum("ij,j->i", around, bell / bell.sum())
