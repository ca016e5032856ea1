"""Probes of a force law. Otherwise a law would be called softer than it is, and buzz in the hand."""

import numpy as np
import pytest

from flights import fly, half_slope, level, material, shape
from tangible_core import HapticSurface


class TestSprings:
    def test_probe_level_ground_has_the_spring_s_values(self):
        probes = fly(level(), "proxy", stiffness_n_per_m=600.0, press_n=1.5).probes
        np.testing.assert_allclose(probes.depth_m, 1.5 / 600, rtol=1e-5)
        np.testing.assert_allclose(probes.force_n, [[0, 0, 1.5]] * 1024, rtol=1e-5, atol=1e-5)
        np.testing.assert_allclose(probes.stiffness_n_per_m, 600, rtol=1e-3)
        np.testing.assert_allclose(probes.damping_n_s_per_m, 0, atol=1e-3)
        assert probes.onset_n.max() < 1e-3

    def test_probe_slope_stiffens_a_penalty_along_the_gradient(self):
        probes = fly(shape(lambda x, y: 0.75 * x), "penalty-gradient", stiffness_n_per_m=400.0, press_n=2.0).probes
        inside = np.isfinite(probes.depth_m).reshape(64, 64)[1:-1, 1:-1]
        assert inside.all()
        np.testing.assert_allclose(probes.stiffness_n_per_m.reshape(64, 64)[:, 1:-1], 400 * (1 + 0.75**2), rtol=1e-3)
        np.testing.assert_allclose(probes.strength_n.reshape(64, 64)[:, 1:-1], 2 * 1.25, rtol=1e-3)

    def test_probe_slope_does_not_stiffen_a_proxy(self):
        probes = fly(shape(lambda x, y: 0.75 * x), "proxy", stiffness_n_per_m=400.0, press_n=2.0).probes
        middle = probes.stiffness_n_per_m.reshape(64, 64)[8:-8, 8:-8]
        np.testing.assert_allclose(middle, 400, rtol=1e-3)

    def test_probe_measures_damping(self):
        for law in ("proxy", "penalty-gradient"):
            probes = fly(level(), law, damping_n_s_per_m=0.7).probes
            np.testing.assert_allclose(probes.damping_n_s_per_m, 0.7, rtol=1e-3)

    def test_probe_presses_each_material_equally(self):
        labels = np.repeat(np.array([[0, 1]], np.int32), 16, axis=1).repeat(32, axis=0)
        pair = material("soft", stiffness_n_per_m=200.0), material("hard", stiffness_n_per_m=1000.0)
        probes = fly(level(labels=labels, materials=pair), "proxy", press_n=1.0).probes
        depth_m = probes.depth_m.reshape(32, 32)
        np.testing.assert_allclose(depth_m[:, :15], 1 / 200, rtol=1e-4)
        np.testing.assert_allclose(depth_m[:, 17:], 1 / 1000, rtol=1e-4)


class TestOtherLaws:
    def test_probe_measures_a_force_that_steps(self):
        probes = fly(level(), "grey-level", force_at_white_n=2.0).probes
        np.testing.assert_allclose(probes.onset_n, 2)
        np.testing.assert_allclose(probes.stiffness_n_per_m, 0, atol=1e-6)

    def test_probe_lateral_law_is_probed_at_its_spring_s_depth(self):
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
