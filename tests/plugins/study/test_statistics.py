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
    MOST_LAPSES,
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


def test_scale_of_baseball_teams_is_as_published():
    scale = fit_scale([BASEBALL])
    assert np.round(scale.values[:-1] - scale.values[-1], 2).tolist() == [1.58, 1.44, 1.29, 1.25, 1.11, 0.68]
    halves = [scale.difference(team, 6).high - scale.difference(team, 6).value for team in range(6)]
    assert np.round(np.array(halves) / 1.96, 1).tolist() == [0.3] * 6
    assert scale.values.mean() == pytest.approx(0, abs=1e-12)


def test_scale_with_one_that_always_wins_is_finite_and_is_marked():
    scale = fit_scale([np.array([[0.0, 9, 9], [0, 0, 5], [0, 4, 0]])])
    assert scale.was_completed
    assert np.isfinite(scale.values).all()
    assert scale.values.argmax() == 0
    completed = fit_scale([np.array([[0, 9.5, 9.5], [0.5, 0, 5.5], [0.5, 4.5, 0]])])
    assert scale.values == pytest.approx(completed.values, abs=1e-9)
    assert not fit_scale([BASEBALL]).was_completed


def test_scale_of_participants_who_disagree_is_less_certain():
    alike = [np.array([[0.0, 6], [4, 0]])] * 8
    apart = [*[np.array([[0.0, 10], [0, 0]])] * 5, *[np.array([[0.0, 0], [10, 0]])] * 3]
    widths = [np.ptp(fit_scale(each).difference(0, 1)[1:]) for each in (alike, apart)]
    assert widths[1] > 2 * widths[0]


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


def test_scale_is_where_choices_are_as_many_as_expected():
    """Where the likelihood is greatest, wins are the sum of the chances, however far apart the values are."""
    for wins in (BASEBALL, np.array([[0.0, 999, 999], [1, 0, 990], [1, 10, 0]])):
        values = fit_scale([wins]).values
        chance = 1 / (1 + np.exp(values[None] - values[:, None]))
        assert ((wins + wins.T) * chance).sum(axis=1) - 0.5 * np.diag(wins + wins.T) == pytest.approx(wins.sum(axis=1))


@pytest.mark.parametrize(
    ("share", "dprime"), [(0.36, 0.55), (0.5, 1.47), (0.6, 1.98), (0.7, 2.50), (0.8, 3.13), (0.9, 4.03), (0.95, 4.80)]
)
def test_dprime_of_the_odd_one_is_that_of_the_triangular_method(share: float, dprime: float):
    """By the integral of Frijters, Kooistra & Vereijken (1980), Perception & Psychophysics 27:176, solved apart."""
    assert round(sensitivity.oddity(share), 2) == dprime


def test_dprime_of_the_odd_one_is_that_of_simulated_observers():
    felt = np.random.default_rng(3).standard_normal((200_000, 3)) + np.array([2.0, 0, 0])
    farthest = np.abs(felt - (felt.sum(1, keepdims=True) - felt) / 2).argmax(1)
    assert (farthest == 0).mean() == pytest.approx(sensitivity.oddity_correct(2.0), abs=0.004)


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


def test_dprime_of_same_or_different_is_that_of_simulated_observers():
    """Whatever the criterion; 200,000 trials of each kind."""
    noise = np.random.default_rng(4).standard_normal((2, 200_000)) * 2**0.5
    for dprime, criterion in ((0.7, 1.0), (1.5, 1.5), (1.5, 2.5), (3.0, 1.8)):
        hits, alarms = ((np.abs(noise[0] + dprime) > criterion).sum(), (np.abs(noise[1]) > criterion).sum())
        found = sensitivity.same_different(int(hits), 200_000, int(alarms), 200_000)
        assert found.value == pytest.approx(dprime, abs=0.04)
        assert found.high - found.low < 0.12


