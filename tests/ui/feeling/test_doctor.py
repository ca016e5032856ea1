"""Figures of the loop for the page, what its own hand leaves of a document, and the hand of the law beside it."""

from types import SimpleNamespace
from unittest.mock import Mock

import numpy as np
import pytest

from tangible_core.data import TICK_COLUMNS
from tangible_core.servo import Servo
from tangible_ui.feeling.choice import Choice
from tangible_ui.feeling.comparison import HIGHEST_M, ComparisonLoop
from tangible_ui.feeling.doctor import LATE_US, figures
from tangible_ui.framing import BUTTON_BITS


def test_figures_are_those_of_the_last_second_and_of_the_whole_loop() -> None:
    rows = np.zeros((5, len(TICK_COLUMNS)))
    rows[:, 0] = np.arange(5) * 0.002
    rows[:, TICK_COLUMNS.index("late_s")] = np.array([50, 150, 200, 201, 900]) * 1e-6
    rows[-1, TICK_COLUMNS.index("buttons")] = (7 << BUTTON_BITS) + 3
    late = np.zeros(4096, np.int64)
    late[[0, 150, LATE_US, LATE_US + 1, -1]] = [10, 2, 4, 1, 3]
    whole = SimpleNamespace(p50=1.0, p99=2.0, most=3.0)
    report = SimpleNamespace(
        force=(0.3, 0.0, 0.4), peak_force_n=2.0, late_us=whole, ticks=20, overruns=1, flagged={"force": 2},
        state=SimpleNamespace(position_m=(1.0, 2.0, 3.0)),
    )  # fmt: skip
    asked: list[int] = []

    def since(count: int) -> tuple[np.ndarray, int]:
        asked.append(count)
        return rows, 0

    ring = SimpleNamespace(count=7000, since=since, late=late)
    found = figures(Mock(Servo, report=lambda: report, ring=ring, how="in turn"))
    assert asked == [6000]
    assert found["rate_hz"] == pytest.approx(500)
    assert found["late_us"] == pytest.approx({"p50": 200, "p99": 872.04, "most": 900})
    assert (found["late_share"], found["whole_late_share"]) == (0.4, 4 / 20)
    assert found["force_n"] == pytest.approx(0.5)
    assert (found["buttons"], found["ticks"], found["overruns"]) == (3, 20, 1)
    assert found["whole_late_us"] == {"p50": 1.0, "p99": 2.0, "most": 3.0}
    assert (found["most_force_n"], found["position_m"]) == (2.0, [1.0, 2.0, 3.0])
    assert (found["flagged"], found["how"]) == ({"force": 2}, "in turn")
    for ticks, rate_hz in ((2, 500.0), (1, 0.0), (0, 0.0)):  # two, one, which has no rate, and none yet
        rows, late = rows[:ticks], 0 * late
        ring.late, report.late_us = late, None
        found = figures(Mock(Servo, report=lambda: report, ring=ring, how=""))
        assert (found["rate_hz"], found["whole_late_us"], found["whole_late_share"]) == (rate_hz, None, 0.0)
        assert (found["late_us"] is None, found["late_share"], found["buttons"]) == (ticks == 0, 0.0, 0)


def test_page_s_hand_has_neither_clutch_nor_limits_of_another_device() -> None:
    own = {"use": "pointer"}
    assert Choice().sets(own) == ['device={"use": "pointer"}', "mapping.clutch_button=null", "mapping.limits_m=null"]
    assert Choice("document").sets(own) == []
    assert Choice("other", "falcon").sets(own) == ['device={"use": "falcon"}']


@pytest.mark.parametrize(("z", "sent"), [(0.01, True), (HIGHEST_M - 0.01, True), (HIGHEST_M, False), (np.inf, False)])
def test_hand_of_the_law_beside_is_released_above_every_surface(z: float, sent: bool) -> None:
    beside, client = ComparisonLoop("none"), Mock()
    beside._client = client  # pyright: ignore[reportPrivateUsage]
    beside.follow((0.01, 0.02, z))
    assert [name for name, _, _ in client.mock_calls] == ["send" if sent else "release"]
