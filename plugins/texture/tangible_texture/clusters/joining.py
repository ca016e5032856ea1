"""Joining of clusters of one texture: the least different pair first, refitting in between."""

# ruff: noqa: ANN001, ANN202 -- numba takes the types from the call

from collections.abc import Iterator
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int32

from tangible_core.compiled.compiling import njit
from tangible_core.compiled.small_matrices import cholesky, whiten

from .discriminants import discriminant_axes
from .dividing import one_hot
from .neighbourhood import INSIDE_CELLS, interior_scatters, refit_labels, smooth_memberships
from .planes import combine_planes, inner_products, scatter_matrix_in_kernel

AXES = 20
"""The largest number of discriminants."""
FEW_POWER, MANY_POWER, MANY = 0.4, 0.8, 8
"""The exponent of the sizes of two clusters in the cost of joining them, and that for MANY segments or more.

It is 1 in Ward's method. Few regions may differ in size; of many, few are much larger than the others.
"""
RIDGE = 0.05
"""The ridge added to each pair's scatter, as a share of the mean variance within clusters."""


class Step(NamedTuple):
    """A division into clusters, and the cost of the next joining."""

    labels: Int32[np.ndarray, "n"]
    clusters: int
    cost: float
    """The cost by `joining_costs`; infinite where there is one cluster only."""
    distance: float = np.inf
    """The squared Mahalanobis distance between the two that are joined next."""
    size: float = 0.0
    """Their combined size a b / (a + b), as a share of all cells."""


def join_clusters(
    planes: Float32[np.ndarray, "d n"],
    labels: Int32[np.ndarray, "n"],
    shape: tuple[int, int],
    renewed: int,
    power: float = FEW_POWER,
) -> Iterator[Step]:
    """Yield divisions into ever fewer clusters, down to one: one less at least in each, one at once if none differ.

    renewed: from this number of clusters down, discriminants are recomputed before each joining, and cells settle with
    their neighbours after it. Before that, the discriminants of the first division are used. power: the exponent of
    sizes.
    """
    projected = combine_planes(axes_between(planes, labels, shape), planes)
    labels = refit_labels(projected, labels, shape, 2, 1) if len(projected) else labels
    while (count := int(labels.max()) + 1) > 1:
        if count <= renewed:
            projected = combine_planes(axes_between(planes, labels, shape), planes)
        if not len(projected):
            break
        costs = joining_costs(projected, labels, shape, power)
        other, one = np.unravel_index(costs.argmin(), costs.shape)
        yield _step(labels, count, costs[other, one], labels == one, labels == other, power)
        names = np.arange(count, dtype=np.int32)
        names[other:] -= 1
        names[other] = one
        labels = names[labels]
        if count <= renewed:
            labels = refit_labels(projected, labels, shape, 1, 1)
    yield Step(np.zeros_like(labels), 1, np.inf)


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
    planes: Float32[np.ndarray, "d n"], labels: Int32[np.ndarray, "n"], shape: tuple[int, int]
) -> Float64[np.ndarray, "a d"]:
    """Return the axes along which clusters differ most, at most AXES."""
    return discriminant_axes(interior_scatters(planes, one_hot(labels, int(labels.max()) + 1), shape), AXES)


def joining_costs(
    planes: Float32[np.ndarray, "d n"],
    labels: Int32[np.ndarray, "n"],
    shape: tuple[int, int],
    power: float = FEW_POWER,
) -> Float64[np.ndarray, "k k"]:
    """Compute D (m k / n)^power for each pair once, the higher label first; infinite elsewhere.

    D is the squared Mahalanobis distance of the two means in the mean of the two scatters; m = a b / (a + b) combines
    their sizes, of k clusters and n cells.
    """
    count = int(labels.max()) + 1
    own = one_hot(labels, count)
    weights = smooth_memberships(own, shape, INSIDE_CELLS)[labels, np.arange(labels.size)] ** 2 + np.float32(1e-3)
    order = np.argsort(labels, kind="stable")
    sizes = np.bincount(labels, minlength=count)
    means, scatter = _moments(np.ascontiguousarray(planes[:, order]), weights[order], np.cumsum(sizes) - sizes, sizes)
    ridge = RIDGE * np.einsum("k,kii->", sizes, scatter) / sizes.sum() / len(planes) + 1e-9
    joined = sizes[:, None] * sizes / (sizes[:, None] + sizes) * count / labels.size
    costs = _distances(means, scatter, ridge) * _powers(joined, power)
    costs[np.triu_indices(count)] = np.inf
    return costs


def _powers(sizes: Float64[np.ndarray, "k k"], power: float) -> Float64[np.ndarray, "k k"]:
    """Raise one value after another: NumPy's powers of an array have other last bits where AVX-512 is."""
    return np.array([[size**power for size in row] for row in sizes.tolist()])


@njit(cache=True, nogil=True)
def _moments(planes, weights, starts, sizes):
    """Compute weighted mean and scatter of every cluster, whose cells are contiguous."""
    size = planes.shape[0]
    means, scatters = np.zeros((sizes.size, size)), np.zeros((sizes.size, size, size))
    for k in range(sizes.size):
        inside = slice(starts[k], starts[k] + sizes[k])
        own, heavy = np.ascontiguousarray(planes[:, inside]), weights[inside]
        means[k] = inner_products(heavy.reshape(1, -1), own)[0] / heavy.sum()
        scatters[k] = scatter_matrix_in_kernel(own, heavy) / heavy.sum() - np.outer(means[k], means[k])
    return means, scatters


@njit(cache=True, nogil=True)
def _distances(means, scatters, ridge):
    """Compute d' S^-1 d of every two clusters, as |L^-1 d|^2 with Cholesky's factor L of S."""
    count, size = means.shape
    distances = np.zeros((count, count))
    for one in range(count):
        for other in range(one):
            factor = cholesky((scatters[one] + scatters[other]) / 2 + ridge * np.eye(size))
            distances[one, other] = np.square(whiten(factor, means[one : one + 1] - means[other : other + 1])).sum()
            distances[other, one] = distances[one, other]
    return distances
