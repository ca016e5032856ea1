"""The mapping as the page draws and drags it: the same numbers as the core's, and a text that else stays."""

import json
from pathlib import Path
from typing import Any

import pytest

from tangible_core.data import Vector
from tangible_core.errors import ConfigError
from tangible_core.mapping import WorkspaceMapping
from tangible_core.pipeline.editing import said
from tangible_ui.maker import mapping
from tangible_ui.maker.bench import Bench

CASES = Path(__file__).parents[2] / "plugins/ui/web/test/placement.json"
OF_MINE = """\
scene: builtin/brick  # mine
mapping:
  scale: 2            # twice
  clutch_button: 1    # stays
device: {use: mock}
"""
PATH = Path("p.yaml")
AS_IT_LIES: dict[str, Any] = {"scale": None, "region_m": None, "rotation_deg": 0, "offset_m": [0, 0, 0]}


@pytest.fixture
def bench(tmp_path: Path) -> Bench:
    return Bench(tmp_path, lambda event, **told: None)


def test_the_page_s_reference_is_what_the_core_computes():
    """web/test/placement.test.ts computes the same cases in the page's language."""
    cases = json.loads(CASES.read_text())["cases"]
    assert len(cases) > 4
    for case in cases:
        to = WorkspaceMapping(**case["mapping"]).placement(vector(case["workspace_m"]))
        x, y, z = case["hand_m"]
        u, v = to.turned_back(x - to.offset_x_m, y - to.offset_y_m)
        under = to.centre_x_m + u / to.scale, to.centre_y_m + v / to.scale, (z - to.offset_z_m) / to.scale
        assert case["scale"] == pytest.approx(to.scale, rel=1e-12)
        assert case["picture_m"] == pytest.approx(under, abs=1e-12)


def vector(numbers: list[float]) -> Vector:
    x, y, z = numbers
    return x, y, z


def test_another_mapping_leaves_the_rest_of_the_text(bench: Bench):
    wanted = {**AS_IT_LIES, "region_m": [0.01, 0, 0.02, 0.02], "rotation_deg": 90}
    text = mapping.place(bench, OF_MINE, PATH, wanted)
    assert said(text, PATH)["mapping"] == {
        "clutch_button": 1, "region_m": [0.01, 0, 0.02, 0.02], "rotation_deg": 90,
    }  # fmt: skip
    assert "# mine" in text
    assert "clutch_button: 1    # stays" in text
    again = mapping.place(bench, text, PATH, AS_IT_LIES)
    assert said(again, PATH)["mapping"] == {"clutch_button": 1}


def test_a_mapping_that_says_nothing_is_not_written(bench: Bench):
    text = "scene: builtin/brick\n"
    assert mapping.place(bench, text, PATH, AS_IT_LIES) == text


def test_a_text_that_is_none_is_not_changed(bench: Bench):
    with pytest.raises(ConfigError, match=r"p\.yaml"):
        mapping.place(bench, "scene: [", PATH, AS_IT_LIES)


@pytest.mark.parametrize(
    ("device", "name", "workspace_m"),
    [("", "", None), ("device: {use: falcon-simulated}\n", "falcon-simulated", [0.08, 0.08, 0.08])],
    ids=["none", "one"],
)
def test_what_the_document_s_device_reaches(bench: Bench, device: str, name: str, workspace_m: list[float] | None):
    text = f"scene: builtin/brick\nmapping: {{scale: 3}}\n{device}"
    found = mapping.reach(bench, text, PATH, [])
    assert found == {"device": name, "workspace_m": pytest.approx(workspace_m) if workspace_m else None}