def test_intervals_of_same_or_different_hold_the_truth_as_often_as_they_say():
    random = np.random.default_rng(5)
    held = []
    for _ in range(600):
        dprime, criterion = random.uniform(1.0, 3.0), random.uniform(1.2, 2.2)
        alarms = random.binomial(30, 2 * stats.norm.cdf(-criterion / 2**0.5))
        share = stats.norm.cdf((dprime - criterion) / 2**0.5) + stats.norm.cdf((-dprime - criterion) / 2**0.5)
        held.append(sensitivity.same_different(random.binomial(30, share), 30, alarms, 30).holds(dprime))
    assert 0.92 < np.mean(held) < 0.98


def test_dprime_of_same_or_different_at_the_ends():
    none = sensitivity.same_different(5, 10, 5, 10)
    assert none.value == none.low == 0.0
    every = sensitivity.same_different(20, 20, 0, 20)
    assert every.value > 4 and every.high == np.inf
    assert np.isnan(sensitivity.same_different(3, 10, 0, 0).value)


@pytest.mark.parametrize(("share", "dprime"), [(0.55, 0.18), (0.76, 1.0), (0.85, 1.47), (0.92, 1.99)])
def test_dprime_of_two_intervals_is_that_of_the_tables(share: float, dprime: float):
    assert round(sensitivity.two_afc(share), 2) == dprime
    assert sensitivity.naming(share, 2) == pytest.approx(sensitivity.two_afc(share), abs=1e-6)


def test_dprime_at_the_ends():
    assert sensitivity.oddity(1.0) == np.inf
    assert sensitivity.oddity(0.2) == 0.0
    for near in np.linspace(-1e-13, 1e-13, 9).tolist():  # means of shares, such as (0.25 + 0.25 + 0.5) / 3
        assert sensitivity.oddity(1 / 3 + near) == pytest.approx(0.0, abs=1e-3)
        assert sensitivity.naming(0.2 + near, 5) == pytest.approx(0.0, abs=1e-3)
    assert sensitivity.naming(0.1, 5) == 0.0


def test_exact_interval_is_as_published():
    """Newcombe (1998), Statistics in Medicine 17:857, table I, method 5."""
    assert np.round(proportion(81, 263), 4).tolist() == [0.308, 0.2527, 0.3676]
    assert np.round(proportion(15, 148), 4).tolist() == [0.1014, 0.0578, 0.1617]
    assert np.round(proportion(0, 20)[1:], 4).tolist() == [0.0, 0.1684]
    assert np.round(proportion(29, 29)[1:], 4).tolist() == [0.8806, 1.0]


def test_exact_intervals_hold_the_truth_at_least_as_often_as_they_say():
    for share in (0.1, 1 / 3, 0.62, 0.95):
        counts = np.arange(41)
        held = [proportion(count, 40).holds(share) for count in counts.tolist()]
        assert stats.binom.pmf(counts, 40, share)[held].sum() >= 0.95


def test_difference_of_two_intervals_is_as_that_of_two_means():
    one, other = Estimate(3.0, 2.0, 4.0), Estimate(1.0, 0.0, 2.0)
    assert difference(one, other) == pytest.approx((2.0, 2 - 2**0.5, 2 + 2**0.5))
    assert wider(one, other) == (3.0, 0.0, 4.0)
    assert not mean([1.0]).has_interval


def test_difference_of_two_intervals_takes_the_side_that_faces():
    """By hand: the lower bound needs the lower side of the first and the upper side of the second."""
    found = difference(Estimate(3.0, 2.0, 5.0), Estimate(1.0, 0.0, 1.5))
    assert found == pytest.approx((2.0, 2 - 1.25**0.5, 2 + 5**0.5))


def test_interval_of_a_mean_is_students():
    """4.303 is the quantile of the table for two degrees of freedom, and the standard deviation is 1."""
    assert mean([1.0, 2.0, 3.0]) == pytest.approx((2.0, 2 - 4.3027 / 3**0.5, 2 + 4.3027 / 3**0.5), abs=1e-4)


