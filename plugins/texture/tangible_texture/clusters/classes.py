"""The classes of cells, by division, discriminants and joining, and the likeliest number of textures."""

import logging
from collections.abc import Iterable
from math import exp, inf, log, log1p
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float64, Int32

from tangible_core.plugins import note

from ..features.features import Features, Window
from .discriminants import divide, principal_axes
from .joining import FEW_POWER, MANY, MANY_POWER, Step, axes_between, join_clusters, project
from .neighbourhood import interior_shares, refit_labels
from .planes import combine_planes

logger: logging.Logger = logging.getLogger(__name__)

# The largest number of textures that is estimated, and the cells of the picture that there must be for each.
LARGEST_NUMBER, CELLS_EACH = 16, 96


class Weights(NamedTuple):
    """The log-odds that a pair of clusters are two textures: a constant, and a weight for each logarithm."""

    constant: float
    distance: float  # of the squared Mahalanobis distance between the two
    size: float  # of their combined size, as a share of the picture
    cells: float  # of the number of cells: with few, discriminants tell apart what is one texture


# Fitted to mosaics, half of the given and half of built-in textures: `python -m benchmarks.texture_number`.
TWO_TEXTURES: Weights = Weights(-14.93, 3.33, 2.62, 1.19)


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


PRINCIPAL_AXES = 14
# The power of its variance that divides a principal axis: half way between none, 0, and full whitening, 0.5.
HALF_WHITE = 0.25
FINAL_ROUNDS = 8


class Effort(NamedTuple):
    """The initial number of clusters, and the number of joinings with recomputed discriminants."""

    per_segment: int
    besides: int
    last: int  # joinings with recomputed discriminants, before the number of segments is reached


EFFORTS = {"fast": Effort(2, 2, 2), "balanced": Effort(3, 4, 8)}


def classes(
    features: Features,
    network_window: Window | None,
    segments: int | Literal["auto"],
    effort: Literal["fast", "balanced"],
) -> tuple[Int32[np.ndarray, "m"], Float64[np.ndarray, "a d"]]:
    """Classify the cells of the middle windows; return each cell's class, and the axes along which classes differ."""
    counts, (planes, shape) = EFFORTS[effort], features.middle
    most = largest_number(planes.shape[1]) if segments == "auto" else segments
    principal_planes = combine_planes(
        principal_axes(features.wide.planes, PRINCIPAL_AXES, HALF_WHITE), features.wide.planes
    )
    wide = divide(principal_planes, counts.per_segment * most + counts.besides).reshape(features.wide.shape)
    rows, columns = (((np.arange(n) + 0.5) * side / n).astype(int) for side, n in zip(wide.shape, shape, strict=True))
    labels = wide[np.ix_(rows, columns)].ravel()
    power = MANY_POWER if segments == "auto" or segments >= MANY else FEW_POWER
    # What `learned_values` makes of these cells counts as much as the features in joining.
    sets = [planes] if network_window is None else [planes, network_window.planes]
    steps = join_clusters(sets, labels, shape, most + counts.last, power)
    labels = (
        likeliest_division(step for step in steps if step.clusters <= most + counts.last)
        if segments == "auto"
        else next(step.labels for step in steps if step.clusters <= segments)
    )
    shares = interior_shares(labels, shape)
    axes = [axes_between(planes, labels, shares) for planes in sets]
    if not len(axes[0]):
        return labels * 0, axes[0]
    return refit_labels(project(axes, sets)[0], labels, shape, FINAL_ROUNDS, 1), axes[0]
