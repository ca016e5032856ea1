"""Textures sampled for pictures and files: tiles, strokes, and their spectra."""

from math import exp, log2
from typing import Any, NamedTuple, cast

import numpy as np
from jaxtyping import Float, Float32, Float64

from tangible_core.data import Material
from tangible_core.errors import MaterialError

from .table import STIFFNESS, compile_textures, powers_of_two, waves

FINEST = 3  # fewest pixels a period: a picture would show a finer wave as another one


def sample_tile(material: Material, width_m: float, pixels: int) -> Float32[np.ndarray, "n n"]:
    """Return heights over the mean, metres, of a square at the origin; the top row is far. Raises: MaterialError."""
    if not (0 < width_m < np.inf and pixels >= 1):
        raise MaterialError(
            f"a tile needs a positive width and at least one pixel, not {width_m} m and {pixels} pixels"
        )
    pitch_m = width_m / pixels
    parts = waves(material)
    # A wave that spans fewer than FINEST pixels along a row or a column would be shown as another one.
    fine = np.maximum(np.abs(parts.fx), np.abs(parts.fy)) * pitch_m > 1 / FINEST
    amplitude_m = np.where(fine, 0, parts.amplitude_m)
    at_m = (np.arange(pixels) + 0.5) * pitch_m - width_m / 2
    across = 2 * np.pi * (np.outer(parts.fx, at_m) + parts.phase[:, None])
    away = 2 * np.pi * np.outer(at_m[::-1], parts.fy)
    even = np.einsum("ij,jk->ik", amplitude_m * np.cos(away), np.cos(across))
    odd = np.einsum("ij,jk->ik", amplitude_m * np.sin(away), np.sin(across))
    return (even - odd).astype(np.float32)


class Stroke(NamedTuple):
    """A stroke: distance, height, and force on the hand in the direction of the stroke, in metres and newtons."""

    way_m: Float64[np.ndarray, " n"]
    height_m: Float64[np.ndarray, " n"]
    force_n: Float64[np.ndarray, " n"]


def stroke(
    material: Material,
    speed_m_per_s: float = 0.05,
    normal_n: float = 1.0,
    length_m: float = 0.02,
    period_s: float = 0.001,
    direction_deg: float = 0.0,
) -> Stroke:
    """Compute a stroke from the workspace's origin at constant speed and normal force. Raises: MaterialError."""
    positive = (speed_m_per_s, normal_n, length_m, period_s)
    if not (all(0 < number < np.inf for number in positive) and np.isfinite(direction_deg)):
        raise MaterialError(f"a stroke needs positive numbers and a direction, not {positive} and {direction_deg}")
    from . import forces

    way_m = np.arange(0, length_m, speed_m_per_s * period_s)
    along = np.array([np.cos(np.deg2rad(direction_deg)), np.sin(np.deg2rad(direction_deg))])
    textures, result = compile_textures([material]), np.empty((len(way_m), 5))
    cast(Any, forces).along(textures, 0, np.zeros(forces.STATE), np.outer(way_m, along), period_s, normal_n, result)
    # The texture's force, the slope's, -N dh/ds (Robles-De-La-Torre & Hayward, Nature 412, 2001), and the dynamic
    # friction if the texture has no friction.
    friction_n = 0.0 if textures[0, STIFFNESS] else material.dynamic_friction * normal_n
    lateral_n = result[:, 3:] - normal_n * result[:, 1:3]
    force_n = lateral_n[:, 0] * along[0] + lateral_n[:, 1] * along[1] - friction_n * (way_m > 0)
    return Stroke(way_m, result[:, 0], force_n)


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
