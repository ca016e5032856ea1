"""Figures of the loop, and the page's hand: otherwise the page calls a late loop good."""

import json
from pathlib import Path
from types import SimpleNamespace
from unittest.mock import Mock

import numpy as np
import pytest

from tangible_core.data import TICK_COLUMNS, Vector
from tangible_core.mapping import WorkspaceMapping
from tangible_core.servo import Servo
from tangible_ui.feeling.choice import Choice
from tangible_ui.feeling.comparison import HIGHEST_M, ComparisonLoop
from tangible_ui.requests.devices import LATE_US, figures
from tangible_ui.worker.jobs import installed as mapping
from tangible_ui.worker.state import WorkerState
from tangible_web.framing import BUTTON_BITS


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


CASES = Path(__file__).parents[3] / "plugins/web/test/placement.json"
PATH = Path("p.yaml")


def test_mapping_reference_of_the_page_is_the_core_s():
    """web/test/placement.test.ts computes the same cases in the page's language."""
    cases = json.loads(CASES.read_text())["cases"]
    assert len(cases) > 4
    for case in cases:
        to = WorkspaceMapping(**case["mapping"]).placement(vector(case["workspace_m"]))
        x, y, z = case["hand_m"]
        u, v = to.rotate_back(x - to.offset_x_m, y - to.offset_y_m)
        under = to.centre_x_m + u / to.scale, to.centre_y_m + v / to.scale, (z - to.offset_z_m) / to.scale
        assert case["scale"] == pytest.approx(to.scale, rel=1e-12)
        assert case["picture_m"] == pytest.approx(under, abs=1e-12)


def vector(numbers: list[float]) -> Vector:
    x, y, z = numbers
    return x, y, z


@pytest.mark.parametrize(
    ("device", "name", "workspace_m"),
    [("", "", None), ("device: {use: falcon-simulated}\n", "falcon-simulated", [0.08, 0.08, 0.08])],
    ids=["none", "one"],
)
def test_reach_is_that_of_the_document_s_device(
    worker_state: WorkerState, device: str, name: str, workspace_m: list[float] | None
):
    text = f"scene: builtin/brick\nmapping: {{scale: 3}}\n{device}"
    found = mapping.reach(worker_state, text, PATH, [])
    assert found == {"device": name, "workspace_m": pytest.approx(workspace_m) if workspace_m else None}
