"""The command `tangible preflight`, as a user calls it."""

import json
import math
import re
from dataclasses import fields
from pathlib import Path

import numpy as np
import pytest

from command_line import tangible
from tangible_authoring.commands.preflight import COLOURS, WIDTHS, preflight
from tangible_core import load_pipeline
from tangible_core.cli.show import verdict_line
from tangible_core.data import HapticState
from tangible_core.errors import BrokenMethod, ConfigError
from tangible_core.pipeline.feeling import Feeling
from tangible_core.preflight import Hand, Loop, Verdict
from tangible_devices.mock import Mock

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


def test_preflight_safe_file_exits_with_0(folder: Path):
    short = tangible("preflight", "p.yaml", "--seconds", 0.1, cwd=folder).stdout.splitlines()
    assert not [line for line in short if line.startswith("ok")]
    assert re.search(r"\d\d ok \(--verbose lists them\)", short[-1])
    done = tangible("preflight", "p.yaml", "--seconds", 0.1, "--verbose", cwd=folder)
    assert done.returncode == 0, done.stdout + done.stderr
    sentence, _, *verdicts, _, summary = done.stdout.splitlines()
    assert re.fullmatch(r".*hills\.npy on mock: Safe(: nothing is wrong|, but .*)\.", sentence)
    assert {each.split()[0] for each in verdicts} <= GRADES | {"cure:"}
    assert " 700 N/m <= 2400 N/m; 80 % of 3000 N/m; Colgate & Schenkel 1997" in done.stdout
    assert summary.endswith(" 0 unsafe")


def test_preflight_unsafe_file_exits_with_1_and_json_has_all(folder: Path):
    words = ("preflight", "p.yaml", "--set", "render.stiffness_n_per_m=9000", "--seconds", 0.1, "--rate", 500, "--json")
    done = tangible(*words, cwd=folder)
    assert done.returncode == 1, done.stderr
    found = json.loads(done.stdout)
    assert found["scene"].endswith("hills.npy")
    assert found["device"] == "mock"
    assert found["period_s"] == 0.002
    assert found["jitter"]["ticks"] == 50
    assert found["hand"] == {"speed_m_per_s": 0.12, "press_n": 3.0}
    assert 0 < found["tick"]["p50_s"] <= found["tick"]["max_s"]
    assert set(found["jitter"]) == {"p50_s", "p99_s", "p99.9_s", "max_s", "ticks", "overruns", "real_time"}
    keys = {
        "check",
        "of",
        "verdict",
        "value",
        "unit",
        "relation",
        "bound",
        "source",
        "note",
        "cure",
        "says",
        "changes",
        "at",
    }
    assert all(set(each) == keys and each["verdict"] in GRADES for each in found["verdicts"])
    checks = {"device", "stiffness", "damping", "slope", "clipping", "contact", "texture", "features", "workspace"}
    assert {each["check"] for each in found["verdicts"]} == checks | {"quantisation", "jitter", "tick"}
    assert (found["grade"], found["sentence"][:16]) == ("unsafe", "Unsafe, because ")
    unsafe = [each for each in found["verdicts"] if each["verdict"] == "unsafe"]
    assert {(each["check"], each["of"]) for each in unsafe} >= {("stiffness", "the law")}
    assert all("render.stiffness_n_per_m: " in each["cure"] for each in unsafe if each["check"] == "stiffness")


@pytest.mark.parametrize("sets", ["render.use=grey-level", "render.use=tangible-mask", "scene.height=dot.npy"])
def test_preflight_any_law_accepts_one_pixel(folder: Path, sets: str):
    preflight(folder / "p.yaml", [sets], seconds=0.01, as_json=True, no_cache=True)


