"""Borders between the regions of a label map. Compiled by numba where every pixel is visited."""

# ruff: noqa: ANN001, ANN202 -- numba takes the types from the call

from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Int32, UInt8
from numba import njit


class Border(NamedTuple):
    """What two neighbouring regions have between them, summed over the pairs of pixels (4 neighbours) across."""

    pairs: float
    height: float
    """The higher pixel of each pair."""
    edges: float
    """How many pairs have an edge in them."""

    def joined(self, other: "Border") -> "Border":
        """Both borders, of one region with two that have become one."""
        return Border(self.pairs + other.pairs, self.height + other.height, self.edges + other.edges)


def borders(
    labels: Int32[np.ndarray, "h w"], height: Float32[np.ndarray, "h w"], edges: UInt8[np.ndarray, "h w"]
) -> dict[tuple[int, int], Border]:
    """Every border there is, by its two regions, the lower label first; edges are where `edges` is not 0."""
    count = int(labels.max()) + 1
    keys, highest, edged = _pairs(labels, height, edges, count)
    found, which, pairs = np.unique(keys, return_inverse=True, return_counts=True)
    sums = (np.bincount(which, weights, found.size).tolist() for weights in (highest, edged))
    return {divmod(key, count): Border(*sums) for key, *sums in zip(found.tolist(), pairs.tolist(), *sums, strict=True)}


@njit(cache=True, nogil=True)
def _pairs(labels, height, edges, count):
    """A key, the greater height and whether there is an edge, of every two pixels beside each other of two labels."""
    rows, columns = labels.shape
    number = _count_pairs(labels)
    keys, highest, edged = np.empty(number, np.int64), np.empty(number, np.float32), np.empty(number, np.bool_)
    at = 0
    for row in range(rows):
        for column in range(columns):
            one = labels[row, column]
            for below, right in ((row + 1, column), (row, column + 1)):
                if below < rows and right < columns and labels[below, right] != one:
                    other = labels[below, right]
                    keys[at] = np.int64(min(one, other)) * count + max(one, other)
                    highest[at] = max(height[row, column], height[below, right])
                    edged[at] = edges[row, column] != 0 or edges[below, right] != 0
                    at += 1
    return keys, highest, edged


@njit(cache=True, nogil=True)
def _count_pairs(labels):
    rows, columns = labels.shape
    number = 0
    for row in range(rows):
        for column in range(columns):
            if row + 1 < rows:
                number += labels[row + 1, column] != labels[row, column]
            if column + 1 < columns:
                number += labels[row, column + 1] != labels[row, column]
    return number
