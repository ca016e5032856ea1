"""The number of textures in a picture: how far clusters are joined when nobody says it."""

import logging
from collections.abc import Iterable
from math import exp, inf, log, log1p
from typing import NamedTuple

import numpy as np
from jaxtyping import Int32

from tangible_core.plugins import note

from .joining import Step

logger: logging.Logger = logging.getLogger(__name__)

LARGEST_NUMBER, CELLS_EACH = 16, 96
"""The largest number of textures that is estimated, and the cells of the picture that there must be for each."""


class Weights(NamedTuple):
    """The log-odds that a pair of clusters are two textures: a constant, and a weight for each logarithm."""

    constant: float
    distance: float
    """Of the squared Mahalanobis distance between the two."""
    size: float
    """Of their combined size, as a share of the picture."""
    cells: float
    """Of the number of cells: with few, discriminants tell apart what is one texture."""


TWO_TEXTURES: Weights = Weights(-14.93, 3.33, 2.62, 1.19)
"""Fitted to mosaics, half of the given and half of built-in textures: `python -m benchmarks.texture_number`."""


def largest_number(cells: int) -> int:
    """Return the largest number of textures to look for: clusters of a few cells differ by chance."""
    return min(LARGEST_NUMBER, max(2, cells // CELLS_EACH))


def likeliest_division(steps: Iterable[Step]) -> Int32[np.ndarray, "n"]:
    """Return the labels of the division whose number of clusters is the likeliest, and leave a note about it."""
    every = list(steps)
    likelihoods = number_likelihoods(every)
    total = sum(map(exp, likelihoods))
    best, *others = sorted(zip(likelihoods, every, strict=True), key=lambda rated: -rated[0])
    reason = "no two parts differ"
    if others:
        reason = f"the next best number is {others[0][1].clusters}, with {exp(others[0][0]) / total:.2f}"
    confidence = exp(best[0]) / total
    note(logger, f"segments: {best[1].clusters}, estimated with confidence {confidence:.2f}: {reason}")
    return best[1].labels


def number_likelihoods(steps: Iterable[Step], weights: Weights = TWO_TEXTURES) -> list[float]:
    """Return the logarithm of the probability that joining ends at each step, up to a constant."""
    joining_log, likelihoods = 0.0, list[float]()
    # The number is n if every joining before was of one texture, and the next is of two.
    for step in steps:
        odds = _log_odds(step, weights)
        likelihoods.append(joining_log - _softplus(-odds))
        joining_log -= _softplus(odds)
    return likelihoods


def _log_odds(step: Step, weights: Weights) -> float:
    """Return the log-odds that the pair that would be joined next are two textures; infinite for one cluster."""
    if step.clusters == 1:
        return inf
    if not 0 < step.distance < inf:  # nothing to tell them apart by
        return -inf
    constant, *factors = weights
    values = step.distance, step.size, step.labels.size
    return constant + sum(factor * log(value) for factor, value in zip(factors, values, strict=True))


def _softplus(value: float) -> float:
    return max(value, 0.0) + log1p(exp(-abs(value)))
