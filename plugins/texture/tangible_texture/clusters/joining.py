"""Joining the clusters of one texture: the least different pair first, refitted after every step."""

# ruff: noqa: ANN001, ANN202 -- numba takes the types from the call

from collections.abc import Callable, Iterator
from math import exp
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Float64, Int32
from numba import njit

from tangible_core.compiled.small_matrices import factored, whitened

from .dividing import members
from .neighbourhood import INSIDE_CELLS, refitted, smoothed
from .planes import products, scatter

SIZE_POWER = 1.25
"""How much the sizes of two clusters speak against joining them; 1 in Ward's method."""
TOUCHING = 0.25
"""How much a long border between two clusters speaks for joining them: halves of one texture lie mixed."""
RIDGE = 0.05
"""Added to each pair's scatter, as a share of the mean variance within clusters."""


class Step(NamedTuple):
    """A division into clusters, and what joining the next two costs."""

    labels: Int32[np.ndarray, "n"]
    clusters: int
    cost: float
    """See `joining_costs`; infinite where there is one cluster only."""


def joining(
    planes: Float32[np.ndarray, "d n"], labels: Int32[np.ndarray, "n"], shape: tuple[int, int], votes: int
) -> Iterator[Step]:
    """Divisions into ever fewer clusters, one less at least in each, the last of one.

    votes: rounds in which cells settle with their neighbours after each step; 0 leaves them where they are.
    """
    while (count := int(labels.max()) + 1) > 1:
        costs = joining_costs(planes, labels, shape)
        other, one = np.unravel_index(costs.argmin(), costs.shape)
        yield Step(labels, count, float(costs[other, one]))
        names = np.arange(count, dtype=np.int32)
        names[other:] -= 1
        names[other] = one
        labels = names[labels]
        if votes:
            labels = refitted(planes, labels, shape, 1, votes)
    yield Step(labels, 1, np.inf)


def joining_costs(
    planes: Float32[np.ndarray, "d n"], labels: Int32[np.ndarray, "n"], shape: tuple[int, int]
) -> Float64[np.ndarray, "k k"]:
    """D (m k / n)^SIZE_POWER exp(-TOUCHING t), for each pair once, the higher label first; elsewhere infinite.

    D is the squared Mahalanobis distance of the two means in the mean of the two scatters; m = a b / (a + b) joins
    their sizes, of k clusters and n cells; t is the length of their border over the root of the smaller one's size.
    """
    count = int(labels.max()) + 1
    own = members(labels, count)
    weights = smoothed(own, shape, INSIDE_CELLS)[labels, np.arange(labels.size)] ** 2 + np.float32(1e-3)
    order = np.argsort(labels, kind="stable")
    sizes = np.bincount(labels, minlength=count)
    means, scatter = _moments(np.ascontiguousarray(planes[:, order]), weights[order], np.cumsum(sizes) - sizes, sizes)
    ridge = RIDGE * np.einsum("k,kii->", sizes, scatter) / sizes.sum() / len(planes) + 1e-9
    joined = sizes[:, None] * sizes / (sizes[:, None] + sizes) * count / labels.size
    touching = _borders(labels.reshape(shape), count) / np.sqrt(np.minimum(sizes[:, None], sizes))
    costs = _distances(means, scatter, ridge) * _each(lambda size: size**SIZE_POWER, joined)
    costs *= _each(lambda length: exp(-TOUCHING * length), touching)
    costs[np.triu_indices(count)] = np.inf
    return costs


def _each(function: Callable[[float], float], values: Float64[np.ndarray, "k k"]) -> Float64[np.ndarray, "k k"]:
    """Of one value after another: NumPy's powers of an array have other last bits where AVX-512 is."""
    return np.array([list(map(function, row)) for row in values.tolist()])


@njit(cache=True, nogil=True)
def _moments(planes, weights, starts, sizes):
    """Weighted mean and scatter of every cluster, whose cells lie side by side."""
    size = planes.shape[0]
    means, scatters = np.zeros((sizes.size, size)), np.zeros((sizes.size, size, size))
    for k in range(sizes.size):
        inside = slice(starts[k], starts[k] + sizes[k])
        own, heavy = np.ascontiguousarray(planes[:, inside]), weights[inside]
        means[k] = products(heavy.reshape(1, -1), own)[0] / heavy.sum()
        scatters[k] = scatter(own, heavy) / heavy.sum() - np.outer(means[k], means[k])
    return means, scatters


@njit(cache=True, nogil=True)
def _distances(means, scatters, ridge):
    """d' S^-1 d of every two, as |L^-1 d|^2 with Cholesky's factor L of S."""
    count, size = means.shape
    found = np.zeros((count, count))
    for one in range(count):
        for other in range(one):
            factor = factored((scatters[one] + scatters[other]) / 2 + ridge * np.eye(size))
            found[one, other] = np.square(whitened(factor, means[one : one + 1] - means[other : other + 1])).sum()
            found[other, one] = found[one, other]
    return found


@njit(cache=True, nogil=True)
def _borders(labels, count):
    """Pairs of cells beside each other, of every two clusters."""
    rows, columns = labels.shape
    found = np.zeros((count, count))
    for row in range(rows):
        for column in range(columns):
            for below, right in ((row + 1, column), (row, column + 1)):
                if below < rows and right < columns:
                    one, other = labels[row, column], labels[below, right]
                    found[one, other] += 1
                    found[other, one] += 1
    return found
