"""Which parts lie beside each other, and which of two is in front as far as their borders tell."""

from math import sqrt
from typing import NamedTuple

import numpy as np
from jaxtyping import Bool, Float64, Int32, Int64

from ..data import PartMap

REACH = 0.012
"""Radius of the disc in which the angles at a junction are measured, of the picture's diagonal."""
MOST_JUNCTIONS, ACROSS = 20_000, 15
"""Junctions that are looked at, spread over all there are, and points across the disc of each."""
STRAIGHT, THIN = 0.15, 0.08
"""How far from half of the disc a part that is in front may be, and how much of it each of the three is at least."""


class Neighbours(NamedTuple):
    """Pairs of parts with a common border, in order: `low` is the smaller number of each, `high` the larger."""

    low: Int64[np.ndarray, "m"]
    high: Int64[np.ndarray, "m"]
    sides: Int64[np.ndarray, "m"]
    """Length of the common border, in sides of pixels."""


def neighbours(parts: PartMap) -> Neighbours:
    """Every pair of parts that share sides of pixels."""
    labels = parts.labels
    pairs = np.concatenate(
        [_pairs(labels[:, :-1], labels[:, 1:], parts.count), _pairs(labels[:-1], labels[1:], parts.count)]
    )
    found, sides = np.unique(pairs, return_counts=True)
    low, high = np.divmod(found, parts.count)
    return Neighbours(low, high, sides.astype(np.int64))


def _pairs(one: np.ndarray, other: np.ndarray, count: int) -> Int64[np.ndarray, "k"]:
    differ = one != other
    first, second = one[differ].astype(np.int64), other[differ].astype(np.int64)
    return np.minimum(first, second) * count + np.maximum(first, second)


def in_front(parts: PartMap, beside: Neighbours) -> Float64[np.ndarray, "m"]:
    """Of each pair, how surely `high` is in front of `low`, from -1 for the contrary to 1; 0 where nothing tells.

    Where three parts meet, the one whose border runs straight on hides the border of the two others, which ends there.
    One that passes a quarter of a turn or more from straight tells nothing.
    Source: Guzman, Decomposition of a visual scene into three-dimensional bodies, 1968 (the T-junction).
    """
    three, share = _junctions(parts.labels)
    if not len(three):
        return np.zeros(beside.low.size)
    nearest = share.argmax(axis=1)
    rows = np.arange(len(three))
    sure = np.clip(1 - np.abs(share[rows, nearest] - 0.5) / STRAIGHT, 0, 1) * (share.min(axis=1) > THIN)
    keys = beside.low * parts.count + beside.high
    votes, weight = np.zeros(keys.size), np.ones(keys.size)
    for each in range(3):
        front, behind = three[rows, nearest], three[:, each]
        wanted = np.minimum(front, behind) * parts.count + np.maximum(front, behind)
        pair = np.minimum(np.searchsorted(keys, wanted), keys.size - 1)
        told = np.where(keys[pair] == wanted, sure, 0)  # 0 too for the one in front itself, and where corners touch
        votes += np.bincount(pair, np.where(front > behind, told, -told), keys.size)
        weight += np.bincount(pair, told, keys.size)
    return votes / weight


def _junctions(labels: Int32[np.ndarray, "h w"]) -> tuple[Int64[np.ndarray, "k 3"], Float64[np.ndarray, "k 3"]]:
    """The three parts of each corner of pixels at which so many meet, and their shares of a disc around it."""
    rows, columns = labels.shape
    radius = max(2, round(REACH * sqrt(rows * rows + columns * columns)))
    row, column = np.nonzero(_three_meet(labels))
    inside = (np.minimum(row, column) >= radius) & (row < rows - radius) & (column < columns - radius)
    step = np.count_nonzero(inside) // MOST_JUNCTIONS + 1
    row, column = row[inside][::step], column[inside][::step]
    corner = np.stack([labels[row + y, column + x] for y, x in np.ndindex(2, 2)], axis=1).astype(np.int64)
    corner.sort(axis=1)
    middle = np.where(corner[:, 1] != corner[:, 0], corner[:, 1], corner[:, 2])
    three = np.stack([corner[:, 0], middle, corner[:, 3]], axis=1)
    down, right = _disc(radius)
    around = labels[row[:, None] + down, column[:, None] + right]
    share = [np.count_nonzero(around == three[:, each, None], axis=1) / down.size for each in range(3)]
    return three, np.stack(share, axis=1)


def _three_meet(labels: Int32[np.ndarray, "h w"]) -> Bool[np.ndarray, "r c"]:
    """Corners, each right of and below a pixel, at which three different parts meet."""
    across, along = labels[:, 1:] != labels[:, :-1], labels[1:] != labels[:-1]
    sides = across[:-1].astype(np.uint8) + across[1:] + along[:, :-1] + along[:, 1:]
    one, other = labels[:-1, :-1] == labels[1:, 1:], labels[:-1, 1:] == labels[1:, :-1]
    return (sides == 3) | ((sides == 4) & (one != other))


def _disc(radius: int) -> tuple[Int64[np.ndarray, "k"], Int64[np.ndarray, "k"]]:
    """Rows and columns of points of a disc around the corner right of and below a pixel, evenly spread."""
    places = np.unique(np.rint(np.linspace(-radius + 1, radius, min(ACROSS, 2 * radius))).astype(np.int64))
    down, right = np.meshgrid(places, places, indexing="ij")
    within = (2 * down - 1) ** 2 + (2 * right - 1) ** 2 <= (2 * radius) ** 2
    return down[within], right[within]
