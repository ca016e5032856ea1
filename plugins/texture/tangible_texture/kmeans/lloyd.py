"""k-means clustering by Lloyd's rounds, compiled by numba; a label map of it, and an estimated number of textures."""

import logging
from collections.abc import Iterable
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float32, Int32

from tangible_core.compiled import in_turns, njit
from tangible_core.data import SegmentMap
from tangible_core.plugins import note

from ..clusters.planes import combine_planes
from ..regions.merging import number_in_reading_order

# The largest distance of equal rows, as a share of the longest row: the rounding of sums in single precision.
SAME = 1e-5
SIDE_BY_SIDE = 64  # the number of rows whose distances are computed together, in vector instructions
# The number of rows summed together: fixed, so that the result does not depend on the number of threads.
BLOCK = 4096


class Clusters(NamedTuple):
    """The cluster of each row, the clusters' means, and the sum of squared distances of the rows from these."""

    labels: Int32[np.ndarray, "n"]
    centres: Float32[np.ndarray, "k d"]
    cost: float


def kmeans(
    rows: Float32[np.ndarray, "n d"],
    clusters: int,
    restarts: int = 1,
    seed: int = 0,
    start: Literal["plus-plus", "random"] = "plus-plus",
    rounds: int = 1000,
) -> Clusters:
    """Return the cheapest of `restarts` runs of Lloyd's rounds; never more clusters than distinct rows (see SAME)."""
    rows = np.ascontiguousarray(rows, np.float32)
    random = np.random.default_rng(seed)
    least = np.float32((SAME * float(np.sqrt(np.square(rows).sum(axis=1).max(initial=0)))) ** 2)
    # k-means++ draws with weights of squared distances from earlier rows (Arthur & Vassilvitskii, SODA 2007).
    runs = (
        _settle(rows, _start(rows, random.random(clusters), start == "plus-plus", least), rounds)
        for _ in range(restarts)
    )
    return min(runs, key=lambda run: run.cost)


def _settle(rows: Float32[np.ndarray, "n d"], centres: Float32[np.ndarray, "k d"], rounds: int) -> Clusters:
    labels = np.full(len(rows), -1, np.int32)
    blocks = [slice(first, first + BLOCK) for first in range(0, len(rows), BLOCK)]
    sums = np.empty((len(blocks), *centres.shape))
    counts = np.empty((len(blocks), len(centres)), np.int64)
    costs, move_counts = np.empty(len(blocks)), np.empty(len(blocks), np.int64)

    def work(share: Iterable[int]) -> None:
        for i in share:
            costs[i], move_counts[i] = _assign(rows[blocks[i]], centres, labels[blocks[i]], sums[i], counts[i])

    for _ in range(rounds):
        in_turns(list(range(len(blocks))), work)
        if not move_counts.any():
            break
        members = counts.sum(axis=0)
        has_members = members > 0
        centres[has_members] = sums.sum(axis=0)[has_members] / members[has_members, None]
    has_members = counts.sum(axis=0) > 0
    return Clusters((np.cumsum(has_members, dtype=np.int32) - 1)[labels], centres[has_members], float(costs.sum()))


@njit(cache=True, nogil=True)
def _start(rows, uniform, is_weighted, least):
    """Draw one starting row for each value of `uniform`; fewer if there are not as many distinct rows."""
    count = len(rows)
    centres = np.empty((len(uniform), rows.shape[1]), np.float32)
    centres[0] = rows[int(uniform[0] * count)]
    away = np.full(count, np.float32(np.inf))
    for k in range(1, len(uniform)):
        total = 0.0
        for i in range(count):
            away[i] = min(away[i], _squared_distance(rows[i], centres[k - 1]))
            if away[i] > least:
                total += away[i] if is_weighted else 1.0
        if total == 0.0:
            return centres[:k].copy()
        rest, choice = uniform[k] * total, 0
        for i in range(count):
            # The last candidate stays if rounding leaves a rest: a row is always chosen.
            if away[i] > least:
                choice = i
                rest -= away[i] if is_weighted else 1.0
                if rest < 0:
                    break
        centres[k] = rows[choice]
    return centres


@njit(cache=True, nogil=True)
def _squared_distance(one, other):
    total = np.float32(0)
    for d in range(one.size):
        step = one[d] - other[d]
        total += step * step
    return total


@njit(cache=True, nogil=True)
def _assign(rows, centres, labels, sums, counts):
    """Write each row's nearest centre and the sums of rows by centre; return the cost and the number of new labels."""
    sums[:] = 0
    counts[:] = 0
    cost, move_count = 0.0, 0
    upright = np.zeros((rows.shape[1], SIDE_BY_SIDE), np.float32)
    away = np.empty((len(centres), SIDE_BY_SIDE), np.float32)
    for first in range(0, len(rows), SIDE_BY_SIDE):
        # Rows stand upright in blocks, so that the distances of many rows to a centre are vectorised. Of equally near
        # centres the first one wins.
        part = rows[first : first + SIDE_BY_SIDE]
        for d in range(part.shape[1]):
            for i in range(len(part)):
                upright[d, i] = part[i, d]
        for k in range(len(centres)):
            _squared_distances(upright, centres[k], away[k])
        for i in range(len(part)):
            at = 0
            for k in range(1, len(centres)):
                at = k if away[k, i] < away[at, i] else at
            move_count += labels[first + i] != at
            labels[first + i] = at
            cost += away[at, i]
            counts[at] += 1
            for d in range(part.shape[1]):
                sums[at, d] += part[i, d]
    return cost, move_count


