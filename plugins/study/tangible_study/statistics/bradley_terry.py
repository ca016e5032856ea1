"""The scale of Bradley & Terry (1952), Biometrika 39:324, from paired comparisons."""

from collections.abc import Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Float64
from scipy.special import stdtrit

from .intervals import LEVEL, Estimate

FEWEST = 5  # fewest participants from whose differences the uncertainty is estimated


class Scale(NamedTuple):
    """Values on a scale on which one is chosen over another with the probability 1 / (1 + exp(other - one))."""

    values: Float64[np.ndarray, "n"]  # values, their mean zero
    covariance: Float64[np.ndarray, "n n"]
    degrees: float  # degrees of freedom of the intervals
    was_completed: bool  # true if one always won or lost, so that half a win was added to each pair

    def estimate(self, index: int) -> Estimate:
        """Return a value with its interval."""
        return self._estimate(float(self.values[index]), float(self.covariance[index, index]))

    def difference(self, one: int, other: int) -> Estimate:
        """Return how far one is above another, with its interval."""
        weights = np.zeros(len(self.values))
        weights[one], weights[other] = 1.0, -1.0
        return self._estimate(float(weights @ self.values), float(weights @ self.covariance @ weights))

    def _estimate(self, value: float, variance: float) -> Estimate:
        half = float(stdtrit(self.degrees, (1 + LEVEL) / 2)) * max(variance, 0.0) ** 0.5
        return Estimate(value, value - half, value + half)


def fit_scale(wins: Sequence[Float64[np.ndarray, "n n"]]) -> Scale:
    """Fit the scale by maximum likelihood. wins: of each row over each column, for each participant."""
    from scipy.sparse.csgraph import connected_components

    total = np.sum(wins, axis=0)
    count = len(total)
    strongly = connected_components(total > 0, directed=True, connection="strong")[0] == 1
    if not strongly:  # else the likelihood has no maximum
        total = total + 0.5 * (total + total.T > 0)
    values = np.zeros(count)
    centre = np.eye(count) - 1 / count
    for _ in range(100):
        score, information = _derivatives(total, values)
        step = np.linalg.pinv(information) @ score
        values = values + step / max(1.0, float(np.abs(step).max()))
        if np.abs(step).max() < 1e-10:
            break
    inverse = np.linalg.pinv(_derivatives(total, values)[1])
    covariance = centre @ inverse @ centre
    degrees = np.inf
    if len(wins) >= FEWEST:
        scores = np.array([_derivatives(win, values)[0] for win in wins])
        # The sandwich of Liang & Zeger (1986), where participants differ by more than chance.
        spread = scores.T @ scores * len(wins) / (len(wins) - 1)
        robust = covariance @ spread @ covariance
        if np.trace(robust) > np.trace(covariance):
            covariance, degrees = robust, len(wins) - 1.0
    return Scale(values - values.mean(), covariance, degrees, not strongly)


def _derivatives(
    wins: Float64[np.ndarray, "n n"], values: Float64[np.ndarray, "n"]
) -> tuple[Float64[np.ndarray, "n"], Float64[np.ndarray, "n n"]]:
    """Return the slope of the log likelihood, and the information."""
    chance = 1 / (1 + np.exp(values[None, :] - values[:, None]))
    trials = wins + wins.T
    score = (wins - trials * chance).sum(axis=1)
    information = -trials * chance * (1 - chance)
    np.fill_diagonal(information, 0.0)
    np.fill_diagonal(information, -information.sum(axis=1))
    return score, information
