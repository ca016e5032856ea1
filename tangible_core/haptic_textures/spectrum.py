"""Which wavelengths a texture has: the radial spectrum of a tile, the spectrum of a line."""

import numpy as np
from jaxtyping import Float, Float64

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
    power = np.abs(np.fft.fftn((values - np.average(values, weights=window)) * window)) ** 2
    edges = np.arange(1, np.log2(max(count / 2, 3)), STEP_OCTAVES)  # from two periods a side on, so that one is seen
    octaves = 0.5 * np.log2(np.maximum(radius2, 1e-9))
    binned = np.histogram(octaves, np.append(edges, edges[-1] + STEP_OCTAVES), weights=power)[0]
    blurred = np.convolve(binned, _bell(), "same")
    return side_m / 2 ** (edges + STEP_OCTAVES / 2), blurred / max(blurred.sum(), 1e-300)


def _bell() -> Float64[np.ndarray, " m"]:
    """A Gaussian of BLUR_OCTAVES over the bins."""
    reach = round(3 * BLUR_OCTAVES / STEP_OCTAVES)
    bell = np.exp(-0.5 * (np.arange(-reach, reach + 1) * STEP_OCTAVES / BLUR_OCTAVES) ** 2)
    return bell / bell.sum()
