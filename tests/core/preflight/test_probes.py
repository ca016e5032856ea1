"""What probes, bumps and strokes measure. Otherwise a law or a surface would be called softer than it is."""

import math

import numpy as np
import pytest

from flights import fly, half_slope, level, material, of, shape
from tangible_core import HapticSurface, load_method
from tangible_core.data import Relief
from tangible_core.preflight.bumps import feature_m, reduce_relief, threshold_m
from tangible_core.preflight.checks.slopes import cliffs
from tangible_core.preflight.probes import DAMPING_N_S_PER_M, LINES, MAX_TICKS, SIDEWAYS, stroke


class TestSprings:
    def test_probe_measures_stiffness_and_damping_of_springs(self):
        probes = fly(level(), "proxy", stiffness_n_per_m=600.0, press_n=1.5).probes
        np.testing.assert_allclose(probes.depth_m, 1.5 / 600, rtol=1e-5)
        np.testing.assert_allclose(probes.force_n, [[0, 0, 1.5]] * 1024, rtol=1e-5, atol=1e-5)
        np.testing.assert_allclose(probes.stiffness_n_per_m, 600, rtol=1e-3)
        np.testing.assert_allclose(probes.damping_n_s_per_m, 0, atol=1e-3)
        assert probes.onset_n.max() < 1e-3
        probes = fly(shape(lambda x, y: 0.75 * x), "penalty-gradient", stiffness_n_per_m=400.0, press_n=2.0).probes
        inside = np.isfinite(probes.depth_m).reshape(64, 64)[1:-1, 1:-1]
        assert inside.all()
        np.testing.assert_allclose(probes.stiffness_n_per_m.reshape(64, 64)[:, 1:-1], 400 * (1 + 0.75**2), rtol=1e-3)
        np.testing.assert_allclose(probes.strength_n.reshape(64, 64)[:, 1:-1], 2 * 1.25, rtol=1e-3)
        probes = fly(shape(lambda x, y: 0.75 * x), "proxy", stiffness_n_per_m=400.0, press_n=2.0).probes
        middle = probes.stiffness_n_per_m.reshape(64, 64)[8:-8, 8:-8]
        np.testing.assert_allclose(middle, 400, rtol=1e-3)
        for law in ("proxy", "penalty-gradient"):
            probes = fly(level(), law, damping_n_s_per_m=0.7).probes
            np.testing.assert_allclose(probes.damping_n_s_per_m, 0.7, rtol=1e-3)
        labels = np.repeat(np.array([[0, 1]], np.int32), 16, axis=1).repeat(32, axis=0)
        pair = material("soft", stiffness_n_per_m=200.0), material("hard", stiffness_n_per_m=1000.0)
        probes = fly(level(labels=labels, materials=pair), "proxy", press_n=1.0).probes
        depth_m = probes.depth_m.reshape(32, 32)
        np.testing.assert_allclose(depth_m[:, :15], 1 / 200, rtol=1e-4)
        np.testing.assert_allclose(depth_m[:, 17:], 1 / 1000, rtol=1e-4)


class TestOtherLaws:
    def test_laws_without_a_spring_are_probed_at_its_depth(self):
        probes = fly(level(), "grey-level", force_at_white_n=2.0).probes
        np.testing.assert_allclose(probes.onset_n, 2)
        np.testing.assert_allclose(probes.stiffness_n_per_m, 0, atol=1e-6)
        probes = fly(half_slope(0.5), "lateral-shape", dequantise="never", press_n=2.0).probes
        np.testing.assert_allclose(probes.depth_m, 2 / 800, rtol=1e-6)
        np.testing.assert_allclose(probes.strength_n.reshape(64, 64)[:, 40:-4], 2 * 0.5, rtol=1e-3)


@pytest.mark.parametrize("law", ["proxy", "penalty", "penalty-gradient", "force-shading", "lateral-gradient",
                                 "lateral-shape", "grey-level", "tangible-mask"])  # fmt: skip
@pytest.mark.parametrize(
    "heights", [np.zeros((1, 1)), np.zeros((1, 5)), np.array([[0.0, 0.01]]), np.full((7, 3), 0.02)]
)
def test_probe_any_law_accepts_tiny_surfaces(law: str, heights: np.ndarray):
    probes = fly(HapticSurface.from_heights(heights.astype(np.float32)), law).probes
    for values in vars(probes).values():
        assert len(values) == heights.size
        assert np.isfinite(values).all()


def sine_response(wavelength_m: float, width_m: float) -> float:
    u = (2 * math.pi * width_m / wavelength_m) ** 2
    return (math.exp(-u / 8) - math.exp(-2 * u)) / (1 / math.sqrt(1.25) - 1 / math.sqrt(5))


@pytest.mark.parametrize("cells", [64, 256, 1024])
@pytest.mark.parametrize("width_m", [0.0032, 0.005])
def test_feature_m_ridge_has_its_height_at_any_resolution(cells: int, width_m: float):
    ridge = shape(lambda x, y: 1e-3 * np.exp(-(x**2) / (2 * width_m**2)), cells)
    assert feature_m(ridge.relief, width_m) == pytest.approx(1e-3, rel=0.03)