@pytest.mark.parametrize(
    ("line", "said"),
    [
        ("device: {use: mock}", "p.yaml: `device:` is missing; name a method"),
        ("render: {use: proxy, stiffness_n_per_m: 700}", "p.yaml: `render:` is missing; name a method"),
    ],
)
def test_preflight_missing_configuration_is_refused(folder: Path, line: str, said: str):
    (folder / "p.yaml").write_text(SAFE.replace(line, ""))
    with pytest.raises(ConfigError, match=re.escape(said)):
        preflight(folder / "p.yaml", seconds=0.01, no_cache=True)


def test_preflight_wrong_option_prints_one_line(folder: Path):
    done = tangible("preflight", "p.yaml", "--rate", 0, cwd=folder)
    assert (done.returncode, done.stderr) == (2, "--rate: is 0; it must be 1 to 100000 ticks a second\n")


@pytest.mark.parametrize("value", [0.0, -1.0, math.nan, math.inf])
def test_options_out_of_range_are_refused(value: float):
    for made in (Hand, Loop):
        for field in fields(made):
            with pytest.raises(ConfigError, match="--"):
                made(**{field.name: value})


def test_preflight_device_is_never_opened(folder: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(Mock, "open", lambda self: pytest.fail("opened"))
    preflight(folder / "p.yaml", seconds=0.01, as_json=True, no_cache=True)


def test_preflight_cure_is_below_its_verdict_with_plain_brackets():
    verdict = Verdict("slope", "a[b]", "warn", 0.125, "share", "<=", 0.01, "why [1]", "note", "do `x: [1]`")
    shown = verdict_line(verdict, COLOURS, WIDTHS)
    assert shown.splitlines() == [
        "[yellow]warn  [/] slope        a\\[b]: 12.5 % > 1 %; note; why [1]",
        f"{'':20}cure: do `x: [1]`",
    ]


def test_survey_law_without_stated_stiffness_is_measured():
    """The stiffness is measured."""
    from tangible_core import HapticSurface
    from tangible_core.data import Force
    from tangible_core.plugins.interfaces import PlainTouch
    from tangible_core.preflight import survey
    from tangible_render import Proxy

    class Spring(PlainTouch):
        def force(self, state: HapticState) -> Force:
            return Force(0.0, 0.0, 350.0 * max(0.0, 0.01 - state.position_m[2]))

    surface = HapticSurface.from_heights(np.full((4, 4), 0.01, np.float32))
    flight = survey(surface, Spring(), Proxy(), Mock(), loop=Loop(seconds=0.01))
    assert flight.stiffness_n_per_m == pytest.approx(350)
    assert (flight.relief_key, flight.relief_m) == ("workspace.relief_m", 0.02)


def test_survey_law_with_nan_force_is_refused():
    """Bounds of NaN would give cures that are not values: `render.stiffness_n_per_m: nan`."""
    from tangible_core import HapticSurface
    from tangible_core.data import Force
    from tangible_core.plugins.interfaces import PlainTouch
    from tangible_core.preflight import survey
    from tangible_render import Proxy

    class Broken(PlainTouch):
        stiffness_n_per_m = 600.0

        def force(self, state: HapticState) -> Force:
            return Force(0.0, 0.0, math.nan if state.position_m[0] > 0.02 else 1.0)

    surface = HapticSurface.from_heights(np.full((4, 4), 0.01, np.float32))
    with pytest.raises(BrokenMethod, match=r"^render method proxy \(.*not finite at 4 of 16 places of the surface"):
        survey(surface, Broken(), Proxy(), Mock(), loop=Loop(seconds=0.01))


def test_relief_key_is_where_the_height_is_set(folder: Path):
    flight = Feeling(load_pipeline(folder / "p.yaml")).flight(loop=Loop(seconds=0.01))
    assert (flight.relief_key, flight.relief_m, flight.smoothed) == ("workspace.relief_m", 0.004, False)
    own = Feeling(load_pipeline(folder / "p.yaml", ["scene.relief_m=0.003"])).flight(loop=Loop(seconds=0.01))
    assert (own.relief_key, own.relief_m) == ("scene.relief_m", 0.003)