@njit(cache=True, nogil=True)
def _squared_distances(columns, centre, away):
    """Compute `_squared_distance` of SIDE_BY_SIDE columns; no order of sums depends on the processor's vectors."""
    away[:] = 0
    for d in range(0, centre.size - 3, 4):  # four at a time: a quarter of the writes
        p, q, r, s = centre[d], centre[d + 1], centre[d + 2], centre[d + 3]
        for i in range(SIDE_BY_SIDE):
            one, two = columns[d, i] - p, columns[d + 1, i] - q
            three, four = columns[d + 2, i] - r, columns[d + 3, i] - s
            away[i] = away[i] + one * one + two * two + three * three + four * four
    for d in range(centre.size // 4 * 4, centre.size):
        for i in range(SIDE_BY_SIDE):
            step = columns[d, i] - centre[d]
            away[i] += step * step


# The number of rows in the estimate: the cost of silhouettes grows with its square.
SAMPLE = 1500
APART = 0.25
"""The least mean silhouette that indicates structure (Kaufman & Rousseeuw, Finding groups in data, 1990, sec. 2.2)."""


def choose_count(features: Float32[np.ndarray, "n d"], most: int, seed: int = 0) -> tuple[int, float, str]:
    """Choose the number of clusters with the greatest mean silhouette, with a confidence and the reason in words."""
    # Source: Rousseeuw, Silhouettes, J. Comput. Appl. Math. 20 (1987). No known rule transfers from one set of textures
    # to another: on mosaics of natural ones this is right in 3 of 10 cases, off by one at most in 7 of 10.
    rows = features[np.random.default_rng(seed).permutation(len(features))[:SAMPLE]]
    scores: dict[int, float] = {}
    for count in range(2, most + 1):
        clustering = kmeans(rows, count, restarts=3, seed=seed)
        if len(clustering.centres) < count:
            break
        scores[count] = _silhouette(rows, clustering.labels)
    best = max(scores, key=lambda count: scores[count], default=1)
    score = scores.get(best, 0.0)
    if score < APART:
        return 1, 1 - max(score, 0) / APART, "the features do not separate into groups"
    return best, (score - APART) / (1 - APART), f"{best} groups have the greatest mean silhouette, {score:.2f}"


def _silhouette(rows: Float32[np.ndarray, "n d"], labels: np.ndarray) -> float:
    """Return the mean of (b - a) / max(a, b), a and b being mean distances to the own and the nearest other cluster."""
    squares = np.square(rows).sum(axis=1)
    away = np.sqrt(np.maximum(squares[:, None] + squares - 2 * combine_planes(rows, np.ascontiguousarray(rows.T)), 0))
    sizes = np.bincount(labels)
    sums = np.stack([away[:, labels == label].sum(axis=1) for label in range(len(sizes))], axis=1)
    row = np.arange(len(rows))
    own = sums[row, labels] / np.maximum(sizes[labels] - 1, 1)
    means = sums / sizes
    means[row, labels] = np.inf
    other = means.min(axis=1)
    larger = np.maximum(np.maximum(own, other), np.finfo(np.float32).tiny)
    return float(np.where(sizes[labels] > 1, (other - own) / larger, 0).mean())


log: logging.Logger = logging.getLogger(__name__)
MAX_SEGMENTS = 8


def choose_segments(rows: Float32[np.ndarray, "n d"], segments: int | Literal["auto"], seed: int) -> int:
    """Return the requested number, or for `auto` an estimate, reported with its confidence."""
    if segments != "auto":
        return segments
    number, confidence, reason = choose_count(rows, MAX_SEGMENTS, seed)
    note(log, f"segments: {number}, estimated with confidence {confidence:.2f}: {reason}")
    return number


def segment_by_kmeans(
    features: Float32[np.ndarray, "rows columns d"],
    step_px: int,
    shape: tuple[int, int],
    segments: int | Literal["auto"],
    seed: int,
    start: Literal["plus-plus", "random"] = "plus-plus",
    restarts: int = 1,
) -> SegmentMap:
    """Cluster features sampled every step_px pixels, and give every pixel of (h, w) the label of its cell."""
    rows = features.reshape(-1, features.shape[2])
    clustering = kmeans(rows, choose_segments(rows, segments, seed), restarts, seed, start)
    return label_map_of_cells(
        clustering.labels.reshape(features.shape[:2]), margins(rows, clustering.centres), step_px, shape
    )


def label_map_of_cells(
    labels: Int32[np.ndarray, "rows columns"], trust: Float32[np.ndarray, "n"], step_px: int, shape: tuple[int, int]
) -> SegmentMap:
    """Repeat labels and confidence of cells for (h, w) pixels; labels are in the order of their first pixels."""
    cells = np.ix_(*(np.arange(side) // step_px for side in shape))
    return SegmentMap(number_in_reading_order(labels.astype(np.int32))[cells], trust.reshape(labels.shape)[cells])


def margins(rows: Float32[np.ndarray, "n d"], centres: Float32[np.ndarray, "k d"]) -> Float32[np.ndarray, "n"]:
    """Return 1 - a / b of each row, a and b being its distances from the two nearest centres; 1 for one centre."""
    if len(centres) == 1:
        return np.ones(len(rows), np.float32)
    away = np.stack([np.sqrt(np.square(rows - centre).sum(axis=1)) for centre in centres], axis=1)
    near, next_near = np.partition(away, 1, axis=1)[:, :2].T
    return 1 - near / np.maximum(next_near, np.finfo(np.float32).tiny)
