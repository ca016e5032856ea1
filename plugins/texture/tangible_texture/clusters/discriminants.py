"""The division of cells into clusters, linear discriminants of classes, and a cell's evidence for each class."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Float64, Int32

from tangible_core.compiled import eigen, solve

from .planes import combine_planes, inner_products, scatter_matrix

ROUNDS = 8  # the largest number of Lloyd's rounds: joining corrects the rest


def divide(planes: Float32[np.ndarray, "d n"], most: int) -> Int32[np.ndarray, "n"]:
    """Halve the widest cluster across its longest axis until there are `most`, then run Lloyd's rounds."""
    # Nothing depends on the order of the cells, nor on a seed. Source: Su & Dy, A deterministic method for initializing
    # k-means clustering, ICTAI 2004 (PCA-Part).
    parts = [np.arange(planes.shape[1])]
    halves = [_halve_cluster(planes)]
    while len(parts) < most:
        widest = max(range(len(parts)), key=lambda i: halves[i][0])
        spread, upper = halves[widest]
        if spread <= 1e-6 * planes.shape[1]:
            break
        for part in (parts[widest][upper], parts[widest][~upper]):
            parts.append(part)
            halves.append(_halve_cluster(np.ascontiguousarray(planes[:, part])))
        del parts[widest], halves[widest]
    centres = np.stack([planes[:, part].mean(axis=1, dtype=np.float64) for part in parts])
    return _lloyd_rounds(planes, centres)


def _halve_cluster(planes: Float32[np.ndarray, "d n"]) -> tuple[float, np.ndarray]:
    deviations = planes - planes.mean(axis=1, keepdims=True)
    moments = scatter_matrix(deviations, np.ones(planes.shape[1], np.float32))
    return float(np.trace(moments)), combine_planes(eigen(moments)[1][:1], deviations)[0] > 0


def _lloyd_rounds(planes: Float32[np.ndarray, "d n"], centres: np.ndarray) -> Int32[np.ndarray, "n"]:
    """Run at most ROUNDS of Lloyd's rounds; a cluster without cells is dropped."""
    labels = np.full(planes.shape[1], -1)
    for _ in range(ROUNDS):
        heights = 0.5 * np.square(centres).sum(axis=1, keepdims=True).astype(np.float32)
        before, labels = labels, (combine_planes(centres, planes) - heights).argmax(axis=0)
        if np.array_equal(before, labels):
            break
        _, labels, counts = np.unique(labels, return_inverse=True, return_counts=True)
        centres = inner_products(one_hot(labels, counts.size), planes) / counts[:, None]
    return labels.astype(np.int32)


def one_hot(labels: np.ndarray, count: int) -> Float32[np.ndarray, "k n"]:
    """Return 1 where a cell has the label, else 0: one row a label."""
    return np.asarray(labels == np.arange(count)[:, None], np.float32)


SHRUNK = 0.05
"""The share of the mean variance within classes and of the total scatter added to the scatter within classes."""
# The number of cells whose share of all cells is the least shrinkage: few cells estimate the scatter poorly.
CELLS = 200


class Scatters(NamedTuple):
    """Weighted means of classes, their shares, and scatter within them, shrunk, per unit of weight."""

    means: Float64[np.ndarray, "k d"]
    shares: Float64[np.ndarray, "k"]
    within: Float64[np.ndarray, "d d"]


def scatters(planes: Float32[np.ndarray, "d n"], weights: Float32[np.ndarray, "k n"]) -> Scatters:
    """Compute the scatters of classes from each cell's weights; their sum is the cell's total weight."""
    counts = weights.sum(axis=1, dtype=np.float64) + 1e-3
    shares = counts / counts.sum()
    means = inner_products(weights, planes) / counts[:, None]
    centre = np.einsum("k,kd->d", shares, means)
    total = scatter_matrix(planes, weights.sum(axis=0)) / counts.sum() - np.outer(centre, centre)
    between = np.einsum("kd,ke->de", shares[:, None] * (means - centre), means - centre)
    within = total - between
    # Fisher's discriminant for several classes (Rao, J. Royal Stat. Soc. B 10, 1948), its scatter within classes shrunk
    # towards a multiple of the identity and a share of the total scatter.
    shrunk = min(1.0, max(SHRUNK, CELLS / planes.shape[1]))
    ridge = shrunk * max(np.trace(within) / len(within), 1e-6)
    return Scatters(means, shares, within + shrunk * total + ridge * np.eye(len(within)))


def evidence(planes: Float32[np.ndarray, "d n"], fit: Scatters) -> Float32[np.ndarray, "k n"]:
    """Compute each cell's log likelihood of each class, Gaussians of one width, up to a common term."""
    towards = solve(fit.within, fit.means)
    heights = 0.5 * (fit.means * towards).sum(axis=1)
    return combine_planes(towards, planes) - heights.astype(np.float32)[:, None]


def discriminant_axes(fit: Scatters, most: int) -> Float64[np.ndarray, "m d"]:
    """Return the directions in which classes differ most, at most `most`, scaled to unit scatter within classes."""
    centre = np.einsum("k,kd->d", fit.shares, fit.means)
    apart = np.sqrt(fit.shares)[:, None] * (fit.means - centre)
    towards = solve(fit.within, apart)
    strengths, vectors = eigen(np.einsum("kd,jd->kj", apart, towards))
    strongest = np.flatnonzero(strengths > 1e-9)[:most]
    return np.einsum("ak,kd->ad", vectors[strongest] / np.sqrt(strengths[strongest])[:, None], towards)


def principal_axes(planes: Float32[np.ndarray, "d n"], most: int, power: float = 0.0) -> Float64[np.ndarray, "m d"]:
    """Return leading principal axes of centred planes, divided by variance ** power; none for constant planes."""
    values, vectors = eigen(scatter_matrix(planes, np.ones(planes.shape[1], np.float32)) / planes.shape[1])
    strongest = np.flatnonzero(values > 1e-6 * max(values[0], 1e-6))[:most]
    return vectors[strongest] * np.array([value**-power for value in values[strongest].tolist()])[:, None]
