"""Estimates with their 95 % intervals: proportions, means, and differences of both."""

from collections.abc import Callable, Sequence
from math import hypot, isfinite, isinf, nan
from typing import Any, NamedTuple

import numpy as np

LEVEL = 0.95  # confidence level of all intervals


class Estimate(NamedTuple):
    """An estimate with its interval; the bounds are NaN where the data give none."""

    value: float
    low: float = nan
    high: float = nan

    @property
    def has_interval(self) -> bool:
        """True if both bounds are known; either may be infinite."""
        return self.low == self.low and self.high == self.high

    def holds(self, value: float) -> bool:
        """Return True if a value is within the interval, or there is no interval that could exclude it."""
        return not self.has_interval or self.low <= value <= self.high

    @property
    def is_bound(self) -> bool:
        """True if the answers give no estimate but a bound: the value is at an end of the interval."""
        return self.value in (self.low, self.high)

    def map(self, function: Callable[[float], float]) -> "Estimate":
        """Return the estimate on another scale. function: rises with its argument."""
        return Estimate(*(function(bound) if bound == bound else nan for bound in self))


def proportion(count: int, trials: int) -> Estimate:
    """Return count / trials with the exact interval of Clopper & Pearson (1934), Biometrika 26:404.

    >>> [round(each, 4) for each in proportion(7, 10)]
    [0.7, 0.3475, 0.9333]
    """
    from scipy import stats

    if trials < 1:
        return Estimate(nan)
    low, high = stats.binomtest(count, trials).proportion_ci(LEVEL)
    return Estimate(count / trials, float(low), float(high))


def mean(values: Sequence[float]) -> Estimate:
    """Return the mean with Student's interval; without bounds for a single value.

    >>> [round(each, 3) for each in mean([1.0, 2.0, 3.0])]
    [2.0, -0.484, 4.484]
    """
    count = len(values)
    if not count:
        return Estimate(nan)
    middle = float(np.mean(values))
    if count < 2 or not all(map(isfinite, values)):
        return Estimate(middle)
    from scipy.special import stdtrit

    half = float(stdtrit(count - 1, (1 + LEVEL) / 2) * np.std(values, ddof=1) / count**0.5)
    return Estimate(middle, middle - half, middle + half)


def mean_of_estimates(estimates: Sequence[Estimate], closed_ends: bool = False) -> Estimate:
    """Return the mean of the values with Student's interval, in which infinite bounds count, and so do bounds alone.

    closed: the ends of an interval may be values as others are, such as a share of 0 or 1.

    >>> mean_of_estimates([Estimate(-np.inf, -np.inf, 2.0), Estimate(1.0, 0.5, 1.5)])[:2]
    (-inf, -inf)
    """
    values = [estimate.value for estimate in estimates]
    if len(estimates) < 2:
        return mean(values)
    bounds = [estimate.is_bound and not closed_ends for estimate in estimates]
    low, high = (
        mean([end if alone or isinf(end) else value for end, value, alone in zip(ends, values, bounds, strict=True)])
        for ends in list(zip(*estimates, strict=True))[1:]
    )
    return Estimate(
        sum(values) / len(values),
        low.low if isfinite(low.value) else low.value,
        high.high if isfinite(high.value) else high.value,
    )


def difference(one: Estimate, other: Estimate) -> Estimate:
    """Return one - other for independent estimates. Source: Zou & Donner (2008), Statistics in Medicine 27:1693."""
    value = one.value - other.value
    if not isfinite(value):
        return Estimate(value, one.low - other.high, one.high - other.low)
    low = value - hypot(one.value - one.low, other.high - other.value)
    return Estimate(value, low, value + hypot(one.high - one.value, other.value - other.low))


def wider(one: Estimate, other: Estimate) -> Estimate:
    """Return the first estimate with an interval that holds both intervals; one without bounds is left out."""
    if not (one.has_interval and other.has_interval):
        return Estimate(one.value, *(other if other.has_interval else one)[1:])
    return Estimate(one.value, min(one.low, other.low), max(one.high, other.high))


def p_of_mean(values: Sequence[float], null: float) -> float:
    """Return the probability, two-sided by Student's t, of a mean this far from the expected one; NaN if unknown."""
    if len(values) < 2 or not all(map(isfinite, values)) or np.ptp(values) == 0:
        return nan
    from scipy import stats

    result: Any = stats.ttest_1samp(values, null)
    return float(result.pvalue)


def p_of_count(count: int, trials: int, chance: float, one_sided: bool) -> float:
    """Return the exact binomial probability of a count this far from chance; one-sided, of one as high as this."""
    if trials < 1:
        return nan
    from scipy import stats

    return float(stats.binomtest(count, trials, chance, "greater" if one_sided else "two-sided").pvalue)
