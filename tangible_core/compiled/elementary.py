"""Exponential, logarithm and hyperbolic tangent in single precision: the same bits on every processor.

They use only sums and products. NumPy has special code for AVX2 and AVX-512, numba calls Intel's library if that is
installed, and their results differ in the last bit. Imports numba: import this module inside a verb.

Source: Moshier, Cephes mathematical library, expf, logf and tanhf: polynomials on a short interval.
"""

# pyright: basic

from typing import Any

import numpy as np

from .compiling import KERNEL, njit

_LEAST, _MOST = np.float32(-87), np.float32(88)
_LOG2_E, _HALF, _ONE, _TWO = np.float32(1.44269504088896341), np.float32(0.5), np.float32(1), np.float32(2)
_LN2, _LN2_REST = np.float32(0.693359375), np.float32(-2.12194440e-4)
_ROOT_HALF = np.float32(0.707106781186547524)
_E5, _E4, _E3, _E2, _E1, _E0 = (
    np.float32(value)
    for value in (1.9875691500e-4, 1.3981999507e-3, 8.3334519073e-3, 4.1665795894e-2, 1.6666665459e-1, 5.0000001201e-1)
)
_L8, _L7, _L6, _L5, _L4, _L3, _L2, _L1, _L0 = (
    np.float32(value)
    for value in (
        7.0376836292e-2, -1.1514610310e-1, 1.1676998740e-1, -1.2420140846e-1, 1.4249322787e-1,
        -1.6668057665e-1, 2.0000714765e-1, -2.4999993993e-1, 3.3333331174e-1,
    )
)  # fmt: skip
_T4, _T3, _T2, _T1, _T0 = (
    np.float32(value)
    for value in (-5.70498872745e-3, 2.06390887954e-2, -5.37397155531e-2, 1.33314422036e-1, -3.33332819422e-1)
)
_NEAR, _ZERO = np.float32(0.625), np.float32(0)


@njit(**KERNEL)
def exponential(x):
    """Return e^x of a float32; x is clamped to -87..88."""
    x = _LEAST if x < _LEAST else x  # min and max would not be vectorised
    x = _MOST if x > _MOST else x
    turns = np.floor(x * _LOG2_E + _HALF)
    r = (x - turns * _LN2) - turns * _LN2_REST
    y = ((((_E5 * r + _E4) * r + _E3) * r + _E2) * r + _E1) * r + _E0
    y = y * r * r + r + _ONE
    return y * np.int32((np.int32(turns) + 127) << 23).view(np.float32)


@njit(**KERNEL)
def logarithm(x):
    """Return the natural logarithm of a float32 that is positive, finite and not denormal."""
    bits = np.float32(x).view(np.int32)
    power = np.float32((bits >> 23) - 126)
    part = np.int32((bits & 0x007FFFFF) | 0x3F000000).view(np.float32)  # 0.5 <= part < 1
    low = part < _ROOT_HALF
    r = part + part - _ONE if low else part - _ONE
    power = power - _ONE if low else power
    y = _L8
    for term in (_L7, _L6, _L5, _L4, _L3, _L2, _L1, _L0):
        y = y * r + term
    square = r * r
    y = y * r * square + power * _LN2_REST - _HALF * square
    return r + y + power * _LN2


@njit(**KERNEL)
def hyperbolic_tangent(x):
    """Return tanh x of a float32."""
    size = abs(x)
    square = x * x
    near = ((((_T4 * square + _T3) * square + _T2) * square + _T1) * square + _T0) * square * x + x
    far = _ONE - _TWO / (exponential(size + size) + _ONE)
    return near if size < _NEAR else far if x > _ZERO else -far


def exponentials(values: np.ndarray) -> np.ndarray:
    """Return e^x of every value, as `exponential`: float32 of the same shape."""
    return _apply(_exponentials, values)


def logarithms(values: np.ndarray) -> np.ndarray:
    """Return the logarithm of every value, as `logarithm`: float32 of the same shape."""
    return _apply(_logarithms, values)


def hyperbolic_tangents(values: np.ndarray) -> np.ndarray:
    """Return tanh x of every value, as `hyperbolic_tangent`: float32 of the same shape."""
    return _apply(_hyperbolic_tangents, values)


def _apply(kernel: Any, values: np.ndarray) -> np.ndarray:
    flat = np.ascontiguousarray(values, np.float32).reshape(-1)
    results = np.empty_like(flat)
    kernel(flat, results)
    return results.reshape(values.shape)


@njit(**KERNEL)
def _exponentials(values, results):
    for i in range(values.size):
        results[i] = exponential(values[i])


@njit(**KERNEL)
def _logarithms(values, results):
    for i in range(values.size):
        results[i] = logarithm(values[i])


@njit(**KERNEL)
def _hyperbolic_tangents(values, results):
    for i in range(values.size):
        results[i] = hyperbolic_tangent(values[i])
