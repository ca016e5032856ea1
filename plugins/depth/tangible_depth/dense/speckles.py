"""Removal of speckles: small islands of disparity, mostly wrong matches that no neighbour confirms."""

from typing import NamedTuple

import cv2
import numpy as np
from jaxtyping import Int16, Int32, UInt8
from numba import int64

from tangible_core.compiled import KERNEL, in_blocks, inner, njit

from .span import UNKNOWN


def slices_with_margin(y0: int, y1: int, rows: int) -> tuple[slice, slice]:
    """Slice rows y0..y1-1 with a margin of `rows` on either side, where there are; and y0..y1-1 within that slice."""
    first = max(0, y0 - rows)
    return slice(first, y1 + rows), slice(y0 - first, y1 - first)


ISLAND_PX = 60
REACH = 20  # radius, in pixels, of the window in which the share of matched pixels is counted
# Shares of matched pixels in the window below which few, and hardly any, count as matched.
FEW, HARDLY_ANY = 0.5, 0.2


class Specks(NamedTuple):
    """Largest islands, in pixels, that are removed: a lone match was found by chance, and would fill its gap."""

    among_many_px: int = 20
    among_few_px: int = ISLAND_PX
    alone_px: int = ISLAND_PX

    def downsample(self, factor: int) -> "Specks":
        """Return the same sizes for a picture that is smaller by `factor`."""
        return Specks(*(size_px // factor**2 for size_px in self))

    def by_share(self) -> Int32[np.ndarray, "256"]:
        """Return the largest removed island, in pixels, for 0 to 255 of 255 matched pixels near it."""
        share = np.arange(256) / 255
        return np.select((share < HARDLY_ANY, share < FEW), self[:0:-1], self.among_many_px).astype(np.int32)


def remove_specks(disparity: Int16[np.ndarray, "h w"], specks: Specks, factor: int = 1) -> None:
    """Make islands UNKNOWN, in place, by the share of matched pixels near them; factor: that of the downsampling."""
    _remove(disparity, specks.downsample(factor).by_share(), 16, REACH // factor)


def remove_speckles(disparity: Int16[np.ndarray, "h w"], largest_px: int, step: int = 16) -> int:
    """Make islands UNKNOWN, in place, and return their number of pixels."""
    # An island is a region in which 4-neighbours differ by at most `step`, and which no such step joins to another
    # region.
    return _remove(disparity, np.full(1, largest_px, np.int32), step)


def _remove(disparity: np.ndarray, largest_px: np.ndarray, step: int, reach: int | None = None) -> int:
    """Make islands UNKNOWN, up to largest_px[share of matched pixels within `reach`, in 255ths]; None: share 0."""
    h, w = disparity.shape
    share = np.zeros(disparity.shape, np.uint8)
    start, stop, parent, size = (np.empty(h * w, np.int32) for _ in range(4))
    begin, end = np.empty(h, np.int64), np.empty(h, np.int64)
    first_rows: list[int] = []
    erased_counts: list[int] = []
    most = int(largest_px.max())

    def label(y0: int, y1: int) -> None:
        first_rows.append(y0)
        if reach is not None:
            share[y0:y1] = _matched_share(disparity, y0, y1, reach)
        _label(disparity, step, y0, y1, start, stop, parent, size, begin, end)

    in_blocks(h, label)
    for y in sorted(first_rows)[1:]:
        _join_rows(disparity, step, y, start, stop, parent, size, begin, end)

    def erase(y0: int, y1: int) -> None:
        erased_counts.append(_erase(disparity, most, largest_px, share, y0, y1, start, stop, parent, size, begin, end))

    in_blocks(h, erase)
    return sum(erased_counts)


def _matched_share(disparity: np.ndarray, y0: int, y1: int, reach: int) -> UInt8[np.ndarray, "rows w"]:
    cut, own = slices_with_margin(y0, y1, reach)
    window = 2 * reach + 1, 2 * reach + 1
    return cv2.blur(np.uint8(255) * (disparity[cut] != UNKNOWN), window)[own]  # pyright: ignore[reportReturnType]


@njit(**KERNEL)
def _label(disparity, step, y0, y1, start, stop, parent, size, begin, end):
    """Find the runs of rows y0..y1-1 and join them within these rows."""
    w = disparity.shape[1]
    # Runs are numbered from y0 w on, so that blocks do not share numbers; row y has begin[y]..end[y]-1.
    run = y0 * w
    for y in range(y0, y1):
        row = disparity[y]
        begin[y] = run
        x = 0
        while x < w:
            if row[x] == UNKNOWN:
                x += 1
                continue
            start[run] = x
            x += 1
            while x < w and row[x] != UNKNOWN and abs(int64(row[x]) - int64(row[x - 1])) <= step:
                x += 1
            stop[run], parent[run], size[run] = x, run, x - start[run]
            run += 1
        end[y] = run
        if y > y0:
            _join_rows(disparity, step, y, start, stop, parent, size, begin, end)


@njit(**KERNEL)
def _join_rows(disparity, step, y, start, stop, parent, size, begin, end):
    upper, lower = disparity[y - 1], disparity[y]
    above = begin[y - 1]
    for here in range(begin[y], end[y]):
        while above < end[y - 1] and stop[above] <= start[here]:
            above += 1
        other = above
        while other < end[y - 1] and start[other] < stop[here]:
            for x in range(max(start[here], start[other]), min(stop[here], stop[other])):
                if abs(int64(upper[x]) - int64(lower[x])) <= step:
                    _unite(parent, size, here, other)
                    break
            other += 1


@inner()
def _root(parent, i):
    while parent[i] != i:
        parent[i] = parent[parent[i]]
        i = parent[i]
    return i


@inner()
def _unite(parent, size, i, j):
    """Join two regions, without a branch: whether they are joined already is unpredictable."""
    i, j = _root(parent, i), _root(parent, j)
    low, high = min(i, j), max(i, j)
    total = size[low] + (size[high] if i != j else 0)
    parent[high], size[low] = low, total


@njit(**KERNEL)
def _erase(disparity, most, largest_px, share, y0, y1, start, stop, parent, size, begin, end):
    erased_count = 0
    for y in range(y0, y1):
        for run in range(begin[y], end[y]):
            root = run
            while parent[root] != root:  # paths are not shortened here: other threads read them
                root = parent[root]
            if size[root] <= most:
                for x in range(start[run], stop[run]):
                    if size[root] <= largest_px[share[y, x]]:
                        disparity[y, x] = UNKNOWN
                        erased_count += 1
    return erased_count
