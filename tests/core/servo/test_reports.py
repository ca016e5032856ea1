"""Reports of a loop: the numbers that a person sees of a session, the same for every kind of loop."""

import numpy as np
import pytest

from ring_ticks import put
from tangible_core.data import NO_FORCE, TICK_COLUMNS, Force, HapticState, ServoReport, TickFlag
from tangible_core.servo import Ring
from tangible_core.servo.guard.layout import COUNTS
from tangible_core.servo.reports import LoopTotals, brief_report, report, spread
from tangible_core.servo.ring import OVERRUNS
from tangible_core.servo.ticks import cycle
from tangible_core.servo.ticks.loop import sections
from tangible_core.session import Recording, figures


def test_brief_report_has_the_last_tick():
    rows = np.arange(2.0 * len(TICK_COLUMNS)).reshape(2, -1)
    assert brief_report(rows, 7, 1.5, 0.25, "it is over") == ServoReport(
        ticks=7,
        time_s=17.0,
        state=HapticState((19.0, 20.0, 21.0), (22.0, 23.0, 24.0), 17.0, 32),
        force=Force(28.0, 29.0, 30.0),
        peak_force_n=1.5,
        work_j=0.25,
        stopped="it is over",
        frame=33,
    )


def test_brief_report_before_the_first_tick_is_empty():
    nothing = brief_report(np.empty((0, len(TICK_COLUMNS))), 0, 0.0, 0.0, "")
    assert nothing == ServoReport(0, 0.0, HapticState((0.0, 0.0, 0.0)), NO_FORCE, 0.0, 0.0)


class TestReport:
    def test_report_of_empty_ring_is_empty(self, small: Ring) -> None:
        assert report(small).ticks == 0

    def test_report_has_the_sums_of_the_ring(self, small: Ring) -> None:
        """Force and position are (k, k, k) at tick k: the work is that of each force over the way to the next tick."""
        put(small, *range(20))
        found = report(small, "over")
        assert (found.ticks, found.stopped, found.overruns) == (20, "over", 0)
        assert found.peak_force_n == pytest.approx(19 * np.sqrt(3))
        assert found.work_j == pytest.approx(3 * sum(range(19)))
        assert (found.period_us, found.late_us) == ((1000, 1000, 1000, 1000), (18, 38, 38, 38))

    def test_report_has_each_number_under_its_name(self, small: Ring) -> None:
        row = np.arange(100.0, 100.0 + len(TICK_COLUMNS))
        cycle.finish(sections(small), row, 5, 7_000)
        small.header[OVERRUNS], small.guard[COUNTS + 2] = 3, 8
        found = report(small)
        assert found.time_s == 100
        assert found.state == HapticState((102, 103, 104), (105, 106, 107), 100, 115)
        assert found.force == Force(111, 112, 113)
        assert (found.overruns, found.flagged) == (3, {"SLEW_LIMITED": 8})
        assert found.late_us == pytest.approx((7, 7, 7, 7))
        assert found.period_us == (0, 0, 0, 0)

    def test_report_has_the_greatest_values_of_all_ticks(self, small: Ring) -> None:
        for at_ns, late_ns, force_n in ((0, 50_000, 3.0), (5_000_000, 2_000, 1.0), (6_000_000, 0, 0.0)):
            row = np.zeros(len(TICK_COLUMNS))
            row[11] = force_n
            cycle.finish(sections(small), row, at_ns, late_ns)
        found = report(small)
        assert found.peak_force_n == 3
        assert found.late_us is not None and found.late_us.most == pytest.approx(50)
        assert found.period_us is not None and found.period_us.most == pytest.approx(5000)

    def test_report_contact_matches_the_recording(self, small: Ring) -> None:
        for force_n in (0.0, 2.0004, 5.0, 5.0, 1e9):
            row = np.zeros(len(TICK_COLUMNS))
            row[11], row[cycle.FLAGS] = force_n, TickFlag.TOUCHING
            cycle.finish(sections(small), row, 0, 0)
        small.guard[COUNTS] = 5
        live, kept = figures(report(small)), Recording(small.since(0)[0]).figures()
        assert live["contact_share"] == kept["contact_share"] == 0.8
        assert live["median_contact_force_n"] == pytest.approx(kept["median_contact_force_n"], abs=1e-3)
        assert np.flatnonzero(small.contact).tolist() == [2000, 5000, len(small.contact) - 1]

    def test_totals_of_consecutive_loops_are_added(self, small: Ring) -> None:
        put(small, *range(20))
        small.guard[COUNTS + 2] = 8
        small.header[OVERRUNS] = 3
        one = report(small)
        both = report(small, "over", LoopTotals.of(small), 100.0)
        assert (both.ticks, both.overruns, both.flagged) == (40, 6, {"SLEW_LIMITED": 16})
        assert (both.time_s, both.work_j) == (one.time_s + 100, 2 * one.work_j)
        same = ("peak_force_n", "period_us", "late_us", "contact_share", "median_contact_force_n")
        assert [getattr(both, each) for each in same] == [getattr(one, each) for each in same]

    def test_spread_has_the_quantiles_of_a_histogram(self) -> None:
        counts = np.zeros(100, np.int64)
        counts[[10, 20, 30, 40]] = 989, 10, 1, 0
        assert spread(counts, 31e-6) == (10, 20, 20, 31)
