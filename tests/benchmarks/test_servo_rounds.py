"""What is counted of interleaved rounds, on rounds that are made up."""

import numpy as np
import pytest

from benchmarks.servo_late import HEADINGS
from benchmarks.servo_rounds import Round, chance_of, no_later, no_more_overruns, rows, together
from tangible_core.servo.ring import WIDEST_US


def counted(late: dict[int, int], overruns: int = 0, most_late_s: float = 0.0) -> Round:
    """A round with so many ticks at each of these microseconds."""
    histogram = np.zeros(WIDEST_US, np.int64)
    histogram[list(late)] = list(late.values())
    return Round(histogram, overruns, most_late_s)


def of(*percent: float) -> list[Round]:
    """Rounds of 10,000 ticks, of which so many per cent are late."""
    return [counted({3: 10_000 - round(100 * each), 500: round(100 * each)}) for each in percent]


def standing(*overruns: int) -> list[Round]:
    return [counted({3: 4000}, each) for each in overruns]


def test_tick_is_late_from_200_us_on():
    assert counted({0: 900, 199: 90, 200: 6, 4095: 4}).late_percent == pytest.approx(1.0)
    assert counted({}).late_percent == 0


def test_rounds_together_have_all_their_ticks():
    both = together([counted({10: 98}, 2, 0.001), counted({300: 2}, 5, 0.007)])
    assert (both.late_percent, both.overruns, both.late.sum()) == (2.0, 7, 100)
    assert both.late_us == (10.0, 300.0, 300.0, 7000.0)


def test_share_of_late_ticks_is_the_median_of_the_rounds():
    """One round that the machine stood still in decides nothing."""
    assert no_later(of(1.0, 1.1, 90.0), of(1.0, 1.0, 1.0))
    assert not no_later(of(1.3, 1.3, 0.0), of(1.0, 1.0, 1.0))


@pytest.mark.parametrize(
    ("mine", "other", "met"), [(1.2, 1.0, True), (1.21, 1.0, False), (0.1, 0.0, True), (0.11, 0.0, False)]
)
def test_share_within_a_fifth_or_a_tenth_of_a_point_is_not_later(mine: float, other: float, met: bool):
    assert no_later(of(mine), of(other)) == met


def test_chance_is_every_exchange_within_the_pairs():
    assert chance_of([3, 5], [1, 1]) == 0.25
    assert chance_of([1, 1], [3, 5]) == 1.0
    assert chance_of([0] * 8, [0] * 8) == 1.0


def test_difference_in_every_round_is_significant():
    assert not no_more_overruns(standing(*[3] * 8), standing(*[2] * 8))
    assert not no_more_overruns(standing(4, 9, 3, 7, 5, 6, 4, 8), standing(2, 8, 3, 5, 4, 5, 3, 7))


def test_single_standstill_is_chance():
    assert no_more_overruns(standing(300, 0, 0, 1, 0, 0, 0, 0), standing(0, 0, 1, 0, 0, 0, 0, 0))
    assert no_more_overruns(standing(*[0] * 8), standing(*[0] * 8))
    assert no_more_overruns(standing(*[1] * 8), standing(*[2] * 8))


def test_row_has_the_median_share_and_the_quantiles_of_all():
    found = rows({"a loop": [counted({20: 999, 400: 1}, 1, 0.0004), counted({20: 1000}), counted({20: 1000})]})
    assert found == [("a loop", "0.000 %", "20 us", "20 us", "20 us", "400 us", "1")]
    assert len(found[0]) == len(HEADINGS)
