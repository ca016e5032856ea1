"""The schedule of ticks: ticks that are made up for push twice, and a lead that never falls keeps a processor busy."""

import numpy as np
import pytest

from tangible_core.servo.ring import LEAD_NS, NEXT_NS, OVERRUNS, PERIOD_NS, SPINS
from tangible_core.servo.ticks import cycle, schedule

PERIOD, FIRST = 1_000_000, 5_000_000
COMPILED = pytest.mark.parametrize("begin_tick", [schedule.begin_tick, cycle.begin_tick], ids=["python", "compiled"])


def header(lead_ns: int = 0, spins: bool = False) -> np.ndarray:
    """Return the header of a loop whose first tick is due."""
    words = np.zeros(64, np.int64)
    words[[PERIOD_NS, NEXT_NS, LEAD_NS, SPINS]] = PERIOD, FIRST, lead_ns, spins
    return words


@COMPILED
@pytest.mark.parametrize(
    ("late_ns", "missed"), [(0, 0), (999_999, 0), (1_000_000, 1), (3_500_000, 3), (1_000_000_000, 1000)]
)
def test_missed_periods_are_counted_and_the_next_tick_is_in_step(begin_tick, late_ns: int, missed: int):
    words = header()
    assert begin_tick(words, FIRST + late_ns) == late_ns
    assert words[OVERRUNS] == missed
    assert words[NEXT_NS] == FIRST + (missed + 1) * PERIOD
    assert words[NEXT_NS] > FIRST + late_ns, "nothing is made up for"
    begin_tick(words, words[NEXT_NS] + 2 * PERIOD)
    assert words[OVERRUNS] == missed + 2


@COMPILED
@pytest.mark.parametrize(
    ("late_ns", "before_ns", "after_ns"),
    [
        (1_001, 20_000, 30_000),
        (1_001, 145_000, 150_000),
        (10_000_000, 150_000, 150_000),
        (1_000, 20_000, 19_990),
        (0, 10, 0),
        (0, 5, 0),
        (0, 0, 0),
    ],
)
def test_lead_grows_fast_and_shrinks_by_a_thousandth_of_that(begin_tick, late_ns: int, before_ns: int, after_ns: int):
    words = header(before_ns, spins=True)
    begin_tick(words, FIRST + late_ns)
    assert words[LEAD_NS] == after_ns


@COMPILED
@pytest.mark.parametrize("late_ns", [0, 50_000])
def test_lead_without_the_right_to_spin_is_zero(begin_tick, late_ns: int):
    words = header()
    begin_tick(words, FIRST + late_ns)
    assert words[LEAD_NS] == 0
