"""Sensitivity d', from proportions correct: Macmillan & Creelman, Detection Theory, 2nd ed. (2005), ch. 7, 9, 10."""

from collections.abc import Callable
from functools import cache
from math import inf, nan, pi, sqrt

import numpy as np
from jaxtyping import Float64
from numpy.polynomial.hermite_e import hermegauss
from numpy.polynomial.legendre import leggauss
from scipy.special import ndtr, ndtri

from .intervals import LEVEL, Estimate

# Largest d' that is looked for; the proportion correct is 1 in double precision long before.
LARGEST = 12.0
_NODES, _WEIGHTS = hermegauss(100)
_WEIGHTS = _WEIGHTS / _WEIGHTS.sum()
_HALF = 4.5 * (1 + leggauss(100)[0])
# Nodes and weights of a mean over the upper half of a normal distribution, of which 1e-18 is beyond 9.
_HALF_WEIGHTS = 9 * leggauss(100)[1] * (np.exp(-(_HALF**2) / 2) / sqrt(2 * pi))
_DPRIMES, _CRITERIA = np.linspace(0, 8, 401), np.linspace(0, 10, 401)
"""d' and criteria among which those of two intervals that are the same or different are looked for."""


def two_afc(proportion: float) -> float:
    """Return d' from the proportion correct in two-interval forced choice; negative below one half.

    >>> [round(two_afc(each), 2) for each in (0.5, 0.76, 0.92)]
    [0.0, 1.0, 1.99]
    """
    return sqrt(2) * float(ndtri(proportion))


def oddity(proportion: float) -> float:
    """Return d' from the proportion correct when the odd one of three is named, by the differencing rule.

    0 at and below chance, 1/3. The odd one is the one farthest from the other two. Source: Frijters (1979).
    >>> [round(oddity(share), 2) for share in (0.3, 0.5, 0.8)]
    [0.0, 1.47, 3.13]
    """
    return _inverse(oddity_correct, proportion)


def naming(proportion: float, choices: int) -> float:
    """Return d' from the proportion correct when one of n choices is named, each as different from the others.

    >>> [round(naming(each, 4), 2) for each in (0.25, 0.6)]
    [0.0, 1.15]
    """
    return _inverse(lambda dprime: naming_correct(dprime, choices), proportion)


def same_different(hits: int, differing: int, alarms: int, equal: int) -> Estimate:
    """Return d' and its interval from two intervals that are the same or different, by the differencing rule.

    hits, alarms: `different` of the trials that differ, or are equal. NaN without trials of a kind.
    """
    from scipy.stats import chi2

    if not (differing and equal):
        return Estimate(nan)
    counts = np.array([hits, differing - hits, alarms, equal - alarms], float)
    value = _DPRIMES[_likelihood(counts + 0.5).argmax()]  # half an answer keeps it finite (Hautus 1995)
    likelihood = _likelihood(counts)
    within = np.flatnonzero(2 * (likelihood.max() - likelihood) <= chi2.ppf(LEVEL, 1))
    high = inf if within[-1] == len(_DPRIMES) - 1 else float(_DPRIMES[within[-1]])
    return Estimate(float(value), float(_DPRIMES[within[0]]), high)


def _likelihood(counts: Float64[np.ndarray, "4"]) -> Float64[np.ndarray, "d"]:
    """Return the logarithm of the likelihood of each d', with the best criterion."""
    return np.tensordot(counts, _same_different_logs(), 1).max(axis=1)


@cache
def _same_different_logs() -> Float64[np.ndarray, "4 d k"]:
    """Return the logarithms of the shares of hits, misses, false alarms and their absence, by d' and criterion."""
    dprime, criterion = _DPRIMES[:, None], _CRITERIA[None]
    alarms = 2 * ndtr(-criterion / sqrt(2)) + 0 * dprime
    hits = ndtr((dprime - criterion) / sqrt(2)) + ndtr((-dprime - criterion) / sqrt(2))
    shares = np.stack([hits, 1 - hits, alarms, 1 - alarms])
    return np.log(np.clip(shares, 1e-300, 1))


@cache
def oddity_correct(dprime: float) -> float:
    """Return the proportion correct of an observer who names the odd one of three."""
    shift = dprime * sqrt(2 / 3)
    shares = ndtr(shift - sqrt(3) * _HALF) + ndtr(-shift - sqrt(3) * _HALF)
    return float(_HALF_WEIGHTS @ shares)


@cache
def naming_correct(dprime: float, choices: int) -> float:
    """Return the proportion correct of an observer who names the one of n choices with the most evidence."""
    return float(_WEIGHTS @ ndtr(_NODES + dprime) ** (choices - 1))


def _inverse(correct: Callable[[float], float], proportion: float) -> float:
    if proportion <= correct(0.0):  # chance, with the error of the integral
        return 0.0
    if proportion >= correct(LARGEST):
        return inf
    from scipy.optimize import brentq

    return float(brentq(lambda dprime: correct(dprime) - proportion, 0.0, LARGEST))  # pyright: ignore[reportArgumentType]
