"""The mapping as the page draws it: the same numbers as the core's. What limits the force."""

import asyncio
import json
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from tangible_core.data import Vector
from tangible_core.mapping import WorkspaceMapping
from tangible_ui.requests.devices import limits
from tangible_ui.worker.jobs import devices as mapping
from tangible_ui.worker.state import WorkerState

CASES = Path(__file__).parents[3] / "plugins/ui/web/test/placement.json"
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


def test_limits_are_counted_by_the_loop():
    """The page takes two of these counts a second apart."""
    flagged = {"DAMPED": 3, "STALE": 1}
    servo = SimpleNamespace(report=lambda: SimpleNamespace(ticks=1000, overruns=2, flagged=flagged))
    for felt_by, counted in ((None, None), (servo, {"ticks": 1000, "overruns": 2, "flagged": flagged})):
        session: Any = SimpleNamespace(feeling=SimpleNamespace(servo=felt_by))
        assert asyncio.run(limits(session, session)) == counted
