"""The input of the checks: surface, samples and lateness. Otherwise something else would be judged than is felt."""

import os
from pathlib import Path

import numpy as np
import pytest

from flights import level
from tangible_core import HapticSurface, Pipeline, Scene, load_method, load_pipeline
from tangible_core.errors import ConfigError
from tangible_core.preflight import Hand, Loop, Preflight, Settings, survey, timing
from tangible_core.preflight.probes import LINES, _ways
from tangible_core.scene.scene_files import BUILTINS
from tangible_depth import Luminance, SemiGlobal
from tangible_devices import Mock
from tangible_render import Proxy
from tangible_texture import Gradient


@pytest.mark.parametrize(
    ("cls", "field", "low", "high"),
    [
        (Hand, "speed_m_per_s", 0.001, 10.0),
        (Hand, "press_n", 0.01, 1000.0),
        (Loop, "rate_hz", 1.0, 100_000.0),
        (Loop, "seconds", 0.001, 600.0),
    ],
)
def test_hand_and_loop_take_what_is_within_their_bounds(cls, field: str, low: float, high: float):
    for value in (low, high):
        assert getattr(cls(**{field: value}), field) == value
    for value in (low * 0.999, high * 1.001, float("nan"), -low):
        with pytest.raises(ConfigError):
            cls(**{field: value})
    assert (Hand().speed_m_per_s, Hand().press_n) == (0.12, 3.0)
    assert (Loop().period_s, Loop().seconds, Loop(rate_hz=500).period_s) == (0.001, 2.0, 0.002)


def test_survey_has_its_facts_and_strokes_that_cover_the_surface():
    """Six lines along each side, in the middles of sixths; 96 % of it, or a thousand ticks about the middle."""
    surface = HapticSurface.from_heights(np.zeros((30, 60), np.float32), 0.12)
    ways = _ways(surface, 0.00025)
    assert len(ways) == 2 * LINES
    for axis, (length_m, across_m) in enumerate([(0.12, 0.06), (0.06, 0.12)]):
        for line, way in enumerate(ways[LINES * axis : LINES * (axis + 1)]):
            assert np.all(way[:, 1 - axis] == pytest.approx(((line + 0.5) / 6 - 0.5) * across_m))
            steps = np.diff(way[:, axis])
            assert steps == pytest.approx((-1) ** line * 0.00025, rel=0.01)
            assert np.ptp(way[:, axis]) == pytest.approx(0.92 * length_m, rel=0.01)
            assert way[:, axis].mean() == pytest.approx(0, abs=1e-12)
    slow = _ways(surface, 0.00001)
    assert {len(each) for each in slow} == {1000}
    assert np.ptp(slow[0][:, 0]) == pytest.approx(999 * 0.00001)
    assert {len(each) for each in _ways(surface, 1.0)} == {2}
    law, surface = Proxy(), level()
    of_parts = survey(
        surface, law.touch(surface), law, Mock(), Settings(of_parts=True, slope=2.0), loop=Loop(seconds=0.001)
    )
    assert of_parts.settings.relief_key == ""
    brought = survey(
        surface, law.touch(surface), law, Mock(), Settings(scene_relief_m=0.007),
        hand=Hand(press_n=1.0), loop=Loop(rate_hz=500, seconds=0.01),
    )  # fmt: skip
    assert (brought.settings.relief_key, brought.settings.relief_m) == ("scene.relief_m", 0.007)
    assert brought.period_s == 0.002
    assert brought.probes.strength_n == pytest.approx(1.0, rel=1e-4)
    assert len(brought.lateness.late_s) == 5
    assert of_parts.settings.relief_m == of_parts.settings.size.relief_m
    assert of_parts.stiffness_n_per_m == law.stiffness_n_per_m


ROOT = Path(__file__).parents[3]
FOLDERS = "configs", "tangible_core"
DEVICES = "mock", "falcon-simulated"


