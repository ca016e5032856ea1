"""Joining of clusters of one texture: the least different pair first, refitting in between."""

from collections.abc import Iterator, Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float32, Float64, Int32, Int64

from tangible_core.compiled import cholesky, njit, whiten

from .discriminants import discriminant_axes, one_hot, scatters
from .neighbourhood import INSIDE_CELLS, interior_shares, refit_labels, smooth_memberships
from .planes import add_planes, inner_products, scatter_matrix_in_kernel

# The ridge added to each pair's scatter, as a share of the mean variance within clusters.
RIDGE = 0.05
# What is added to the weight of every cell, so that no cluster weighs nothing.
MIN_WEIGHT = 1e-3


class Pairs(NamedTuple):
    """Clusters and their distances."""

    sizes: Int64[np.ndarray, "k"]
    means: Float64[np.ndarray, "k a"]
    scatters: Float64[np.ndarray, "k a a"]
    ridge: float
    # The squared Mahalanobis distances between means, each in the mean scatter of the two clusters.
    distances: Float64[np.ndarray, "k k"]

    def joining_costs(self, power: float) -> Float64[np.ndarray, "k k"]:
        """Compute D (m k / n)^power of each pair of k clusters, the higher label first; infinite elsewhere; n cells."""
        count = len(self.sizes)
        higher, lower = np.tril_indices(count, -1)
        a, b = self.sizes[higher], self.sizes[lower]
        # m = a b / (a + b) combines the sizes; D is the distance.
        shares = a * b / (a + b) * count / self.sizes.sum()
        powers = [share**power for share in shares.tolist()]  # NumPy's of an array have other last bits with AVX-512
        costs = np.full((count, count), np.inf)
        costs[higher, lower] = self.distances[higher, lower] * powers
        return costs

    def join(
        self,
        lower: int,
        higher: int,
        planes: Float32[np.ndarray, "a n"],
        labels: Int32[np.ndarray, "n"],
        shape: tuple[int, int],
    ) -> "Pairs":
        """Join two clusters, whose `labels` are joined already; the ridge and the distances between all others stay."""
        inside = labels == lower
        shares = smooth_memberships(inside[None].astype(np.float32), shape, INSIDE_CELLS)[0, inside]
        size = np.array([shares.size])
        cells = np.ascontiguousarray(planes[:, inside])
        means, scatters = _moments(cells, _weights(shares), np.zeros(1, np.int64), size)
        remaining = np.delete(np.arange(len(self.sizes)), higher)
        pairs = self._replace(
            sizes=self.sizes[remaining],
            means=self.means[remaining],
            scatters=self.scatters[remaining],
            distances=self.distances[np.ix_(remaining, remaining)],
        )
        pairs.sizes[lower], pairs.means[lower], pairs.scatters[lower] = size[0], means[0], scatters[0]
        _fill_distances(pairs.means, pairs.scatters, pairs.ridge, lower, len(remaining), pairs.distances)
        return pairs


def measure_pairs(
    planes: Float32[np.ndarray, "a n"], labels: Int32[np.ndarray, "n"], shares: Float32[np.ndarray, "n"]
) -> Pairs:
    """Compute the moments and distances of clusters 0..k-1. shares: those of `interior_shares`."""
    order, sizes = np.argsort(labels, kind="stable"), np.bincount(labels)
    means, scatters = _moments(
        np.ascontiguousarray(planes[:, order]), _weights(shares[order]), np.cumsum(sizes) - sizes, sizes
    )
    ridge = RIDGE * np.einsum("k,kii->", sizes, scatters) / sizes.sum() / len(planes) + 1e-9
    distances = np.zeros((sizes.size, sizes.size))
    for cluster in range(sizes.size):
        _fill_distances(means, scatters, ridge, cluster, cluster, distances)
    return Pairs(sizes, means, scatters, float(ridge), distances)