@pytest.mark.parametrize(
    ("trials", "fewest"), [(10, (7, 8, 9)), (15, (9, 10, 12)), (24, (13, 15, 16)), (60, (27, 30, 33))]
)
def test_fewest_right_answers_of_the_triangular_method_are_as_published(trials: int, fewest: tuple[int, int, int]):
    """The table of critical numbers in FAO, Manuals of Food Quality Control, at 5, 1 and 0.1 %."""
    for count, level in zip(fewest, (0.05, 0.01, 0.001), strict=True):
        assert p_of_count(count, trials, 1 / 3, one_sided=True) <= level
        assert p_of_count(count - 1, trials, 1 / 3, one_sided=True) > level


def test_fit_of_a_difference_is_that_of_psignifit_on_its_own_example():
    """Two intervals, a Weibull function of the logarithm: threshold and lapses as psignifit alone finds them."""
    curve = fit_difference(blocks(DETECTION, 90), (0.001, 0.01), choices=2)
    assert curve.threshold.value == pytest.approx(
        0.00465, rel=0.02
    )  # MATLAB's psignifit 4, cumulative Gaussian: 0.004645
    assert curve.threshold.low < 0.00465 < curve.threshold.high
    assert curve.at(np.array([1e-9, 1.0])) == pytest.approx([0.5, 1 - curve.lapses], abs=1e-3)
    assert curve.at(np.array([curve.threshold.value])) == pytest.approx([0.75], abs=0.01)


def test_bounds_of_a_width_are_where_the_likelihood_ratio_has_its_quantile():
    """By another way to the best threshold and lapses of each width: the simplex of Nelder & Mead."""
    levels, trials = np.linspace(1.4, 2.6, 7), 40.0
    counts = np.array([1, 4, 11, 22, 30, 36, 38], float)
    blocks = Blocks(levels, counts, np.full(7, trials))

    def lack(width: float) -> float:
        def negative(free: np.ndarray) -> float:
            lapses = MOST_LAPSES / (1 + np.exp(-free[1]))
            share = lapses + (1 - 2 * lapses) * stats.norm.cdf((levels - free[0]) / (width / GAUSSIAN))
            return -float((counts * np.log(share) + (trials - counts) * np.log1p(-share)).sum())

        return min(float(optimize.minimize(negative, [2.0, at], method="Nelder-Mead").fun) for at in (-4.0, -1.0))

    best = optimize.minimize_scalar(lack, bounds=(0.3, 3.0), method="bounded")
    found = width_interval(blocks, Estimate(1.97, 1.9, 2.04), float(best.x))
    assert found.value == best.x
    for bound in (found.low, found.high):
        assert 2 * (lack(bound) - best.fun) == pytest.approx(stats.chi2.ppf(0.95, 1), abs=0.02)


def test_width_without_a_rise_has_no_upper_bound_and_a_step_no_lower():
    levels, near = np.linspace(1.4, 2.6, 7), Estimate(2.0, 1.9, 2.1)
    flat = width_interval(Blocks(levels, np.full(7, 20.0), np.full(7, 40.0)), near, 2.0)
    assert flat.high == np.inf and flat.low > 0.5
    step = width_interval(Blocks(levels, np.array([0.0, 0, 0, 20, 40, 40, 40]), np.full(7, 40.0)), near, 0.1)
    assert step.low == 0.0 and step.high < 0.4


def test_fit_of_choices_finds_the_function_that_made_them():
    levels = np.linspace(1.4, 2.6, 7)
    expected = 0.02 + 0.96 * stats.norm.cdf((levels - 2.05) / (0.6 / 3.2897))
    curve = fit_choice(Blocks(levels, np.round(400 * expected), np.full(7, 400.0)), (1.4, 2.6))
    assert curve.threshold.value == pytest.approx(2.05, abs=0.01)
    assert curve.width.value == pytest.approx(0.6, rel=0.05)
    assert curve.lapses == pytest.approx(0.02, abs=0.01)
    assert curve.at(levels) == pytest.approx(expected, abs=0.01)
    assert curve.threshold.holds(2.05)
    assert pytest.approx(stats.norm.ppf(0.75) / (2 * stats.norm.ppf(0.95)), rel=1e-6) == JND
