"""The input of the checks: the hand's and the loop's bounds, the way on which a law is timed, and strokes' targets."""

import numpy as np
import pytest

from flights import fly, level, of, shape
from tangible_core import HapticSurface
from tangible_core.errors import ConfigError
from tangible_core.preflight import Hand, Loop, survey
from tangible_core.preflight.checks.jitter import lateness, tick_cost
from tangible_core.preflight.strokes import LINES, _ways
from tangible_core.preflight.survey import _stroke
from tangible_core.preflight.timing import TICKS, Lateness, TickCost
from tangible_devices import Mock
from tangible_render import Proxy


@pytest.mark.parametrize(
    ("cls", "field", "option", "bounds", "unit"),
    [
        (Hand, "speed_m_per_s", "speed", (0.001, 10.0), "metres a second"),
        (Hand, "press_n", "press", (0.01, 1000.0), "newtons"),
        (Loop, "rate_hz", "rate", (1.0, 100_000.0), "ticks a second"),
        (Loop, "seconds", "seconds", (0.001, 600.0), "seconds"),
    ],
)
def test_hand_and_loop_take_what_is_within_their_bounds(cls, field: str, option: str, bounds: tuple, unit: str):
    for value in bounds:
        assert getattr(cls(**{field: value}), field) == value
    for value in (bounds[0] * 0.999, bounds[1] * 1.001, float("nan"), -bounds[0]):
        with pytest.raises(ConfigError) as raised:
            cls(**{field: value})
        assert str(raised.value) == f"--{option}: is {value:g}; it must be {bounds[0]:g} to {bounds[1]:g} {unit}"


def test_hand_of_the_library_s_textures_and_a_loop_of_a_kilohertz_are_the_defaults():
    assert (Hand().speed_m_per_s, Hand().press_n) == (0.12, 3.0)
    assert (Loop().period_s, Loop().seconds, Loop(rate_hz=500).period_s) == (0.001, 2.0, 0.002)


def test_law_is_timed_to_and_fro_over_the_whole_surface_at_the_speed_of_the_hand():
    """A triangle wave about the middle, by small steps that turn at the borders; slower along y by e."""
    surface = shape(lambda x, y: 0.3 * x + 0.01, 64)
    wide = HapticSurface.from_heights(surface.height_m[:40].copy(), 0.08)
    flight = fly(wide, press_n=2.0)
    path = _stroke(wide, flight.probes, 0.0011)
    assert path.shape == (TICKS, 3)
    for axis, length_m in ((0, 0.08), (1, 0.05)):
        step_m, at_m, way, expected = 0.0011 / (np.e if axis else 1.0), 0.0, None, []
        for _ in range(TICKS):
            expected.append(at_m)
            way = way or np.sign(path[1, axis])
            at_m += way * step_m
            if abs(at_m) > length_m / 2:
                at_m, way = np.sign(at_m) * length_m - at_m, -way
        assert path[:, axis] == pytest.approx(0.999 * np.array(expected), abs=1e-9)
    column = np.clip(np.rint((path[:, 0] / 0.08 + 0.5) * 64 - 0.5), 0, 63).astype(int)
    assert path[:, 2] == pytest.approx(wide.height_m[7, column] - np.median(flight.probes.depth_m), abs=2e-4)


def test_strokes_cover_the_surface_in_lines_to_and_fro():
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


def test_notes_of_timing_have_their_percentiles_in_microseconds():
    late = Lateness(np.arange(1001) * 1e-7, 0.001, real_time=True)
    found = of(lateness(fly(level(), lateness=late)), "lateness, p99.9")
    assert found.note.startswith("p50 50, p99 99, p99.9 100, max 100 us; ") and found.note.endswith(" permitted")
    assert "not permitted" not in found.note
    call_s = np.linspace(1e-6, 3e-6, 101)
    (compiled,) = tick_cost(fly(level(), cost=TickCost(call_s, 0.25e-6)))
    (python,) = tick_cost(fly(level(), cost=TickCost(1000 * call_s, 1e-3, compiled=False)))
    assert (compiled.note, compiled.bound) == ("p50 2.0 us called from Python, 0.25 us compiled", 0.0005)
    assert compiled.value == pytest.approx(2.98e-6)
    assert (python.note, python.verdict) == ("p50 2000.0 us in Python", "unsafe")
    assert python.cure.startswith("a force law of compiled kernels instead of Python, or stop other work")


def test_survey_has_the_facts_that_it_is_given():
    law, surface = Proxy(), level()
    of_parts = survey(surface, law.touch(surface), law, Mock(), of_parts=True, loop=Loop(seconds=0.001), slope=2.0)
    assert (of_parts.relief_key, of_parts.slope, of_parts.smoothed, of_parts.fitted) == ("", 2.0, True, False)
    brought = survey(
        surface, law.touch(surface), law, Mock(), scene_relief_m=0.007, smoothed=False, fitted=True, law_name="mine",
        hand=Hand(press_n=1.0), loop=Loop(rate_hz=500, seconds=0.01),
    )  # fmt: skip
    assert (brought.relief_key, brought.relief_m) == ("scene.relief_m", 0.007)
    assert (brought.smoothed, brought.fitted, brought.law_name, brought.period_s) == (False, True, "mine", 0.002)
    assert brought.probes.strength_n == pytest.approx(1.0, rel=1e-4)
    assert len(brought.lateness.late_s) == 5
    assert (of_parts.relief_m, of_parts.stiffness_n_per_m) == (of_parts.size.relief_m, law.stiffness_n_per_m)
