"""k-means clustering by Lloyd's rounds. Compiled by numba."""

from collections.abc import Iterable
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import Float32, Int32

from tangible_core.compiled import in_turns, njit

SAME = 1e-5
"""The largest distance of equal rows, as a share of the longest row: the rounding of sums in single precision."""
SIDE_BY_SIDE = 64
"""The number of rows whose distances are computed together, in vector instructions."""
BLOCK = 4096
"""The number of rows summed together: fixed, so that the result does not depend on the number of threads."""


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
