"""A least-squares fit of a few parameters, bit-identical on every processor, and a robust loss."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float64

NOISE_PX = 0.3  # standard deviation of a coordinate of a match, in pixels
_LOG_2 = 0.6931471805599453
_ROUNDS, _TRIES = 80, 15  # maximum number of steps of a fit, and of damping factors tried for a step
_STEP = 1e-5
_STILL = 1e-5  # step at which the fit has converged, in units of each parameter's scale
_MIN_GAIN = 0.05  # lowest share of its expected gain with which a step is accepted


def robust_pull(offset_px: Float64[np.ndarray, "n"]) -> Float64[np.ndarray, "n"]:
    """Return the root of log(1 + (offset / NOISE_PX)^2), with the offset's sign: outliers hardly affect the fit."""
    offset = offset_px / NOISE_PX
    return np.sign(offset) * np.sqrt(_log1p(offset * offset))


def least_squares(cost: Callable[[np.ndarray], np.ndarray], start: np.ndarray, scale: np.ndarray) -> np.ndarray:
    """Minimise the sum of the squares of `cost` near `start` (Levenberg, Marquardt); scale: size of each parameter."""
    from tangible_core.compiled import solve

    # Nocedal & Wright, Numerical Optimization, 2nd ed., sec. 10.3. Sums run in a fixed order: LAPACK, which SciPy uses,
    # differs in its last bits by processor and from run to run, and these bits decide when this fit stops.
    values, residuals, damping = start, cost(start), 1e-2
    for _ in range(_ROUNDS):
        both = [cost(values + step) - cost(values - step) for step in np.diag(_STEP * scale)]
        slopes = np.stack(both, axis=1) / (2 * _STEP)
        normal, down = np.einsum("ni,nj->ij", slopes, slopes), np.einsum("ni,n->i", slopes, residuals)
        for _ in range(_TRIES):
            move = -solve(normal + damping * np.trace(normal) / len(start) * np.eye(len(start)), down[None])[0]
            then = cost(values + scale * move)
            gain, expected_gain = np.square(residuals).sum() - np.square(then).sum(), -(down * move).sum()
            if gain > 0 and gain >= _MIN_GAIN * expected_gain:
                break
            damping *= 4
        else:
            break
        values, residuals = values + scale * move, then
        damping = damping / 4 if gain > expected_gain else damping if 2 * gain > expected_gain else 2 * damping
        if np.abs(move).max() < _STILL:
            break
    return values


def _log1p(values: np.ndarray) -> np.ndarray:
    """Compute log(1 + x) for x >= 0 by multiplications and additions alone: the C library's differs by processor."""
    # 2 atanh(x / (2 + x)), for large x of the fraction of 1 + x and with log 2 for each power of two.
    fraction, power = np.frexp(1 + values)
    small = values < 1
    share = np.where(small, values / (2 + values), (fraction - 1) / (fraction + 1))
    square, total = share * share, np.zeros(values.shape)
    for odd in range(37, 0, -2):
        total = total * square + 1 / odd
    return 2 * share * total + np.where(small, 0, power) * _LOG_2
