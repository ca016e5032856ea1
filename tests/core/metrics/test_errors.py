"""If one of these fails, errors of disparity or of forces are reported that their formulas do not give."""

import math

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_core.errors import PictureError
from tangible_core.metrics import absolute_error, disparity_errors, force_errors
from tangible_core.metrics.truth_errors import angles_deg

NAN = np.nan


def test_measures_equal_those_computed_by_hand():
    truth = np.float32([[1, 2, 3, NAN], [4, 5, 6, 7]])
    found = np.float32([[1, 2.75, NAN, 9], [5.5, 2, 11, np.inf]])
    assert disparity_errors(found, truth) == pytest.approx(
        {
            "bad0.5": 100 * 6 / 7,
            "bad1": 100 * 5 / 7,
            "bad2": 100 * 4 / 7,
            "bad4": 100 * 3 / 7,
            "average_px": (0 + 0.75 + 1.5 + 3 + 5) / 5,
            "rms_px": ((0.75**2 + 1.5**2 + 9 + 25) / 5) ** 0.5,
            "density": 100 * 5 / 7,
        }
    )
    unknown = np.full((2, 2), NAN, np.float32)
    assert all(np.isnan(value) for value in disparity_errors(unknown, unknown).values())
    found = disparity_errors(unknown, np.ones((2, 2), np.float32))
    assert (found["bad4"], found["density"]) == (100, 0)
    assert np.isnan(found["average_px"])


@pytest.mark.usefixtures("unchecked_shapes")
def test_maps_of_different_size_are_refused():
    with pytest.raises(PictureError, match=r"\(2, 2\) and its truth \(2, 3\)"):
        absolute_error(np.ones((2, 2)), np.ones((2, 3)))


UP = np.array((0.0, 0.0, 1.0))
RANDOM = np.random.default_rng(2)


def rows(*vectors: tuple[float, ...]) -> np.ndarray:
    return np.array(vectors, np.float64)


def test_vertical_spring_on_a_slope_has_the_errors_of_its_angle():
    """k d z against k d cos(t) n: off by k d sin(t), which is tan(t) of the truth; 1 / cos(t) as large, and t aside."""
    slope, depths = 0.3, np.linspace(0.001, 0.002, 50)[:, None]
    angle = math.atan(slope)
    normal = np.array((-math.sin(angle), 0.0, math.cos(angle)))
    errors = force_errors(800 * depths * UP, 800 * depths * math.cos(angle) * normal)
    assert errors["error_percent"] == pytest.approx(100 * slope)
    assert errors["error_n"] == pytest.approx(800 * math.sin(angle) * np.sqrt(np.mean(depths**2)))
    assert errors["direction_deg"] == pytest.approx(math.degrees(angle))
    assert errors["jnd"] == pytest.approx(math.degrees(angle) / 18)
    assert errors["noticed_percent"] == 0


@pytest.mark.parametrize(("factor", "jnd"), [(1.0, 0.0), (1.035, 0.5), (0.86, 2.0), (0.0, 1 / 0.07)])
def test_force_of_another_magnitude_has_that_error(factor: float, jnd: float):
    truth = RANDOM.normal(0, 1, (30, 3))
    errors = force_errors(factor * truth, truth)
    assert errors["jnd"] == pytest.approx(jnd, abs=1e-9)
    assert errors["error_percent"] == pytest.approx(100 * abs(factor - 1))
    assert errors["noticed_percent"] == 100 * (jnd > 1 + 1e-9)


def test_errors_count_the_ticks_with_a_force_only():
    """A force in free air counts for newtons, not for what is told apart; a tick of unknown truth for nothing."""
    truth = rows((0, 0, 1), (0, 0, 1), (0, 0, 0), (np.nan,) * 3, (0, 0, 0))
    force = rows((0, 0, 1), (0, 1, 0), (0, 0, 2), (9, 9, 9), (0, 0, 0))
    errors = force_errors(force, truth)
    assert errors["error_n"] == pytest.approx(math.sqrt((0 + 2 + 4) / 3))
    assert errors["error_percent"] == pytest.approx(100 * math.sqrt(6 / 2))
    assert errors["direction_deg"] == pytest.approx(45)
    assert errors["jnd"] == pytest.approx(2.5)
    assert errors["noticed_percent"] == 50


@pytest.mark.parametrize("count", [0, 3])
def test_paths_without_force_give_nan(count: int):
    nothing = np.zeros((count, 3))
    for truth in (nothing, np.full((count, 3), np.nan)):
        assert all(math.isnan(value) for value in force_errors(nothing, truth).values())


@given(st.floats(0, math.pi), st.floats(1e-9, 1e9))
def test_angles_are_exact_for_small_and_large_ones(angle: float, size: float):
    turned = size * rows((math.cos(angle), math.sin(angle), 0))
    assert angles_deg(rows((1, 0, 0)), turned)[0] == pytest.approx(math.degrees(angle), abs=1e-12)
