"""Psychometric functions by psignifit (Schütt, Harmeling, Macke & Wichmann 2016, Vision Research 122:105)."""

import warnings
from itertools import pairwise
from math import exp, inf, log
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import Float64

from tangible_core.errors import ConfigError
from tangible_core.runtime import need

from .intervals import LEVEL, Estimate

STEP = 0.01  # width of what counts as a step, as a share of the distance of two levels
# Half the distance from 25 to 75 % as a share of the width (5 to 95 %) of a cumulative Gaussian: 0.6745 / 3.2897.
JND = 0.20503033
# Steps of the grid: intervals of psignifit are exact to half a step (`python -m benchmarks study`).
STEPS = {"threshold": 60, "width": 60, "lambda": 20}


GAUSSIAN = 3.28970725  # width from 5 to 95 % of a cumulative Gaussian, in standard deviations
FARTHEST = 6.0  # factor from the width to the farthest bound that is looked for
# Most lapses on each side, as a share of the trials, for which the likelihood of a width is looked for.
MAX_LAPSES = 0.15


class Blocks(NamedTuple):
    """Answers by level, as psignifit takes them."""

    levels: Float64[np.ndarray, "n"]
    counts: Float64[np.ndarray, "n"]  # trials with the comparison chosen, or with a right answer
    trials: Float64[np.ndarray, "n"]


class Curve(NamedTuple):
    """A fitted function."""

    threshold: Estimate  # level at which the function is halfway up
    # Distance from 5 to 95 % of the way up; of a threshold of the difference, in natural logarithms.
    width: Estimate
    lapses: float  # share of the trials that were answered without attention
    chance: float  # share of right answers by guessing alone; 0 where each level is chosen or not

    def at(self, levels: Float64[np.ndarray, "n"]) -> Float64[np.ndarray, "n"]:
        """Return the share of the trials with the comparison chosen, or with a right answer."""
        from scipy import stats

        if self.chance:
            steep = (log(-log(0.05)) - log(-log(0.95))) / self.width.value
            with np.errstate(divide="ignore", over="ignore"):  # a threshold below all levels is 0, a step is steep
                height = 1 - 0.5 ** ((levels / self.threshold.value) ** steep)
            return self.chance + (1 - self.chance - self.lapses) * height
        sd = self.width.value / GAUSSIAN
        return self.lapses + (1 - 2 * self.lapses) * stats.norm.cdf((levels - self.threshold.value) / sd)


def fit_choice(blocks: Blocks, span: tuple[float, float]) -> Curve:
    """Fit how often a level is chosen over the standard, by a cumulative Gaussian. span: of the study's levels."""
    result = _fit(blocks, sigmoid="norm", experiment_type="equal asymptote", stimulus_range=span)
    threshold, width = _estimate(result, "threshold"), float(result.parameter_estimate["width"])
    curve = Curve(threshold, width_interval(blocks, threshold, width), result.parameter_estimate["lambda"], 0.0)
    return curve._replace(threshold=_threshold_interval(curve, blocks))


def width_interval(blocks: Blocks, threshold: Estimate, width: float) -> Estimate:
    """Return the width of a cumulative Gaussian with equal lapses, with the interval of the likelihood ratio."""
    from scipy import stats

    reach = threshold.high - threshold.low
    thresholds = np.linspace(threshold.low - reach, threshold.high + reach, 61)
    widths = width * np.geomspace(1 / FARTHEST, FARTHEST, 121)
    lapses = np.linspace(0, MAX_LAPSES, 16)
    likelihood = np.zeros((len(lapses), len(thresholds), len(widths)))
    for level, count, trials in zip(*blocks, strict=True):
        rise = stats.norm.cdf((level - thresholds[:, None]) / (widths / GAUSSIAN))
        share = np.clip(lapses[:, None, None] + (1 - 2 * lapses[:, None, None]) * rise, 1e-12, 1 - 1e-12)
        likelihood += count * np.log(share) + (trials - count) * np.log1p(-share)
    # Threshold and lapses are at their best for each width. The interval of psignifit is as long but leans towards the
    # middle of its prior, so that it holds widths there in 97 % (docs/decisions/0042-studies-with-people.md).
    profile = likelihood.max(axis=(0, 1))
    lack = 2 * (profile.max() - profile) - stats.chi2.ppf(LEVEL, 1)
    inside = np.flatnonzero(lack <= 0)
    first, last = int(inside[0]), int(inside[-1])
    low = 0.0 if first == 0 else float(np.interp(0, lack[[first, first - 1]], widths[[first, first - 1]]))
    high = inf if last == len(widths) - 1 else float(np.interp(0, lack[[last, last + 1]], widths[[last, last + 1]]))
    return Estimate(width, min(low, width), max(high, width))


def fit_difference(blocks: Blocks, span: tuple[float, float], choices: int = 3) -> Curve:
    """Fit how often a difference is found, by a Weibull function; its threshold is halfway up from chance."""
    logs = blocks._replace(levels=np.log(blocks.levels))
    within = (log(span[0]), log(span[1]))
    result = _fit(logs, sigmoid="weibull", experiment_type=f"{choices}AFC", stimulus_range=within)
    threshold, width = _estimate(result, "threshold").map(exp), _estimate(result, "width")
    curve = Curve(threshold, width, result.parameter_estimate["lambda"], 1 / choices)
    return curve._replace(threshold=_threshold_interval(curve, blocks, beyond=0.0))


def _threshold_interval(curve: Curve, blocks: Blocks, beyond: float = -inf) -> Estimate:
    """Return the threshold in an interval that also holds what the prior of psignifit leaves out."""
    from scipy import special, stats

    def lack(share: Any) -> float:
        return best - float((special.xlogy(hits, share) + special.xlog1py(misses, -share)).sum())

    hits, misses, middle, best = blocks.counts, blocks.trials - blocks.counts, (1 + curve.chance) / 2, 0.0
    best, limit = -lack(curve.at(blocks.levels)), stats.chi2.ppf(LEVEL, 1) / 2
    same = hits.sum() / blocks.trials.sum()
    below, above = lack(np.clip(same, middle, 1)), lack(np.clip(same, curve.chance, middle))
    # A threshold beyond all levels leaves the same share at all of them. If that may explain the answers, the interval
    # has no bound there; if it does so as well as the curve, there is no estimate. So may a step between two levels.
    value, low, high = curve.threshold
    for one, other in pairwise(blocks.levels.tolist()):
        width = STEP * (log(other / one) if curve.chance else other - one)
        step = curve._replace(threshold=Estimate((one + other) / 2), width=Estimate(width))
        if lack(step.at(blocks.levels)) <= limit:
            low, high = min(low, one), max(high, other)
    if min(below, above) <= 0:
        value = beyond if below < above else inf
    return Estimate(value, beyond if below <= limit else low, inf if above <= limit else high)


def _fit(blocks: Blocks, **options: Any) -> Any:
    psignifit = need("psignifit", "questplus psignifit", ConfigError)
    with warnings.catch_warnings():
        warnings.simplefilter("ignore")  # about adaptive data, for which the range of levels is given
        return psignifit.psignifit(
            np.column_stack(blocks), verbose=False, fixed_parameters={"eta": 0.0}, grid_steps=STEPS, **options
        )


def _estimate(result: Any, name: str) -> Estimate:
    value, (low, high) = float(result.parameter_estimate[name]), result.confidence_intervals[name][str(LEVEL)]
    return Estimate(value, min(float(low), value), max(float(high), value))
