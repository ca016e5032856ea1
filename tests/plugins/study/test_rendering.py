"""Whether a device rendered what was requested, by the flags of the ticks."""

import numpy as np
import pytest

from tangible_core.data import TICK_COLUMNS, TickFlag
from tangible_study.design import Limits
from tangible_study.presenting.presenter import Rendering

TIME, LATE, FLAGS = (TICK_COLUMNS.index(each) for each in ("time_s", "late_s", "flags"))


def ticks(count: int, flag: int, share: float) -> Rendering:
    """Return the rendering of ticks that touch, of which a share has a flag."""
    rows = np.zeros((count, len(TICK_COLUMNS)))
    rows[:, TIME] = np.arange(count) / 1000
    rows[:, FLAGS] = TickFlag.TOUCHING
    rows[: round(share * count), FLAGS] += flag
    rendering = Rendering()
    rendering.add(rows[: count // 2])
    rendering.add(rows[count // 2 :])
    return rendering


@pytest.mark.parametrize(
    ("share", "said"),
    [(0.01, None), (0.011, "1 % of the ticks came too late"), (0.03, "3 % of the ticks came too late")],
)
def test_share_of_late_ticks_marks_a_trial(share: float, said: str | None):
    assert ticks(1000, TickFlag.OVERRUN, share).why_not(Limits()) == said


def test_share_of_limited_ticks_is_one_of_the_time_in_contact():
    rendering = ticks(1000, TickFlag.SLEW_LIMITED, 0.02)
    assert rendering.why_not(Limits()) == (
        "the force was delayed, as it changed too quickly, in 2 % of the time in contact"
    )
    for most, marked in ((0.05, False), (0.02, False), (0.019, True)):
        assert (rendering.why_not(Limits(limited=most)) is not None) == marked
    assert (rendering.ticks, rendering.last_s) == (1000, 0.999)


def test_lateness_of_each_part_of_the_ticks_is_kept():
    rendering = Rendering()
    for longer in (1, 2):
        rows = np.zeros((101, len(TICK_COLUMNS)))
        rows[:, LATE] = longer * np.arange(101) * 1e-6
        rendering.add(rows)
    rendering.add(rows[:0])
    assert rendering.late_s == pytest.approx([99e-6, 100e-6, 198e-6, 200e-6])
    assert rendering.ticks == 202