def sample_files() -> list[Path]:
    """Return the samples with a force law and a device; examples name devices that are installed with them."""
    files = [path for folder in FOLDERS for path in sorted((ROOT / folder).rglob("*.yaml"))]
    texts = {path: path.read_text(encoding="utf-8").splitlines() for path in files}
    keys = {path: {line.partition(":")[0] for line in lines} for path, lines in texts.items()}
    templates = {path for path, lines in texts.items() if any(line.startswith("scene: $scene") for line in lines)}
    return [path for path, named in keys.items() if {"scene", "render", "device"} <= named and path not in templates]


def complaints(verdicts: Preflight) -> list[str]:
    """Return all complaints except those on the machine that runs the tests."""
    return [
        repr(verdict) for verdict in verdicts if verdict.verdict != "ok" and verdict.check not in ("jitter", "tick")
    ]


@pytest.mark.parametrize("path", sample_files(), ids=lambda path: str(path.relative_to(ROOT)))
def test_sample_passes_preflight(path: Path):
    verdicts = load_pipeline(path).preflight(loop=Loop(seconds=0.05))
    assert len(verdicts) > 10
    assert complaints(verdicts) == []
    assert verdicts.sentence.startswith("Safe")


@pytest.mark.whole
@pytest.mark.parametrize("name", BUILTINS)
def test_builtin_scene_with_defaults_passes_preflight(name: str):
    scene = Scene.builtin(name)
    depth = SemiGlobal() if scene.views.right is not None else Luminance()
    pipeline = Pipeline(scene, depth=depth, texture=Gradient(segments=6), render=Proxy())
    for device in DEVICES:
        verdicts = pipeline.preflight(load_method("device", device)(), loop=Loop(seconds=0.01))
        assert complaints(verdicts) == []
        assert verdicts.safe


class Clock:
    """A clock that advances only in sleeps, always by a little too much, and once by far too much."""

    def __init__(self, over_s: float, stall_at: int, stall_s: float) -> None:
        self.now, self.sleeps = 100.0, 0
        self.over_s, self.stall_at, self.stall_s = over_s, stall_at, stall_s

    def perf_counter(self) -> float:
        return self.now

    def sleep(self, seconds: float) -> None:
        self.now += seconds + (self.stall_s if self.sleeps == self.stall_at else self.over_s)
        self.sleeps += 1


def test_lateness_counts_once_and_the_scheduling_is_restored(monkeypatch: pytest.MonkeyPatch):
    clock = Clock(over_s=1e-5, stall_at=4, stall_s=3.5e-3)
    monkeypatch.setattr(timing, "time", clock)
    late = timing.measure_lateness(0.02, 0.001)
    assert late.late_s.size == clock.sleeps == 20
    expected = np.full(20, 1e-5)
    expected[4] = 3.5e-3
    np.testing.assert_allclose(late.late_s, expected, atol=1e-9)
    assert late.overruns == 1 / 20
    assert late.at(100) == pytest.approx(3.5e-3)
    assert clock.now == pytest.approx(100 + 0.023 + 1e-5)
    before = os.sched_getscheduler(0)
    late = timing.measure_lateness(0.05, 0.001)
    assert late.late_s.size == 50
    assert (late.late_s >= 0).all()
    assert os.sched_getscheduler(0) == before
    monkeypatch.setattr(os, "sched_setscheduler", refuse)
    assert not timing.measure_lateness(0.002, 0.001).real_time


def refuse(*_: object) -> None:
    raise PermissionError


def test_measure_ticks_times_every_tick():
    touch = load_method("render", "proxy")().touch(level())
    for ticks in (1, 50):
        cost = timing.measure_ticks(touch, np.tile([0.0, 0.0, 0.009], (ticks, 1)), 0.001)
        assert cost.call_s.size == ticks
        assert (cost.call_s > 0).all()
        assert cost.kernel_s > 0
        assert cost.at(50) <= cost.at(99) <= cost.at(100)
