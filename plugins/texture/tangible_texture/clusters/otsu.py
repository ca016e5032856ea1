"""Grey levels in classes: the exact optimum of Otsu's criterion for every number of classes at once."""

import numpy as np
from jaxtyping import Float64, Int64

CLEAR = 0.75
"""The ratio of Marriott's criterion at which classes are taken to be there."""

Weights = Float64[np.ndarray, "n"]


class OtsuClasses:
    """The best divisions of sorted grey levels, `counts` pixels each, into 1..most classes.

    The variance within the classes is least, which is the variance between them at its most (Otsu, A threshold
    selection method from gray-level histograms, 1979). It is a sum over classes, so that dynamic programming finds it
    for n levels in n^2 steps a class (Fisher, On grouping for maximum homogeneity, 1958).
    """

    def __init__(self, levels: Weights, counts: Int64[np.ndarray, "n"], most: int) -> None:
        spread = _spread_within(levels - np.average(levels, weights=counts), counts)
        self._rounding = counts.sum() * np.ptp(levels) ** 2 / (12 * 255**2)  # no variance of 8 bits is known better
        best = spread[0]
        self.spreads = [best[-1]]
        """The sum of squares within the classes, for 1, 2, ... of them."""
        self._last_starts: list[np.ndarray] = []
        for _ in range(1, min(most, len(levels))):
            every = best[:, None] + spread
            self._last_starts.append(every.argmin(axis=0))
            best = every.min(axis=0)
            self.spreads.append(best[-1])

    def starts(self, classes: int) -> Int64[np.ndarray, "k"]:
        """Which level is the first of each class."""
        end = len(self._last_starts[0]) - 1 if self._last_starts else 0
        starts: list[int] = []
        for last in reversed(self._last_starts[: classes - 1]):
            end = int(last[end])
            starts.append(end)
        return np.array([0, *reversed(starts)])

    def clearest(self) -> tuple[int, float]:
        """The number of classes k that makes k^2 W(k) / W(1) least, if that is CLEAR, else 1; and the ratio.

        W(k) is the variance within. Levels that are evenly spread have the ratio 1 whatever k is, and those of one
        Gaussian have more than that for every k but 1. Source: Marriott, Practical problems in a method of cluster
        analysis, 1971.
        """
        ratios = [(k**2 * (spread + self._rounding) / self.spreads[0], k) for k, spread in enumerate(self.spreads, 1)]
        ratio, classes = min(ratios)
        return (classes, float(ratio)) if ratio <= CLEAR else (1, 1.0)


def _spread_within(levels: Weights, counts: Int64[np.ndarray, "n"]) -> Float64[np.ndarray, "m m"]:
    """For levels first..end-1 as one class, its sum of squares about its mean; infinite where there is none."""
    count, total, squares = (np.concatenate([[0], np.cumsum(counts * levels**power)]) for power in (0, 1, 2))
    number = count - count[:, None]
    with np.errstate(divide="ignore", invalid="ignore"):
        spread = (squares - squares[:, None]) - (total - total[:, None]) ** 2 / number
    return np.where(np.triu(np.ones(spread.shape, np.bool_), 1), np.maximum(spread, 0), np.inf)
