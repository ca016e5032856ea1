"""Statistics: figures that were published, and answers that follow from simulation or symmetry."""

import numpy as np
import pytest
from scipy import optimize, stats

from tangible_study.statistics import sensitivity
from tangible_study.statistics.bradley_terry import fit_scale
from tangible_study.statistics.intervals import Estimate, difference, mean, p_of_count, proportion, wider
from tangible_study.statistics.psychometric import (
    GAUSSIAN,
    JND,
    MAX_LAPSES,
    Blocks,
    fit_choice,
    fit_difference,
    width_interval,
)

BASEBALL = np.array(
    [
        [0, 7, 9, 7, 7, 9, 11],
        [6, 0, 7, 5, 11, 9, 9],
        [4, 6, 0, 7, 7, 8, 12],
        [6, 8, 6, 0, 6, 7, 10],
        [6, 2, 6, 7, 0, 7, 12],
        [4, 4, 5, 6, 6, 0, 6],
        [2, 4, 1, 3, 1, 7, 0],
    ],
    float,
)
"""Wins of the American League East in 1987: Milwaukee, Detroit, Toronto, New York, Boston, Cleveland, Baltimore
(Agresti, Categorical Data Analysis, 2nd ed., table 10.10)."""
DETECTION = [
    (0.0010, 45), (0.0015, 50), (0.0020, 44), (0.0025, 44), (0.0030, 52), (0.0035, 53), (0.0040, 62), (0.0045, 64),
    (0.0050, 76), (0.0060, 79), (0.0070, 88), (0.0080, 90), (0.0100, 90),
]  # fmt: skip
"""Right answers of 90 at each level: the example of psignifit's documentation."""


def blocks(rows: list[tuple[float, int]], trials: int) -> Blocks:
    levels, counts = np.array(rows, float).T
    return Blocks(levels, counts, np.full(len(levels), float(trials)))


def test_scale_is_as_published_and_marks_one_that_always_wins():
    scale = fit_scale([BASEBALL])
    assert np.round(scale.values[:-1] - scale.values[-1], 2).tolist() == [1.58, 1.44, 1.29, 1.25, 1.11, 0.68]
    halves = [scale.difference(team, 6).high - scale.difference(team, 6).value for team in range(6)]
    assert np.round(np.array(halves) / 1.96, 1).tolist() == [0.3] * 6
    assert scale.values.mean() == pytest.approx(0, abs=1e-12)
    scale = fit_scale([np.array([[0.0, 9, 9], [0, 0, 5], [0, 4, 0]])])
    assert scale.was_completed
    assert np.isfinite(scale.values).all()
    assert scale.values.argmax() == 0
    completed = fit_scale([np.array([[0, 9.5, 9.5], [0.5, 0, 5.5], [0.5, 4.5, 0]])])
    assert scale.values == pytest.approx(completed.values, abs=1e-9)
    assert not fit_scale([BASEBALL]).was_completed


@pytest.mark.parametrize(
    ("first", "robust"), [((9, 2, 7, 5, 8), True), ((10, 0, 10, 0), False), ((6, 6, 7, 6, 6), False)],
    ids=["five who differ", "four who differ", "five who are alike"],
)  # fmt: skip
def test_interval_of_a_difference_of_two_is_that_of_the_logit(first: tuple[int, ...], robust: bool):
    """Ten choices each, the first chosen so often. By hand: the difference is logit(p); by the trials its variance is
    1 / (N p q), by the participants n / (n - 1) times the sum of their squared residuals times that squared."""
    scale = fit_scale([np.array([[0.0, each], [10 - each, 0]]) for each in first])
    count, trials, share = len(first), 10 * len(first), sum(first) / (10 * len(first))
    by_trials = 1 / (trials * share * (1 - share))
    apart = sum((each - 10 * share) ** 2 for each in first) * count / (count - 1) * by_trials**2
    assert (apart > by_trials) is (robust or count < 5)
    quantile = stats.t.ppf(0.975, count - 1) if robust else stats.norm.ppf(0.975)
    half = quantile * (apart if robust else by_trials) ** 0.5
    logit = np.log(share / (1 - share))
    assert scale.difference(0, 1) == pytest.approx((logit, logit - half, logit + half), abs=1e-9)
    assert scale.difference(1, 0) == pytest.approx((-logit, -logit - half, -logit + half), abs=1e-9)
    assert scale.estimate(0) == pytest.approx((logit / 2, (logit - half) / 2, (logit + half) / 2), abs=1e-9)


@pytest.mark.parametrize("dprime", [0.0, 0.5, 1.0, 2.0, 3.0, 4.5, 6.0])
def test_share_of_odd_ones_is_that_of_the_model_integrated_over_two_intervals(dprime: float):
    """The third interval is named where the first two are closest: the integral over these, by the trapezoidal rule."""
    felt = np.linspace(-8, 8, 801)
    first, second = felt[:, None], felt[None]
    low, high, gap = np.minimum(first, second), np.maximum(first, second), np.abs(first - second)
    named = stats.norm.sf(high + gap - dprime) + stats.norm.cdf(low - gap - dprime)
    density = stats.norm.pdf(felt) * (felt[1] - felt[0])
    assert sensitivity.oddity_correct(dprime) == pytest.approx(
        float(np.einsum("i,ij,j", density, named, density)), abs=2e-5
    )


