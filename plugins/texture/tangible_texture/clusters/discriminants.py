"""Linear discriminants: which features tell classes apart, and for which class a cell speaks.

Source: Fisher's discriminant for several classes (Rao, J. Royal Stat. Soc. B 10, 1948); the scatter within classes is
shrunk towards a multiple of the identity and a share of the total scatter.
"""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Float64

SHRUNK = 0.05
"""Of the mean variance within classes, and of the total scatter: added to the scatter within classes."""
CELLS = 200
"""So many cells, as a share of those there are, if that is more: of few cells the scatter is not known well."""


class Scatters(NamedTuple):
    """Weighted means of classes, their shares, and scatter within them, shrunk, per unit of weight."""

    means: Float64[np.ndarray, "k d"]
    shares: Float64[np.ndarray, "k"]
    within: Float64[np.ndarray, "d d"]


def scatters(planes: Float32[np.ndarray, "d n"], weights: Float32[np.ndarray, "k n"]) -> Scatters:
    """Of classes with these weights a cell, whose sum is what a cell counts."""
    from .planes import inner_products, scatter_matrix

    counts = weights.sum(axis=1, dtype=np.float64) + 1e-3
    shares = counts / counts.sum()
    means = inner_products(weights, planes) / counts[:, None]
    centre = np.einsum("k,kd->d", shares, means)
    total = scatter_matrix(planes, weights.sum(axis=0)) / counts.sum() - np.outer(centre, centre)
    between = np.einsum("kd,ke->de", shares[:, None] * (means - centre), means - centre)
    within = total - between
    shrunk = min(1.0, max(SHRUNK, CELLS / planes.shape[1]))
    ridge = shrunk * max(np.trace(within) / len(within), 1e-6)
    return Scatters(means, shares, within + shrunk * total + ridge * np.eye(len(within)))


def evidence(planes: Float32[np.ndarray, "d n"], fit: Scatters) -> Float32[np.ndarray, "k n"]:
    """How much each cell speaks for each class: log likelihoods of one Gaussian's width, but for what all share."""
    from tangible_core.compiled.small_matrices import solved

    from .planes import combine_planes

    towards = solved(fit.within, fit.means)
    heights = 0.5 * (fit.means * towards).sum(axis=1)
    return combine_planes(towards, planes) - heights.astype(np.float32)[:, None]


def discriminant_axes(fit: Scatters, most: int) -> Float64[np.ndarray, "m d"]:
    """The directions in which classes differ most, `most` or as many as there are, scaled to unit scatter within."""
    from tangible_core.compiled.small_matrices import eigen, solved

    centre = np.einsum("k,kd->d", fit.shares, fit.means)
    apart = np.sqrt(fit.shares)[:, None] * (fit.means - centre)
    towards = solved(fit.within, apart)
    strengths, vectors = eigen(np.einsum("kd,jd->kj", apart, towards))
    kept = np.flatnonzero(strengths > 1e-9)[:most]
    return np.einsum("ak,kd->ad", vectors[kept] / np.sqrt(strengths[kept])[:, None], towards)


def principal_axes(planes: Float32[np.ndarray, "d n"], most: int, power: float = 0.0) -> Float64[np.ndarray, "m d"]:
    """Leading principal axes of centred planes, each divided by its variance to this power; none for still planes."""
    from tangible_core.compiled.small_matrices import eigen

    from .planes import scatter_matrix

    values, vectors = eigen(scatter_matrix(planes, np.ones(planes.shape[1], np.float32)) / planes.shape[1])
    kept = np.flatnonzero(values > 1e-6 * max(values[0], 1e-6))[:most]
    return vectors[kept] * np.array([value**-power for value in values[kept].tolist()])[:, None]
