"""Joining of clusters of one texture: the least different pair first, refitting in between."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int32

from .discriminants import discriminant_axes, scatters
from .dividing import one_hot
from .neighbourhood import interior_shares, refit_labels
from .pairs import Pairs, measure_pairs
from .planes import add_planes

AXES = 20
"""The largest number of discriminants."""
FEW_POWER, MANY_POWER, MANY = 0.4, 0.8, 8
"""The exponent of the sizes of two clusters in the cost of joining them, and that for MANY segments or more.

It is 1 in Ward's method. Few regions may differ in size; of many, few are much larger than the others.
"""


class Step(NamedTuple):
    """A division into clusters, and the cost of the next joining."""

    labels: Int32[np.ndarray, "n"]
    clusters: int
    cost: float
    """The cost by `Pairs.joining_costs`; infinite where there is one cluster only."""
    distance: float = np.inf
    """The squared Mahalanobis distance between the two that are joined next."""
    size: float = 0.0
    """Their combined size a b / (a + b), as a share of all cells."""


def join_clusters(
    sets: Sequence[Float32[np.ndarray, "_ n"]],
    labels: Int32[np.ndarray, "n"],
    shape: tuple[int, int],
    renewed: int,
    power: float = FEW_POWER,
) -> Iterator[Step]:
    """Yield divisions into ever fewer clusters, down to one: one less at least in each, one at once if none differ.

    sets: sets of features of the same cells, of which each has its own discriminants; what a joining costs is the
    geometric mean of its costs in each set. renewed: from this number of clusters down, discriminants are recomputed
    before each joining, and cells settle with their neighbours after it. Before that, the discriminants of the first
    division are used. power: the exponent of sizes.
    """
    together, projected = _discriminants(sets, labels, interior_shares(labels, shape))
    labels = refit_labels(together, labels, shape, 2, 1) if projected else labels
    pairs: list[Pairs] = []
    while (count := int(labels.max()) + 1) > 1:
        if not pairs or count <= renewed:
            shares = interior_shares(labels, shape)
            if count <= renewed:
                together, projected = _discriminants(sets, labels, shares)
            if not projected:
                break
            pairs = [measure_pairs(each, labels, shares) for each in projected]
        costs = _mean_costs(pairs, power)
        other, one = np.unravel_index(costs.argmin(), costs.shape)
        yield _step(labels, count, costs[other, one], labels == one, labels == other, power)
        names = np.arange(count, dtype=np.int32)
        names[other:] -= 1
        names[other] = one
        labels = names[labels]
        if count <= renewed:
            labels = refit_labels(together, labels, shape, 1, 1)
        else:
            joined = zip(pairs, projected, strict=True)
            pairs = [each.join(int(one), int(other), planes, labels, shape) for each, planes in joined]
    yield Step(np.zeros_like(labels), 1, np.inf)


def _discriminants(
    sets: Sequence[Float32[np.ndarray, "_ n"]], labels: Int32[np.ndarray, "n"], shares: Float32[np.ndarray, "n"]
) -> tuple[Float32[np.ndarray, "_ n"], list[Float32[np.ndarray, "_ n"]]]:
    """Return the discriminating features of all sets, and of each set in which clusters differ: views of the former."""
    together, each = project([axes_between(each, labels, shares) for each in sets], sets)
    return together, [one for one in each if len(one)]


def project(
    axes: Sequence[Float64[np.ndarray, "_ _"]], sets: Sequence[Float32[np.ndarray, "_ n"]]
) -> tuple[Float32[np.ndarray, "_ n"], list[Float32[np.ndarray, "_ n"]]]:
    """Return the coordinates of cells along the axes of all sets, and those of each set: views, as copies are large."""
    together = np.zeros((sum(map(len, axes)), sets[0].shape[1]), np.float32)
    each = np.split(together, np.cumsum([len(one) for one in axes])[:-1])
    for one, planes, out in zip(axes, sets, each, strict=True):
        add_planes(one, planes, out)
    return together, each


def _mean_costs(pairs: Sequence[Pairs], power: float) -> Float64[np.ndarray, "k k"]:
    """Return the geometric means of the costs in one set, or in two."""
    costs = pairs[0].joining_costs(power)
    return costs if len(pairs) == 1 else np.sqrt(costs * pairs[1].joining_costs(power))


def _step(
    labels: Int32[np.ndarray, "n"],
    count: int,
    cost: float,
    one: Bool[np.ndarray, "n"],
    other: Bool[np.ndarray, "n"],
    power: float,
) -> Step:
    a, b = np.count_nonzero(one), np.count_nonzero(other)
    size = a * b / (a + b) / labels.size
    return Step(labels, count, float(cost), float(cost) / (size * count) ** power, size)


def axes_between(
    planes: Float32[np.ndarray, "d n"], labels: Int32[np.ndarray, "n"], shares: Float32[np.ndarray, "n"]
) -> Float64[np.ndarray, "a d"]:
    """Return the axes along which clusters differ most, at most AXES. shares: those of `interior_shares`."""
    return discriminant_axes(scatters(planes, one_hot(labels, int(labels.max()) + 1) * shares**2), AXES)
