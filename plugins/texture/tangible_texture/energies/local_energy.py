"""Local energy in a bank of Gabor filters: one Fourier transform, a small inverse one for each filter."""

from collections.abc import Iterable, Iterator, Sequence
from functools import lru_cache
from math import ceil, cos, exp, hypot, pi, sin
from typing import Any, NamedTuple

import numpy as np
import scipy.fft
from jaxtyping import Complex64, Float32, Float64, Int64

from tangible_core.compiled import in_turns, njit, thread_count
from tangible_core.data import check_finite
from tangible_core.errors import PictureError

from .gabor_bank import Gabor, kernel


@njit(cache=True, nogil=True, error_model="numpy")
def filter_part(values, shape, first, frequency, along, across, part):
    """Write gain times spectrum, row by row; the half that a real picture's spectrum leaves out is mirrored."""
    (high, wide), (top, left), (down, right) = shape, first, frequency
    rows, columns = part.shape
    # The gain 2 exp(-(one^2 + two^2) / 2), which keeps a wave's amplitude, has one and two grow evenly down a column:
    # each gain is the one above times a ratio, which shrinks by the same factor every time.
    one_step, two_step = along[0] / high, across[0] / high
    bend = -(one_step**2 + two_step**2)
    gain, ratio = np.empty(columns), np.empty(columns)
    for j in range(columns):
        v, u = top / high - down, (left + j) / wide - right
        one, two = along[0] * v + along[1] * u, across[0] * v + across[1] * u
        gain[j] = 2 * exp(-0.5 * (one * one + two * two))
        ratio[j] = exp(0.5 * bend - one * one_step - two * two_step)
    for i in range(rows):
        row, j = (top + i) % high, 0
        while j < columns:
            column = (left + j) % wide
            if 2 * column <= wide:
                run = min(columns - j, wide // 2 + 1 - column)
                _scale(values[row, column : column + run], gain[j : j + run], np.float32(1), part[i, j : j + run])
            else:
                run = min(columns - j, wide - column)
                mirror = values[(high - row) % high, wide - column - run + 1 : wide - column + 1]
                _scale(mirror[::-1], gain[j : j + run], np.float32(-1), part[i, j : j + run])
            j += run
        _advance(gain, ratio, exp(bend))


@njit(cache=True, nogil=True)
def _advance(gain, ratio, shrink):
    for j in range(gain.size):
        gain[j] *= ratio[j]
        ratio[j] *= shrink


@njit(cache=True, nogil=True)
def _scale(values, gain, sign, part):
    for j in range(part.size):
        factor = np.float32(gain[j])
        part[j] = complex(values[j].real * factor, values[j].imag * (sign * factor))


@njit(cache=True, nogil=True)
def power(grid):
    """Compute |z|^2 of a contiguous array of complex numbers."""
    rows, columns = grid.shape
    out, parts = np.empty((rows, columns), np.float32), grid.view(np.float32)
    for i in range(rows):
        for j in range(columns):
            out[i, j] = parts[i, 2 * j] * parts[i, 2 * j] + parts[i, 2 * j + 1] * parts[i, 2 * j + 1]
    return out


@njit(cache=True, nogil=True)
def complex_products(one, other):
    """Multiply complex numbers one by one: NumPy fuses multiply and add on some processors."""
    product = np.empty_like(one)
    for i in range(one.shape[0]):
        for j in range(one.shape[1]):
            a, b = one[i, j], other[i, j]
            product[i, j] = complex(a.real * b.real - a.imag * b.imag, a.real * b.imag + a.imag * b.real)
    return product


@njit(cache=True, nogil=True)
def weighted_rows(values, first, weights):
    """Compute weighted sums of rows: out[i] is the sum of weights[i, k] values[first[i] + k]."""
    out = np.zeros((len(first), values.shape[1]), np.float32)
    for i in range(len(first)):
        total = out[i]
        for k in range(weights.shape[1]):
            weight, row = weights[i, k], values[first[i] + k]
            for j in range(row.size):
                total[j] += weight * row[j]
    return out


def even_responses(grey: Float32[np.ndarray, "h w"], filters: Sequence[Gabor]) -> Iterator[Float32[np.ndarray, "h w"]]:
    """Yield the picture convolved with each filter's even kernel; outside of the picture is its mirror image."""
    kernels = [np.real(kernel(gabor)).astype(np.float32) for gabor in filters]
    radius = max(len(even) // 2 for even in kernels)
    shape = [fft.next_fast_len(side + 2 * radius, real=True) for side in grey.shape]
    spectrum = fft.rfft2(np.pad(grey, radius, mode="symmetric"), shape, workers=thread_count())
    for even in kernels:
        response = fft.irfft2(complex_products(spectrum, fft.rfft2(even, shape)), shape, workers=thread_count())
        first = radius + len(even) // 2
        yield response[first : first + grey.shape[0], first : first + grey.shape[1]]


fft: Any = scipy.fft  # its annotations are those of its dispatcher
# The least standard deviation of smoothing, in wavelengths: single waves must not show in the energy.
RELATIVE_SIGMA = 0.35
REACH = 4.0
# The standard deviations of a filter, in frequency, at which it is cut: an energy below the fifth decimal is lost.
TAIL = 3.0
# The samples per standard deviation of the smoothed energy's spectrum: less than 1 % is aliased.
FINENESS = 3.4


class Spectrum(NamedTuple):
    """The Fourier transform of a picture in units of its own standard deviation, mirrored outwards by pad_px."""

    values: Complex64[np.ndarray, "rows half_columns"]
    shape: tuple[int, int]
    pad_px: int


def padding(filters: Sequence[Gabor], sigma_px: float) -> int:
    """Return the width of the mirrored frame in px: the reach of the widest smoothing and two sigma of its filter."""
    return ceil(max((REACH * smoothing_px(gabor, sigma_px) + 2 * gabor.sigma_px for gabor in filters), default=0.0))


def smoothing_px(gabor: Gabor, sigma_px: float) -> float:
    """Return the standard deviation in px of the window in which a filter's energy is averaged."""
    return max(sigma_px, RELATIVE_SIGMA * gabor.wavelength_px)


def picture_spectrum(grey: Float32[np.ndarray, "h w"], pad_px: int) -> Spectrum:
    """Standardise, mirror and transform a picture. Raises: PictureError if it is empty or not finite."""
    if grey.ndim != 2 or grey.size == 0:
        raise PictureError(f"grey is (h, w) with at least one pixel, not {grey.shape}")
    check_finite(grey, "grey")
    shape = (fft.next_fast_len(grey.shape[0] + 2 * pad_px), fft.next_fast_len(grey.shape[1] + 2 * pad_px, real=True))
    ends = [(pad_px, length - pad_px - side) for length, side in zip(shape, grey.shape, strict=True)]
    mirror = np.pad(standardise(grey), ends, mode="symmetric")
    values = fft.rfft2(mirror, norm="forward", workers=thread_count())
    values[0, 0] = 0
    return Spectrum(values, shape, pad_px)


def standardise(grey: Float32[np.ndarray, "h w"]) -> Float32[np.ndarray, "h w"]:
    """Return the picture with mean 0 and standard deviation 1; all 0 if its values differ by rounding only."""
    # Scaled first, so that no square overflows or vanishes.
    top = np.float32(max(float(grey.max()), -float(grey.min())))
    values = grey / top if top else grey
    values = values - np.float32(values.mean(dtype=np.float64))
    deviation = float(np.sqrt(np.mean(np.square(values), dtype=np.float64)))
    return values / np.float32(deviation) if deviation > 1e-7 else np.zeros_like(values)


def energy_planes(
    spectrum: Spectrum,
    filters: Sequence[Gabor],
    shape: tuple[int, int],
    step_px: int,
    sigma_px: float,
    out: Float32[np.ndarray, "filters rows columns"] | None = None,
) -> Float32[np.ndarray, "filters rows columns"]:
    """Compute smoothed energy |z|^2 in these filters, one value every step_px pixels, rounded up; to `out` if given."""
    # A wave of amplitude a at a filter's own frequency has the energy a^2 / v, v being the variance of the picture. The
    # filter's part of the spectrum is transformed back on the coarsest grid that holds it; that moves it to frequency
    # 0, which keeps the magnitude. Smoothing and sampling are one table for each axis. Memory: about 30 bytes a pixel,
    # with two threads on wavelengths of 2.8 px.
    cells = tuple(-(-side // step_px) for side in shape)
    planes = np.empty((len(filters), *cells), np.float32) if out is None else out

    def work(share: Iterable[int]) -> None:
        for i in share:
            wide_px = smoothing_px(filters[i], sigma_px)
            grid = _response(spectrum, filters[i], wide_px)
            tables = [
                smoothing_table(count, step_px, wide_px, samples, side / samples, spectrum.pad_px)
                for count, samples, side in zip(cells, grid.shape, spectrum.shape, strict=True)
            ]
            down = weighted_rows(power(grid), *tables[0])
            planes[i] = weighted_rows(np.ascontiguousarray(down.T), *tables[1]).T

    in_turns(list(range(len(filters))), work)
    return planes


def mean_energies(spectrum: Spectrum, filters: Sequence[Gabor]) -> Float64[np.ndarray, "filters"]:
    """Compute the mean of |z|^2 over the picture in each filter, from the spectrum alone (Parseval)."""
    means = np.empty(len(filters))

    def work(share: Iterable[int]) -> None:
        for i in share:
            means[i] = np.sum(power(_cut(spectrum, filters[i], np.inf)), dtype=np.float64)

    in_turns(list(range(len(filters))), work)
    return means


def _response(spectrum: Spectrum, gabor: Gabor, wide_px: float) -> Complex64[np.ndarray, "rows columns"]:
    """Compute the analytic response on the coarsest grid that holds it; sample j lies at j times side / samples."""
    return fft.ifft2(_cut(spectrum, gabor, wide_px), norm="forward", overwrite_x=True, workers=1)


def _cut(spectrum: Spectrum, gabor: Gabor, wide_px: float) -> Complex64[np.ndarray, "rows columns"]:
    samples = _samples(spectrum.shape, gabor, wide_px)
    top, left = (
        round(frequency * side) - count // 2
        for frequency, side, count in zip(gabor.frequency, spectrum.shape, samples, strict=True)
    )
    part = np.empty(samples, np.complex64)
    along = 2 * pi * gabor.sigma_px * np.array((sin(gabor.theta_rad), cos(gabor.theta_rad)))
    across = 2 * pi * gabor.sigma_px / gabor.gamma * np.array((cos(gabor.theta_rad), -sin(gabor.theta_rad)))
    filter_part(spectrum.values, spectrum.shape, (top, left), gabor.frequency, along, across, part)
    return part


def _samples(shape: tuple[int, int], gabor: Gabor, wide_px: float) -> tuple[int, int]:
    """Return the shape of the grid that holds the filter and its squared response, smoothed by wide_px."""
    s, c = sin(gabor.theta_rad), cos(gabor.theta_rad)
    along = 1 / (2 * pi * gabor.sigma_px)
    down, right = (along * hypot(a, gabor.gamma * b) for a, b in ((s, c), (c, s)))
    smooth = 1 / (2 * pi * wide_px)
    rates = (max(2 * TAIL * width, FINENESS * hypot(smooth, 2 * width)) for width in (down, right))
    rows, columns = (min(side, fft.next_fast_len(ceil(rate * side))) for side, rate in zip(shape, rates, strict=True))
    return rows, columns


@lru_cache(64)
def smoothing_table(
    cells: int, step_px: int, sigma_px: float, samples: int, spacing_px: float, pad_px: int
) -> tuple[Int64[np.ndarray, "cells"], Float32[np.ndarray, "cells taps"]]:
    """Return for each cell the first sample that its Gaussian reaches, and the weights from there on."""
    centre = ((np.arange(cells) + 0.5) * step_px - 0.5 + pad_px) / spacing_px
    reach = REACH * sigma_px / spacing_px
    taps = min(samples, int(2 * reach) + 2)
    first = np.clip(np.ceil(centre - reach).astype(np.int64), 0, samples - taps)
    away = (first[:, None] + np.arange(taps) - centre[:, None]) * (spacing_px / sigma_px)
    weights = np.exp(-0.5 * away**2)
    return first, (weights / weights.sum(axis=1, keepdims=True)).astype(np.float32)
