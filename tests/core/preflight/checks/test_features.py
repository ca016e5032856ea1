"""Checks of features and textures. Otherwise a surface that nobody can feel would be called good."""

from typing import Any

import numpy as np
import pytest

from flights import fly, grades, level, material, of, shape, surface_with_materials, value_in_cure
from tangible_core import HapticSurface
from tangible_core.data import Relief
from tangible_core.preflight.bumps import threshold_m
from tangible_core.preflight.checks.device import workspace
from tangible_core.preflight.checks.features import features, textures


class TestTextures:
    @pytest.mark.parametrize(
        ("grain_m", "verdict", "said"),
        [
            (1.2e-3, "ok", "10 samples"),
            (6e-4, "ok", "5 samples"),
            (5.9e-4, "warn", "4.92 samples a wave"),
            (2.4e-4, "warn", "2 samples a wave: none"),
        ],
    )
    def test_grain_is_graded_at_012_m_per_s_and_1_khz(self, grain_m: float, verdict: str, said: str):
        rough = material("rough", texture="stochastic", roughness_m=1e-4, grain_m=grain_m)
        found = of(textures(fly(surface_with_materials(rough))), "rough")
        assert (found.verdict, said in found.note) == (verdict, True)

    def test_fine_grain_has_two_cures(self):
        rough = material("rough", texture="stochastic", roughness_m=1e-4, grain_m=4e-4)
        found = of(textures(fly(surface_with_materials(rough))), "rough")
        better = material("rough", texture="stochastic", roughness_m=1e-4, grain_m=value_in_cure(found, "grain_m"))
        assert of(textures(fly(surface_with_materials(better))), "rough").verdict == "ok"
        assert "slower than 0.08 m/s" in found.cure
        assert of(textures(fly(surface_with_materials(rough), speed_m_per_s=0.08)), "rough").verdict == "ok"
        coarse = of(textures(fly(surface_with_materials(rough), resolution_m=3e-4)), "rough")
        assert (coarse.verdict, coarse.bound) == ("warn", pytest.approx(1.5e-3))
        [only] = textures(fly(level(), speed_m_per_s=0.1, period_s=0.002))
        assert (only.verdict, only.value) == ("ok", pytest.approx(4e-4))

    def test_only_present_materials_with_a_grain_are_checked(self):
        slipping = material("slipping", texture="stick-slip", static_friction=0.5, dynamic_friction=0.4, grain_m=1e-4)
        labels = np.where(np.arange(32) < 16, 0, 2).astype(np.int32)
        others = material("smooth"), material("elsewhere", texture="stochastic", roughness_m=1e-4), slipping
        surface = level(labels=np.tile(labels, (32, 1)), materials=others)
        assert [texture.of for texture in textures(fly(surface))] == ["shortest wave", "slipping"]


class TestFeatures:
    WAVE_M = 5.17 * 3.2e-3
    """Wavelength of which a band 3.2 mm wide passes 1.74 amplitudes."""

    def wave(self, felt: float, **changes: Any) -> Any:
        """Return a flight over a sine that is `felt` times the threshold for 3.2 mm."""
        amplitude_m = felt * threshold_m(3.2e-3) / 1.741
        cells, width_m = 321, 4.5 * self.WAVE_M
        relief = shape(lambda x, y: amplitude_m * np.sin(2 * np.pi * x / self.WAVE_M + np.pi / 2), cells, width_m)
        return fly(relief, relief_m=2 * amplitude_m, **changes)

    def test_widths_are_those_that_cells_and_surface_hold_along_both_axes(self):
        noise = np.random.default_rng(2).random((40, 400)).astype(np.float32)
        for extent_m, found in (
            ((0.1, 0.02), ["1 mm wide", "3.2 mm wide", "10 mm wide"]),
            ((0.1, 0.0199), ["1 mm wide", "3.2 mm wide"]),
            ((0.1, 0.0201), ["3.2 mm wide", "10 mm wide"]),
        ):
            for turned in (False, True):
                relief = Relief(noise.T.copy(), extent_m[::-1]) if turned else Relief(noise, extent_m)
                widths = [feature.of for feature in features(fly(HapticSurface(relief, None, None)))]
                assert widths == found

    def test_feature_below_the_threshold_has_a_cure(self):
        found = of(features(self.wave(0.9)), "3.2 mm wide")
        assert (found.verdict, found.value) == ("warn", pytest.approx(0.9 * 29e-6, rel=0.05))
        needed = value_in_cure(found, "workspace.relief_m") / (2 * 0.9 * threshold_m(3.2e-3) / 1.741)
        assert needed == pytest.approx(1 / 0.9, rel=0.08)
        assert of(features(self.wave(1.1)), "3.2 mm wide").verdict == "ok"
        coarse = of(features(self.wave(1.1, resolution_m=4e-5)), "3.2 mm wide")
        assert (coarse.verdict, coarse.bound, coarse.source) == ("warn", 4e-5, "the device's resolution")

    @pytest.mark.parametrize(
        "surface", [level(), shape(lambda x, y: 0.1 * x), HapticSurface.from_heights(np.ones((1, 1)))]
    )
    def test_relief_without_a_feature_is_a_warning(self, surface: HapticSurface):
        [found] = features(fly(surface))
        assert (found.of, found.verdict) == ("the relief", "warn")


class TestWorkspace:
    @pytest.mark.parametrize(
        ("reach_m", "verdicts"),
        [
            ((0.1, 0.2, 0.03), ["ok", "ok", "ok"]),
            ((0.09, 0.2, 0.03), ["warn", "ok", "ok"]),
            ((0.1, 0.19, 0.03), ["ok", "warn", "ok"]),
            ((0.1, 0.2, 0.029), ["ok", "ok", "warn"]),
            ((0.2, 0.1, 0.03), ["ok", "warn", "ok"]),
        ],
    )
    def test_each_side_is_checked_against_its_reach(self, reach_m: tuple[float, float, float], verdicts: list[str]):
        """100 mm wide, 200 mm long, and 30 mm over the base plane, though the relief itself is level."""
        surface = HapticSurface.from_heights(np.full((20, 10), 0.03, np.float32), 0.1)
        found = list(workspace(fly(surface, workspace_m=reach_m)))
        assert grades(found) == verdicts
        assert [each.bound for each in found] == list(reach_m)
