"""Merging of neighbouring regions, the least separated first."""

import heapq

import numpy as np
from jaxtyping import Int32

from tangible_core.compiled import KERNEL, njit

from .borders import Border

HELD_APART = 0.6


def merge(areas: list[int], borders: dict[tuple[int, int], Border], most: int) -> Int32[np.ndarray, "n"]:
    """Merge neighbours until edges separate all, `most` at most; return the region into which each was merged."""
    # Pairs with the least share of edges in their border go first; after them, pairs with the lowest mean height of the
    # border times a b / (a + b), a and b being areas: small regions give way to large ones, as in Ward's method.
    graph = _Graph(areas, borders)
    graph.merge(most)
    if graph.remaining > most:
        graph.weigh()
        graph.merge(most)
    return np.array([graph.root(region) for region in range(len(areas))], np.int32)


def weakest_border(borders: dict[tuple[int, int], Border], parts: Int32[np.ndarray, "n"]) -> float:
    """Return the least share of edges in the border of two merged regions; 0 for one region. `parts`: from `merge`."""
    totals: dict[tuple[int, int], Border] = {}
    for (one, other), border in borders.items():
        low, high = sorted((int(parts[one]), int(parts[other])))
        if low < high:
            totals[low, high] = border.plus(totals[low, high]) if (low, high) in totals else border
    return min((border.edges / border.pairs for border in totals.values()), default=0.0)


class _Graph:
    """Regions, their neighbours, and a queue of pairs; a queued pair is void once its border is another object."""

    def __init__(self, areas: list[int], borders: dict[tuple[int, int], Border]) -> None:
        self.areas = areas.copy()
        self.remaining = len(areas)
        self.weighing = False
        self.parent = list(range(len(areas)))
        self.neighbours: list[dict[int, Border]] = [{} for _ in areas]
        self.queue: list[tuple[float, int, int, Border]] = []
        for (one, other), border in borders.items():
            self.connect(one, other, border)

    def connect(self, one: int, other: int, border: Border) -> None:
        """Set the border of two regions."""
        self.neighbours[one][other] = self.neighbours[other][one] = border
        reluctance = self.reluctance(one, other, border)
        if reluctance < 0 or self.weighing:
            heapq.heappush(self.queue, (reluctance, min(one, other), max(one, other), border))

    def weigh(self) -> None:
        """Queue the pairs that edges separate, too."""
        # Pairs that edges separate come last, and their order changes with every merge.
        self.weighing = True
        for one, others in enumerate(self.neighbours):
            for other, border in others.items():
                if one < other:
                    self.connect(one, other, border)

    def merge(self, most: int) -> None:
        """Merge the pairs in the queue until no more than `most` regions are left, or edges separate all."""
        while self.queue:
            reluctance, one, other, border = heapq.heappop(self.queue)
            if self.neighbours[one].get(other) is not border:
                continue
            if reluctance >= 0 and self.remaining <= most:
                break
            self.join(one, other)

    def reluctance(self, one: int, other: int, border: Border) -> float:
        """Return the cost of merging; negative where edges do not forbid it."""
        share = border.edges / border.pairs
        if share < HELD_APART:
            return share - 1
        a, b = self.areas[one], self.areas[other]
        return border.height / border.pairs * a * b / (a + b)

    def join(self, survivor: int, absorbed: int) -> None:
        """Make two regions one."""
        self.parent[absorbed] = survivor
        self.areas[survivor] += self.areas[absorbed]
        self.remaining -= 1
        borders, self.neighbours[absorbed] = self.neighbours[absorbed], {}
        for far, border in borders.items():
            del self.neighbours[far][absorbed]
            if far != survivor:
                own = self.neighbours[survivor].get(far)
                self.neighbours[survivor][far] = border.plus(own) if own else border
        for far in self.neighbours[survivor] if self.weighing else borders:
            if far != survivor:
                border = Border(*self.neighbours[survivor][far])  # a new object voids the queued pairs of the old area
                self.connect(survivor, far, border)

    def root(self, region: int) -> int:
        """Return the region into which this one was merged."""
        while self.parent[region] != region:
            region = self.parent[region]
        return region


def number_in_reading_order(labels: Int32[np.ndarray, "h w"]) -> Int32[np.ndarray, "h w"]:
    """Renumber labels 0..n-1 in the order of their first pixels, row by row. Parameters: labels >= 0."""
    result = np.empty_like(labels)
    _rename(labels, np.full(int(labels.max()) + 1, -1, np.int32), result)
    return result


@njit(**KERNEL)
def _rename(labels, order, result):
    count = 0
    for row in range(labels.shape[0]):
        for column in range(labels.shape[1]):
            label = labels[row, column]
            if order[label] < 0:
                order[label] = count
                count += 1
            result[row, column] = order[label]
