"""Spectra of textures: the radial spectrum of a tile, and the spectrum of a line."""

from math import exp, log2

import numpy as np
from jaxtyping import Float, Float64

from .waves import powers_of_two

STEP_OCTAVES = 1 / 48
BLUR_OCTAVES = 1 / 8

Spectrum = tuple[Float64[np.ndarray, " bins"], Float64[np.ndarray, " bins"]]
"""Wavelengths in metres, from long to short, and the power of each per octave, 1 in sum."""


def radial_spectrum(tile: Float[np.ndarray, "n n"], width_m: float) -> Spectrum:
    """Return the power of a square tile by wavelength, over all directions; all zeros for a tile of zeros."""
    return _by_octave(np.asarray(tile, np.float64), width_m)


def line_spectrum(values: Float[np.ndarray, " n"], length_m: float) -> Spectrum:
    """Return the power of equally spaced values along a line by wavelength."""
    return _by_octave(np.asarray(values, np.float64), length_m)


def peak_wavelength_m(spectrum: Spectrum) -> float:
    """Return the wavelength of the greatest power, NaN without power."""
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
    edges = np.arange(
        1, log2(max(count / 2, 3)), STEP_OCTAVES
    )  # from two periods a side on, so that a period is complete
    radius_bounds = powers_of_two(2 * np.append(edges, edges[-1] + STEP_OCTAVES))
    # Not np.histogram, which sorts: the order of equal values depends on the processor.
    bins = np.searchsorted(radius_bounds, radius2.ravel(), "right") - 1
    inside = (bins >= 0) & (bins < edges.size)
    smooth = _blur(np.bincount(bins[inside], power.ravel()[inside], edges.size))
    return side_m / powers_of_two(edges + STEP_OCTAVES / 2), smooth / max(smooth.sum(), 1e-300)


def _blur(power: Float64[np.ndarray, " bins"]) -> Float64[np.ndarray, " bins"]:
    """Blur by a Gaussian of BLUR_OCTAVES over the bins; np.convolve would use a BLAS."""
    reach = round(3 * BLUR_OCTAVES / STEP_OCTAVES)
    bell = np.array([exp(-0.5 * (at * STEP_OCTAVES / BLUR_OCTAVES) ** 2) for at in range(-reach, reach + 1)])
    around = np.lib.stride_tricks.sliding_window_view(np.pad(power, reach), len(bell))
    return np.einsum("ij,j->i", around, bell / bell.sum())
