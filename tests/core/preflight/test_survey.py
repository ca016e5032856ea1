"""The input of the checks before a session. Otherwise a surface would be judged for another hand, device or loop."""

import numpy as np
import pytest

from flights import level
from tangible_core import HapticSurface
from tangible_core.errors import ConfigError
from tangible_core.preflight import Hand, Loop, Settings, survey
from tangible_core.preflight.strokes import LINES, _ways
from tangible_devices import Mock
from tangible_render import Proxy


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


def test_survey_has_the_facts_that_it_is_given():
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
