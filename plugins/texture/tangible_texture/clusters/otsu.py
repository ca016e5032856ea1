"""Otsu classes of grey levels: the exact optimum of his criterion for every number of classes at once."""

import numpy as np
from jaxtyping import Float64, Int64

CLEAR = 0.75
"""The largest ratio of Marriott's criterion at which levels count as several classes."""

GreyLevels = Float64[np.ndarray, "n"]


class OtsuClasses:
    """The best divisions of sorted grey levels, `counts` pixels each, into 1..most classes.

    The variance within the classes is least, so that the variance between them is greatest (Otsu, A threshold selection
    method from gray-level histograms, 1979). It is a sum over classes, so that dynamic programming minimises it for n
    levels in n^2 steps a class (Fisher, On grouping for maximum homogeneity, 1958).
    """

    def __init__(self, levels: GreyLevels, counts: Int64[np.ndarray, "n"], most: int) -> None:
        spread = _spread_within(levels - np.average(levels, weights=counts), counts)
        self._rounding = counts.sum() * np.ptp(levels) ** 2 / (12 * 255**2)  # the variance of rounding to 8 bits
        best = spread[0]
        self.spreads: list[float] = [best[-1]]
        """The sums of squares within the classes, for 1, 2, ... classes."""
        self._last_starts: list[np.ndarray] = []
        for _ in range(1, min(most, len(levels))):
            every = best[:, None] + spread
            self._last_starts.append(every.argmin(axis=0))
            best = every.min(axis=0)
            self.spreads.append(best[-1])

    def starts(self, classes: int) -> Int64[np.ndarray, "k"]:
        """Return the index of the first level of each class."""
        end = len(self._last_starts[0]) - 1 if self._last_starts else 0
        starts: list[int] = []
        for last in reversed(self._last_starts[: classes - 1]):
            end = int(last[end])
            starts.append(end)
        return np.array([0, *reversed(starts)])

    def clearest(self) -> tuple[int, float]:
        """Return the number of classes k with the least k^2 W(k) / W(1), or 1 if that is above CLEAR; and the ratio.

        W(k) is the variance within. Evenly spread levels have the ratio 1 for every k, and those of one Gaussian have
        more than that for every k but 1. Source: Marriott, Practical problems in a method of cluster
        analysis, 1971.
        """
        ratios = [(k**2 * (spread + self._rounding) / self.spreads[0], k) for k, spread in enumerate(self.spreads, 1)]
        ratio, classes = min(ratios)
        return (classes, float(ratio)) if ratio <= CLEAR else (1, 1.0)


def _spread_within(levels: GreyLevels, counts: Int64[np.ndarray, "n"]) -> Float64[np.ndarray, "m m"]:
    """Return the sum of squares about its mean of each class first..end-1; infinite where the class is empty."""
    count, total, squares = (np.concatenate([[0], np.cumsum(counts * levels**power)]) for power in (0, 1, 2))
    number = count - count[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        spread = (squares - squares[:, None]) - (total - total[:, None]) ** 2 / number
    return np.where(np.triu(np.ones(spread.shape, np.bool_), 1), np.maximum(spread, 0), np.inf)
