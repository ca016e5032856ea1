"""`tangible preflight`: if a case fails, an unsafe file is called safe, or a survey opens the device."""

import json
import re
from pathlib import Path

import numpy as np
import pytest

from command_line import tangible
from tangible_authoring.commands.preflight import preflight
from tangible_core.data import Force, HapticState, HapticSurface
from tangible_core.errors import BrokenMethod
from tangible_core.plugins.interfaces import PlainTouch
from tangible_core.preflight import Loop, survey
from tangible_devices.mock import Mock
from tangible_render import Proxy

SAFE = """\
scene: {height: hills.npy}
want: surface
workspace: {width_m: 0.07, relief_m: 0.004}
render: {use: proxy, stiffness_n_per_m: 700}
device: {use: mock}
"""
GRADES = {"ok", "warn", "unsafe"}


@pytest.fixture
def folder(tmp_path: Path) -> Path:
    """Write scenes of gentle hills and of one pixel."""
    x, y = np.meshgrid(np.linspace(0, 2 * np.pi, 96), np.linspace(0, 2 * np.pi, 64))
    np.save(tmp_path / "hills.npy", 2 + np.sin(x) * np.sin(y))
    np.save(tmp_path / "dot.npy", np.ones((1, 1)))
    (tmp_path / "p.yaml").write_text(SAFE)
    return tmp_path


def test_safe_file_exits_with_0_and_no_device_is_opened(folder: Path, monkeypatch: pytest.MonkeyPatch):
    short = tangible("preflight", "p.yaml", "--seconds", 0.1, cwd=folder).stdout.splitlines()
    assert not [line for line in short if line.startswith("ok")]
    assert re.search(r"\d\d ok \(--verbose lists them\)", short[-1])
    done = tangible("preflight", "p.yaml", "--seconds", 0.1, "--verbose", cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    sentence, _, *verdicts, _, summary = done.stdout.splitlines()
    assert re.fullmatch(r".*hills\.npy on mock: Safe(: nothing is wrong|, but .*)\.", sentence)
    assert {verdict.split()[0] for verdict in verdicts} <= GRADES | {"cure:"}
    assert " 700 N/m <= 2400 N/m; 80 % of 3000 N/m; Colgate & Schenkel 1997" in done.stdout
    assert summary.endswith(" 0 unsafe")
    monkeypatch.setattr(Mock, "open", lambda self: pytest.fail("opened"))
    preflight(folder / "p.yaml", seconds=0.01, as_json=True, no_cache=True)


def test_preflight_unsafe_file_exits_with_1_and_json_has_all(folder: Path):
    words = ("preflight", "p.yaml", "--set", "render.stiffness_n_per_m=9000", "--seconds", 0.1, "--rate", 500, "--json")
    done = tangible(*words, cwd=folder)
    assert done.returncode == 1, done.stderr
    found = json.loads(done.stdout)
    assert found["scene"].endswith("hills.npy")
    assert found["device"] == "mock"
    assert found["period_s"] == 0.002
    assert (found["jitter"]["ticks"], found["hand"]) == (50, {"speed_m_per_s": 0.12, "press_n": 3.0})
    assert 0 < found["tick"]["p50_s"] <= found["tick"]["max_s"]
    assert all(each["verdict"] in GRADES for each in found["verdicts"])
    checks = {"device", "stiffness", "damping", "slope", "clipping", "contact", "texture", "features", "workspace"}
    assert {each["check"] for each in found["verdicts"]} == checks | {"quantisation", "jitter", "tick"}
    assert (found["grade"], found["sentence"][:16]) == ("unsafe", "Unsafe, because ")
    unsafe = [each for each in found["verdicts"] if each["verdict"] == "unsafe"]
    assert {(each["check"], each["of"]) for each in unsafe} >= {("stiffness", "the law")}
    assert all("render.stiffness_n_per_m: " in each["cure"] for each in unsafe if each["check"] == "stiffness")


def test_survey_measures_a_law_without_stiffness_and_refuses_nan():
    """Bounds of NaN would give cures that are not values: `render.stiffness_n_per_m: nan`."""

    class Broken(PlainTouch):
        stiffness_n_per_m = 600.0

        def force(self, state: HapticState) -> Force:
            return Force(0.0, 0.0, np.nan if state.position_m[0] > 0.02 else 1.0)

    surface = HapticSurface.from_heights(np.full((4, 4), 0.01, np.float32))
    with pytest.raises(BrokenMethod, match="not finite at 4 of 16 places"):
        survey(surface, Broken(), Proxy(), Mock(), loop=Loop(seconds=0.01))

    class Spring(PlainTouch):
        def force(self, state: HapticState) -> Force:
            return Force(0.0, 0.0, 350.0 * max(0.0, 0.01 - state.position_m[2]))

    flight = survey(surface, Spring(), Proxy(), Mock(), loop=Loop(seconds=0.01))
    assert flight.stiffness_n_per_m == pytest.approx(350)
