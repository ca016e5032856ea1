"""A least-squares fit of a few parameters, bit-identical on every processor."""

from collections.abc import Callable

import numpy as np

_ROUNDS, _TRIES = 80, 15  # maximum number of steps of a fit, and of damping factors tried for a step
_STEP = 1e-5
_STILL = 1e-5  # step at which the fit has converged, in units of each parameter's scale
_MIN_GAIN = 0.05  # lowest share of its expected gain with which a step is accepted


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
