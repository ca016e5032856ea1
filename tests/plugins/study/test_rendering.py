"""Whether a device rendered what was requested, by the flags of the ticks."""

import numpy as np
import pytest

from tangible_core.data import TICK_COLUMNS, TickFlag
from tangible_study.design.study import Limits
from tangible_study.presenting.rendering import Rendering

TIME, FLAGS = TICK_COLUMNS.index("time_s"), TICK_COLUMNS.index("flags")


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


@pytest.mark.parametrize(("share", "said"), [(0.009, None), (0.03, "3 % of the ticks came too late")])
def test_share_of_late_ticks_marks_a_trial(share: float, said: str | None):
    assert ticks(1000, TickFlag.OVERRUN, share).why_not(Limits()) == said


def test_share_of_limited_ticks_is_one_of_the_time_in_contact():
    rendering = ticks(1000, TickFlag.SLEW_LIMITED, 0.02)
    assert rendering.why_not(Limits()) == (
        "the force was delayed, as it changed too quickly, in 2 % of the time in contact"
    )
    assert rendering.why_not(Limits(limited=0.05)) is None
    assert (rendering.ticks, rendering.last_s) == (1000, 0.999)