def test_dprime_is_finite_at_the_ends():
    none = sensitivity.same_different(5, 10, 5, 10)
    assert none.value == none.low == 0.0
    every = sensitivity.same_different(20, 20, 0, 20)
    assert every.value > 4 and every.high == np.inf
    assert np.isnan(sensitivity.same_different(3, 10, 0, 0).value)
    assert sensitivity.oddity(1.0) == np.inf
    assert sensitivity.oddity(0.2) == 0.0
    for near in np.linspace(-1e-13, 1e-13, 9).tolist():  # means of shares, such as (0.25 + 0.25 + 0.5) / 3
        assert sensitivity.oddity(1 / 3 + near) == pytest.approx(0.0, abs=1e-3)
        assert sensitivity.naming(0.2 + near, 5) == pytest.approx(0.0, abs=1e-3)
    assert sensitivity.naming(0.1, 5) == 0.0


def test_intervals_and_their_differences_are_as_published():
    """Newcombe (1998), Statistics in Medicine 17:857, table I, method 5."""
    assert np.round(proportion(81, 263), 4).tolist() == [0.308, 0.2527, 0.3676]
    assert np.round(proportion(15, 148), 4).tolist() == [0.1014, 0.0578, 0.1617]
    assert np.round(proportion(0, 20)[1:], 4).tolist() == [0.0, 0.1684]
    assert np.round(proportion(29, 29)[1:], 4).tolist() == [0.8806, 1.0]
    one, other = Estimate(3.0, 2.0, 5.0), Estimate(1.0, 0.0, 1.5)
    assert difference(one, other) == pytest.approx((2.0, 2 - 1.25**0.5, 2 + 5**0.5))
    assert wider(one, other) == (3.0, 0.0, 5.0)
    assert not mean([1.0]).has_interval


@pytest.mark.parametrize(
    ("trials", "fewest"), [(10, (7, 8, 9)), (15, (9, 10, 12)), (24, (13, 15, 16)), (60, (27, 30, 33))]
)
def test_fewest_right_answers_of_the_triangular_method_are_as_published(trials: int, fewest: tuple[int, int, int]):
    """The table of critical numbers in FAO, Manuals of Food Quality Control, at 5, 1 and 0.1 %."""
    for count, level in zip(fewest, (0.05, 0.01, 0.001), strict=True):
        assert p_of_count(count, trials, 1 / 3, one_sided=True) <= level
        assert p_of_count(count - 1, trials, 1 / 3, one_sided=True) > level


def test_fit_of_a_difference_has_the_bounds_of_its_likelihood():
    """Two intervals, a Weibull function of the logarithm: threshold and lapses as psignifit alone finds them."""
    curve = fit_difference(blocks(DETECTION, 90), (0.001, 0.01), choices=2)
    assert curve.threshold.value == pytest.approx(
        0.00465, rel=0.02
    )  # MATLAB's psignifit 4, cumulative Gaussian: 0.004645
    assert curve.threshold.low < 0.00465 < curve.threshold.high
    assert curve.at(np.array([1e-9, 1.0])) == pytest.approx([0.5, 1 - curve.lapses], abs=1e-3)
    assert curve.at(np.array([curve.threshold.value])) == pytest.approx([0.75], abs=0.01)
    levels, trials = np.linspace(1.4, 2.6, 7), 40.0
    counts = np.array([1, 4, 11, 22, 30, 36, 38], float)
    counted = Blocks(levels, counts, np.full(7, trials))

    def lack(width: float) -> float:
        def negative(free: np.ndarray) -> float:
            lapses = MAX_LAPSES / (1 + np.exp(-free[1]))
            share = lapses + (1 - 2 * lapses) * stats.norm.cdf((levels - free[0]) / (width / GAUSSIAN))
            return -float((counts * np.log(share) + (trials - counts) * np.log1p(-share)).sum())

        return min(float(optimize.minimize(negative, [2.0, at], method="Nelder-Mead").fun) for at in (-4.0, -1.0))

    best = optimize.minimize_scalar(lack, bounds=(0.3, 3.0), method="bounded")
    found = width_interval(counted, Estimate(1.97, 1.9, 2.04), float(best.x))
    assert found.value == best.x
    for bound in (found.low, found.high):
        assert 2 * (lack(bound) - best.fun) == pytest.approx(stats.chi2.ppf(0.95, 1), abs=0.02)


def test_fit_of_choices_finds_the_function_or_a_bound():
    levels, near = np.linspace(1.4, 2.6, 7), Estimate(2.0, 1.9, 2.1)
    flat = width_interval(Blocks(levels, np.full(7, 20.0), np.full(7, 40.0)), near, 2.0)
    assert flat.high == np.inf and flat.low > 0.5
    step = width_interval(Blocks(levels, np.array([0.0, 0, 0, 20, 40, 40, 40]), np.full(7, 40.0)), near, 0.1)
    assert step.low == 0.0 and step.high < 0.4
    levels = np.linspace(1.4, 2.6, 7)
    expected = 0.02 + 0.96 * stats.norm.cdf((levels - 2.05) / (0.6 / 3.2897))
    curve = fit_choice(Blocks(levels, np.round(400 * expected), np.full(7, 400.0)), (1.4, 2.6))
    assert curve.threshold.value == pytest.approx(2.05, abs=0.01)
    assert curve.width.value == pytest.approx(0.6, rel=0.05)
    assert curve.lapses == pytest.approx(0.02, abs=0.01)
    assert curve.at(levels) == pytest.approx(expected, abs=0.01)
    assert curve.threshold.holds(2.05)
    assert pytest.approx(stats.norm.ppf(0.75) / (2 * stats.norm.ppf(0.95)), rel=1e-6) == JND