def _weights(shares: Float32[np.ndarray, "m"]) -> Float32[np.ndarray, "m"]:
    return shares**2 + np.float32(MIN_WEIGHT)


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
def _fill_distances(means, scatters, ridge, one, count, distances):
    """Compute d' S^-1 d of one cluster and the first `count`, as |L^-1 d|^2 with Cholesky's factor L of S."""
    size = means.shape[1]
    for other in range(count):
        if other == one:
            continue
        factor = cholesky((scatters[one] + scatters[other]) / 2 + ridge * np.eye(size))
        distance = np.square(whiten(factor, means[one : one + 1] - means[other : other + 1])).sum()
        distances[one, other] = distances[other, one] = distance


AXES = 20
# Exponents of two clusters' sizes in their joining's cost, 1 in Ward's method: the few may differ in size.
FEW_POWER, MANY_POWER, MANY = 0.4, 0.8, 8


class Step(NamedTuple):
    """A division into clusters, and the cost of the next joining."""

    labels: Int32[np.ndarray, "n"]
    clusters: int
    cost: float  # the cost by `Pairs.joining_costs`; infinite where there is one cluster only
    distance: float = np.inf  # the squared Mahalanobis distance between the two that are joined next
    size: float = 0.0


def join_clusters(
    sets: Sequence[Float32[np.ndarray, "_ n"]],
    labels: Int32[np.ndarray, "n"],
    shape: tuple[int, int],
    renewal_count: int,
    power: float = FEW_POWER,
) -> Iterator[Step]:
    """Yield divisions into ever fewer clusters, down to one: one less at least in each, one at once if none differ."""
    together, projections = _discriminants(sets, labels, interior_shares(labels, shape))
    labels = refit_labels(together, labels, shape, 2, 1) if projections else labels
    pairs: list[Pairs] = []
    # From `renewed` clusters down, discriminants are computed again before each joining, and cells settle with their
    # neighbours after it; before, those of the first division are used. Each set of features has its own discriminants;
    # a joining costs the geometric mean of its costs in each.
    while (count := int(labels.max()) + 1) > 1:
        if not pairs or count <= renewal_count:
            shares = interior_shares(labels, shape)
            if count <= renewal_count:
                together, projections = _discriminants(sets, labels, shares)
            if not projections:
                break
            pairs = [measure_pairs(planes, labels, shares) for planes in projections]
        costs = pairs[0].joining_costs(power)
        if len(pairs) == 2:
            costs = np.sqrt(costs * pairs[1].joining_costs(power))
        other, one = np.unravel_index(costs.argmin(), costs.shape)
        yield _step(labels, count, costs[other, one], labels == one, labels == other, power)
        names = np.arange(count, dtype=np.int32)
        names[other:] -= 1
        names[other] = one
        labels = names[labels]
        if count <= renewal_count:
            labels = refit_labels(together, labels, shape, 1, 1)
        else:
            sides = zip(pairs, projections, strict=True)
            pairs = [side.join(int(one), int(other), planes, labels, shape) for side, planes in sides]
    yield Step(np.zeros_like(labels), 1, np.inf)


def _discriminants(
    sets: Sequence[Float32[np.ndarray, "_ n"]], labels: Int32[np.ndarray, "n"], shares: Float32[np.ndarray, "n"]
) -> tuple[Float32[np.ndarray, "_ n"], list[Float32[np.ndarray, "_ n"]]]:
    """Return the discriminating features of all sets, and of each set in which clusters differ: views of the former."""
    together, parts = project([axes_between(planes, labels, shares) for planes in sets], sets)
    return together, [part for part in parts if len(part)]


def project(
    axes: Sequence[Float64[np.ndarray, "_ _"]], sets: Sequence[Float32[np.ndarray, "_ n"]]
) -> tuple[Float32[np.ndarray, "_ n"], list[Float32[np.ndarray, "_ n"]]]:
    """Return the coordinates of cells along the axes of all sets, and those of each set: views, as copies are large."""
    together = np.zeros((sum(map(len, axes)), sets[0].shape[1]), np.float32)
    parts = np.split(together, np.cumsum([len(one) for one in axes])[:-1])
    for one, planes, out in zip(axes, sets, parts, strict=True):
        add_planes(one, planes, out)
    return together, parts


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
