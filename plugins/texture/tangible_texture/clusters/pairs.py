"""Distances between all pairs of clusters, which stay known while clusters are joined."""

# ruff: noqa: ANN001, ANN202 -- numba takes the types from the call

from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Float64, Int32, Int64

from tangible_core.compiled.compiling import njit
from tangible_core.compiled.small_matrices import cholesky, whiten

from .neighbourhood import INSIDE_CELLS, smooth_memberships
from .planes import inner_products, scatter_matrix_in_kernel

RIDGE = 0.05
"""The ridge added to each pair's scatter, as a share of the mean variance within clusters."""
LEAST_WEIGHT = 1e-3
"""What is added to the weight of every cell, so that no cluster weighs nothing."""


class Pairs(NamedTuple):
    """Clusters and their distances."""

    sizes: Int64[np.ndarray, "k"]
    """The number of cells of each cluster."""
    means: Float64[np.ndarray, "k a"]
    scatters: Float64[np.ndarray, "k a a"]
    ridge: float
    """The ridge added to the mean scatter of two clusters."""
    distances: Float64[np.ndarray, "k k"]
    """The squared Mahalanobis distances between means, each in the mean scatter of the two clusters."""

    def joining_costs(self, power: float) -> Float64[np.ndarray, "k k"]:
        """Compute D (m k / n)^power for each pair once, the higher label first; infinite elsewhere.

        D is the distance; m = a b / (a + b) combines the sizes, of k clusters and n cells.
        """
        count = len(self.sizes)
        higher, lower = np.tril_indices(count, -1)
        a, b = self.sizes[higher], self.sizes[lower]
        powers = _powers(a * b / (a + b) * count / self.sizes.sum(), power)
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
        """Join two clusters; the ridge is kept, and so are distances between all others.

        labels: those after the joining, where the two are called `lower`, and higher labels are one less.
        """
        inside = labels == lower
        shares = smooth_memberships(inside[None].astype(np.float32), shape, INSIDE_CELLS)[0, inside]
        size = np.array([shares.size])
        cells = np.ascontiguousarray(planes[:, inside])
        means, scatters = _moments(cells, _weights(shares), np.zeros(1, np.int64), size)
        kept = np.delete(np.arange(len(self.sizes)), higher)
        joined = self._replace(
            sizes=self.sizes[kept],
            means=self.means[kept],
            scatters=self.scatters[kept],
            distances=self.distances[np.ix_(kept, kept)],
        )
        joined.sizes[lower], joined.means[lower], joined.scatters[lower] = size[0], means[0], scatters[0]
        _fill_distances(joined.means, joined.scatters, joined.ridge, lower, len(kept), joined.distances)
        return joined


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
    for each in range(sizes.size):
        _fill_distances(means, scatters, ridge, each, each, distances)
    return Pairs(sizes, means, scatters, float(ridge), distances)


def _weights(shares: Float32[np.ndarray, "m"]) -> Float32[np.ndarray, "m"]:
    return shares**2 + np.float32(LEAST_WEIGHT)


def _powers(values: Float64[np.ndarray, "p"], power: float) -> Float64[np.ndarray, "p"]:
    """Raise one value after another: NumPy's powers of an array have other last bits where AVX-512 is."""
    return np.array([value**power for value in values.tolist()])


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