@pytest.mark.parametrize("wavelength_m", [0.01, 0.016, 0.04])
def test_feature_m_sine_matches_the_formula(wavelength_m: float):
    wave = shape(lambda x, y: 5e-4 * np.sin(2 * np.pi * x / wavelength_m), 512)
    expected = 5e-4 * sine_response(wavelength_m, 0.0032)
    assert feature_m(wave.relief, 0.0032) == pytest.approx(
        expected, rel=0.1
    )  # the sine ends half a cell off the border


@pytest.mark.parametrize("width_m", [0.001, 0.0032, 0.01, 0.032])
def test_feature_m_plane_has_no_feature(width_m: float):
    plane = shape(lambda x, y: 0.4 * x - 0.2 * y, 100)
    assert feature_m(plane.relief, width_m) < 1e-7


@pytest.mark.parametrize("along", [False, True], ids=["x", "y"])
@pytest.mark.parametrize("cells", [(18, 100), (100, 24), (1024, 200)])
def test_feature_m_is_that_of_metres_where_cells_are_no_squares(cells: tuple[int, int], along: bool):
    """A ridge and a plane, 80 by 60 mm; beyond the borders a plane goes on along both axes."""
    y, x = (np.indices(cells) + 0.5) * np.array([0.06 / cells[0], 0.08 / cells[1]]).reshape(2, 1, 1)
    ridge = 1e-3 * np.exp(-(((y - 0.03) if along else (x - 0.04)) ** 2) / (2 * 0.008**2))
    assert feature_m(Relief(np.float32(ridge), (0.08, 0.06)), 0.008) == pytest.approx(1e-3, rel=0.06)
    assert feature_m(Relief(np.float32(0.4 * x - 0.2 * y + 0.02), (0.08, 0.06)), 0.008) < 1e-7


def test_reduced_relief_and_threshold_are_those_of_the_measurements():
    fine = Relief(np.zeros((400, 900), np.float32), (0.09, 0.03))
    assert reduce_relief(fine, 0.001).height_m.shape == (30, 90)
    assert reduce_relief(fine, 0.0009).height_m.shape == (34, 100)
    assert reduce_relief(fine, 0.0001).height_m.shape == (300, 900)
    assert reduce_relief(fine, 1.0).height_m.shape == (1, 1)
    assert reduce_relief(fine, 1e-6).height_m.shape == (400, 900)
    assert threshold_m(3.2e-3) == pytest.approx(29e-6)
    assert threshold_m(10e-3) == pytest.approx(130e-6)
    power = math.log(threshold_m(0.02) / threshold_m(0.01)) / math.log(2)
    assert power == pytest.approx(1.3, abs=0.05)


PERIOD_S, SPEED = 0.001, 0.12


def strokes_of(surface, law="proxy", press_n=1.5, speed=SPEED, **options):
    return stroke(load_method("render", law)(**options).touch(surface), surface, press_n, speed, PERIOD_S)


def test_level_ground_answers_the_press_and_a_fall_is_no_rise():
    found = strokes_of(level())
    assert found.force_n[found.force_n.size // 2 :] == pytest.approx(1.5, abs=0.05)
    assert not found.held_up.any()
    assert np.abs(found.rise_n).max() < 0.01
    teeth = shape(lambda x, y: 0.6 * (x % 0.003), 512)
    flight = fly(teeth, stiffness_n_per_m=400.0)
    assert np.mean(flight.strokes.rise_n < -flight.max_step_n) > 0.01
    assert of(cliffs(flight), "too sudden").verdict == "ok"


def test_each_line_is_stroked_at_the_speed_of_the_hand():
    found = strokes_of(level())
    assert (
        found.force_n.size
        == found.rise_n.size
        == found.held_up.size
        == 2 * LINES * round(0.92 * 0.08 / SPEED * 1000 + 0.5)
    )
    assert strokes_of(level(), speed=0.001).force_n.size == 2 * LINES * MAX_TICKS


def test_hand_climbs_a_slope_within_the_force_that_it_can_give():
    """Without friction, slope 1 is climbed with a push of its press and its damping: sqrt(2) of them in all."""
    found = strokes_of(shape(lambda x, y: np.abs(x)), speed=0.04).force_n.reshape(2 * LINES, -1)
    uphill_n = np.median(found[0, 800:900])
    assert uphill_n == pytest.approx((1.5 + DAMPING_N_S_PER_M * 0.04) * 2**0.5, rel=0.08)
    found = strokes_of(shape(lambda x, y: np.where(np.abs(x % 0.02 - 0.01) < 0.005, 0.005, 0.0)), press_n=3)
    assert found.held_up.any()
    assert found.force_n.max() < 3 * np.hypot(1, SIDEWAYS) * 1.15


def test_walls_hold_up_from_each_side_and_the_hand_goes_on():
    for turn in range(4):
        heights = np.rot90(np.pad(np.full((64, 32), 0.01), ((0, 0), (32, 0))), turn)
        surface = shape(lambda x, y, heights=heights: np.kron(heights, np.ones((2, 2))))
        assert strokes_of(surface).held_up.mean() == pytest.approx(strokes_of(half_cliff()).held_up.mean(), rel=0.15)
        assert strokes_of(surface).held_up.any()
    cliff = shape(lambda x, y: np.where(x > -0.02, 0.005, 0.0))
    found = strokes_of(cliff).held_up.reshape(2 * LINES, -1)
    towards = found[:LINES:2]
    assert towards.any(axis=1).all() and not found[1:LINES:2].any()
    assert not towards[:, -50:].any()


def half_cliff():
    return shape(lambda x, y: np.where(x > 0, 0.01, 0.0))
