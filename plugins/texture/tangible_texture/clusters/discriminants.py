"""Linear discriminants: the features that separate classes, and the evidence of a cell for each class."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Float64

from tangible_core.compiled import eigen, solve

from .planes import combine_planes, inner_products, scatter_matrix

SHRUNK = 0.05
"""The share of the mean variance within classes and of the total scatter added to the scatter within classes."""
CELLS = 200
"""The number of cells whose share of all cells is the least shrinkage: few cells estimate the scatter poorly."""


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
