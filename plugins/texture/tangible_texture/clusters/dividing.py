"""The initial division of cells into many clusters, without chance."""

import numpy as np
from jaxtyping import Float32, Int32

from tangible_core.compiled import eigen

from .planes import combine_planes, inner_products, scatter_matrix

ROUNDS = 8
"""The largest number of Lloyd's rounds: joining corrects the rest."""


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
    """Return the sum of squared distances from the mean, and a mask of the columns above it on the longest axis."""
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
