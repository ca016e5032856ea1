"""The agreement of segments with the true ones, regardless of their numbers."""

from math import hypot
from typing import Any

import numpy as np
from jaxtyping import Bool, Integer

from tangible_core.errors import PictureError

Labels = Integer[np.ndarray, "h w"]
Counts = Integer[np.ndarray, "n m"]


def segment_errors(labels: Labels, truth: Labels) -> dict[str, float]:
    """Compare two label maps, regardless of the numbers of their segments.

    Returns: `ari`, 0 on average for segments by chance; `accuracy` in 0..1; `boundary_px`; `segments` in the map.
    Raises: PictureError if the two differ in size, or are empty.
    """
    if labels.shape != truth.shape or labels.size == 0:
        raise PictureError(f"the labels are {labels.shape} and the true ones {truth.shape}; crop or scale one of them")
    counts = contingency(labels, truth)
    return {
        "ari": adjusted_rand_index(counts),
        "accuracy": matched_accuracy(counts),
        "boundary_px": boundary_distance(labels, truth),
        "segments": float(len(counts)),
    }


def contingency(labels: Labels, truth: Labels) -> Counts:
    """Count the pixels of each label with each true label: int64, (labels, true labels) that are present, in order."""
    (rows, row), (columns, column) = (np.unique(map_, return_inverse=True) for map_ in (labels, truth))
    cells = row.ravel() * columns.size + column.ravel()
    return np.bincount(cells, minlength=rows.size * columns.size).reshape(rows.size, columns.size)


def adjusted_rand_index(counts: Counts) -> float:
    """Return the share of pairs of pixels that both maps keep together, corrected for chance, 1 for equal maps.

    Source: Hubert & Arabie, Comparing partitions, Journal of Classification 2 (1985), eq. 5.
    """
    # (S - A B / T) / ((A + B) / 2 - A B / T) in whole numbers of any size, so that only the last division rounds.
    both, first, second, every = _pair_counts(counts)
    chance, most = 2 * first * second, (first + second) * every
    return 1.0 if most == chance else (2 * both * every - chance) / (most - chance)


def matched_accuracy(counts: Counts) -> float:
    """Return the share of the pixels on the best matching of labels; pixels of labels without a partner are wrong."""
    from scipy.optimize import linear_sum_assignment

    return float(counts[linear_sum_assignment(counts, maximize=True)].sum() / counts.sum())


def boundary_distance(labels: Labels, truth: Labels) -> float:
    """Return the distance between the borders of two maps in pixels, the mean of both directions.

    0 where neither map has a border; the picture's diagonal, which no distance exceeds, where only one has.
    """
    one, other = border_points(labels), border_points(truth)  # between two neighbours whose labels differ
    if not one.any() or not other.any():
        return hypot(*labels.shape) if one.any() or other.any() else 0.0
    return (_mean_distance(one, other) + _mean_distance(other, one)) / 2


def border_points(labels: Labels) -> Bool[np.ndarray, "r c"]:
    """Mark borders on a grid of half pixels, (2 h - 1, 2 w - 1): pixel (row, column) is at (2 row, 2 column)."""
    h, w = labels.shape
    borders = np.zeros((2 * h - 1, 2 * w - 1), np.bool_)
    borders[::2, 1::2] = labels[:, 1:] != labels[:, :-1]
    borders[1::2, ::2] = labels[1:] != labels[:-1]
    return borders


def _mean_distance(start: Bool[np.ndarray, "r c"], goal: Bool[np.ndarray, "r c"]) -> float:
    """Return the mean distance from the points of one set to the nearest of the other, in pixels."""
    from scipy.spatial import KDTree  # exact, unlike OpenCV's distance transform with several threads

    nearest: Any = KDTree(np.argwhere(goal))
    return float(nearest.query(np.argwhere(start))[0].mean()) / 2


def _pair_counts(counts: Counts) -> tuple[int, int, int, int]:
    """Count the pairs of pixels that are together in both maps, in the first, in the second, and all pairs."""
    both, first, second = (_pairs(part) for part in (counts, counts.sum(axis=1), counts.sum(axis=0)))
    return both, first, second, _pairs(np.asarray([counts.sum()]))


def _pairs(sizes: Counts | np.ndarray) -> int:
    """Count the pairs within groups of these sizes, as a Python integer, which does not overflow."""
    sizes = sizes.astype(np.int64)
    return int((sizes * (sizes - 1) // 2).sum())
