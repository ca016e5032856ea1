"""Neighbouring parts, and which of two is in front as far as T-junctions of their borders show."""

from math import sqrt
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64, Int32, Int64

from ..data import PartMap

# Radius of the disc in which the angles at a junction are measured, as a share of the picture's diagonal.
REACH = 0.012
MAX_JUNCTIONS, ACROSS = 20_000, 15
"""Largest number of junctions that are examined, evenly chosen, and points across the disc of each."""
STRAIGHT, THIN = 0.15, 0.08
"""Largest difference of a front part's share of the disc from a half, and smallest share of each of the three parts."""


class Neighbours(NamedTuple):
    """Pairs of parts with a common border, in order: `low` is the smaller number of a pair, `high` the larger."""

    low: Int64[np.ndarray, "m"]
    high: Int64[np.ndarray, "m"]
    sides: Int64[np.ndarray, "m"]  # length of the common border, in sides of pixels


def neighbours(parts: PartMap) -> Neighbours:
    """List the pairs of parts that share sides of pixels."""
    labels = parts.labels
    pairs = np.concatenate(
        [_pairs(labels[:, :-1], labels[:, 1:], parts.count), _pairs(labels[:-1], labels[1:], parts.count)]
    )
    keys, sides = np.unique(pairs, return_counts=True)
    low, high = np.divmod(keys, parts.count)
    return Neighbours(low, high, sides.astype(np.int64))


def _pairs(one: np.ndarray, other: np.ndarray, count: int) -> Int64[np.ndarray, "k"]:
    differ = one != other
    first, second = one[differ].astype(np.int64), other[differ].astype(np.int64)
    return np.minimum(first, second) * count + np.maximum(first, second)


def in_front(parts: PartMap, pairs: Neighbours) -> Float64[np.ndarray, "m"]:
    """Return, for each pair, the certainty that `high` is in front of `low`, -1 for the reverse to 1; 0 if unknown."""
    three, share = _junctions(parts.labels)
    if not len(three):
        return np.zeros(pairs.low.size)
    nearest = share.argmax(axis=1)
    rows = np.arange(len(three))
    # Where three parts meet, the one whose border runs straight on hides the border of the two others (Guzman,
    # Decomposition of a visual scene into three-dimensional bodies, 1968, the T-junction).
    sure = np.clip(1 - np.abs(share[rows, nearest] - 0.5) / STRAIGHT, 0, 1) * (share.min(axis=1) > THIN)
    keys = pairs.low * parts.count + pairs.high
    votes, weight = np.zeros(keys.size), np.ones(keys.size)
    for third in range(3):
        front, behind = three[rows, nearest], three[:, third]
        key = np.minimum(front, behind) * parts.count + np.maximum(front, behind)
        pair = np.minimum(np.searchsorted(keys, key), keys.size - 1)
        vote = np.where(keys[pair] == key, sure, 0)  # 0 for the front part itself, and for parts that touch at a corner
        votes += np.bincount(pair, np.where(front > behind, vote, -vote), keys.size)
        weight += np.bincount(pair, vote, keys.size)
    return votes / weight


def _junctions(labels: Int32[np.ndarray, "h w"]) -> tuple[Int64[np.ndarray, "k 3"], Float64[np.ndarray, "k 3"]]:
    """Return the three parts at each corner of pixels at which three meet, and their shares of a disc around it."""
    rows, columns = labels.shape
    radius = max(2, round(REACH * sqrt(rows * rows + columns * columns)))
    row, column = np.nonzero(_three_meet(labels))
    inside = (np.minimum(row, column) >= radius - 1) & (row < rows - radius) & (column < columns - radius)
    step = np.count_nonzero(inside) // MAX_JUNCTIONS + 1
    row, column = row[inside][::step], column[inside][::step]
    corner = np.stack([labels[row + y, column + x] for y, x in np.ndindex(2, 2)], axis=1).astype(np.int64)
    corner.sort(axis=1)
    middle = np.where(corner[:, 1] != corner[:, 0], corner[:, 1], corner[:, 2])
    three = np.stack([corner[:, 0], middle, corner[:, 3]], axis=1)
    down, right = _disc(radius)
    around = labels[row[:, None] + down, column[:, None] + right]
    share = [np.count_nonzero(around == three[:, part, None], axis=1) / down.size for part in range(3)]
    return three, np.stack(share, axis=1)


def _three_meet(labels: Int32[np.ndarray, "h w"]) -> Bool[np.ndarray, "r c"]:
    """Return the mask of corners, right of and below a pixel, at which three different parts meet."""
    across, along = labels[:, 1:] != labels[:, :-1], labels[1:] != labels[:-1]
    sides = across[:-1].astype(np.uint8) + across[1:] + along[:, :-1] + along[:, 1:]
    one, other = labels[:-1, :-1] == labels[1:, 1:], labels[:-1, 1:] == labels[1:, :-1]
    return (sides == 3) | ((sides == 4) & (one != other))


def _disc(radius: int) -> tuple[Int64[np.ndarray, "k"], Int64[np.ndarray, "k"]]:
    places = np.unique(np.rint(np.linspace(-radius + 1, radius, min(ACROSS, 2 * radius))).astype(np.int64))
    down, right = np.meshgrid(places, places, indexing="ij")
    within = (2 * down - 1) ** 2 + (2 * right - 1) ** 2 <= (2 * radius) ** 2
    return down[within], right[within]
