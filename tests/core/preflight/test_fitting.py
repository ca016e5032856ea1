"""Materials limited to a device. Otherwise a hard material would buzz, or change without a word."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from flights import SPEC, level, material
from tangible_core import Pipeline, Scene, load_method
from tangible_core.materials.assignment import library
from tangible_core.preflight.fitting import fit, fit_surface
from tangible_core.servo import Safety
from tangible_devices.mock import Mock
from tangible_render.proxy import Proxy

SHIPPED = ("mock", "falcon", "falcon-simulated", "haply")
ROUGH = {"texture": "stochastic", "roughness_m": 2e-4, "grain_m": 1e-3}


def test_fit_stable_material_is_unchanged():
    """SPEC leaves 3200 N/m to a law: a wave of 50 um and 1 mm adds 1974 N/m under 1 N."""
    for each in (
        material(stiffness_n_per_m=3200.0),
        material(**{**ROUGH, "roughness_m": 5e-5}, stiffness_n_per_m=1200.0),
    ):
        assert fit(each, SPEC, Safety()) is each


@pytest.mark.parametrize(
    ("safety", "device", "most"),
    [
        (Safety(), {}, 3200.0),
        (Safety(stiffness_margin=0.5), {}, 2000.0),
        (Safety(delay_ticks=1), {}, 3200.0 / 3),
        (Safety(friction_n=0.01), {}, 0.8 * 2 * 0.01 / 1e-5),
        (Safety(), {"max_stiffness_n_per_m": 1000.0}, 800.0),
    ],
)
def test_fit_stiffness_and_texture_sum_to_the_limit(safety: Safety, device: dict[str, float], most: float):
    spec = replace(SPEC, **device)
    hard, rough = material(stiffness_n_per_m=9000.0), material(**ROUGH, stiffness_n_per_m=500.0)
    assert fit(hard, spec, safety).stiffness_n_per_m == pytest.approx(most)
    fitted = fit(rough, spec, safety)
    assert fitted.stiffness_n_per_m + fitted.roughness_m * (2 * math.pi / 1e-3) ** 2 == pytest.approx(most)
    assert fit(replace(rough, stiffness_n_per_m=9000.0), spec, safety).roughness_m == 0


def test_fit_damping_is_what_stiffness_leaves():
    """b is 2 N s/m: 2000 N/m leave 1, without delay."""
    damped = material(stiffness_n_per_m=1000.0, damping_n_s_per_m=5.0)
    assert fit(damped, SPEC, Safety()).damping_n_s_per_m == pytest.approx(1.5)
    assert fit(damped, SPEC, Safety(delay_ticks=1)).damping_n_s_per_m == pytest.approx(0.5)


def test_fit_surface_describes_each_change_once():
    hard = material("hard", stiffness_n_per_m=9000.0)
    labels = np.tile(np.array([0, 1], np.int32), (32, 16))
    named = replace(level(labels=labels, materials=(hard, hard)), names=("wall", "cup"))
    surface, said = fit_surface(named, SPEC, Safety())
    assert surface.names == ("wall", "cup")
    assert said == "hard is felt softer than it is: the device cannot hold anything harder"
    assert [each.stiffness_n_per_m for each in surface.materials] == [3200, 3200]
    plain = level()
    assert fit_surface(plain, SPEC, Safety()) == (plain, "")


@pytest.mark.parametrize("device", SHIPPED)
def test_fit_shipped_materials_keep_the_limits_of_shipped_devices(device: str):
    spec = load_method("device", device)().spec()
    for each in library().values():
        fitted = fit(each, spec, Safety())
        assert fitted.stiffness_n_per_m == each.stiffness_n_per_m, each.name
        if device != "haply":  # which is a third weaker than a Falcon
            assert fitted.damping_n_s_per_m == each.damping_n_s_per_m, each.name


class TestPipeline:
    def pipeline(self, **changes: Any) -> Pipeline:
        labels = np.repeat(np.int32([[0, 1]]), 16, axis=1).repeat(32, axis=0)
        scene = Scene.photo(np.linspace(0, 1, 1024).reshape(32, 32), segments=labels)
        materials = {"by": {1: "brick", 2: "stone"}, **changes.pop("materials", {})}
        render = Proxy()
        return Pipeline(
            scene,
            depth=load_method("depth", "luminance")(),
            materials=materials,
            render=render,
            cached=False,
            **changes,
        )

    def test_touch_outcome_describes_the_changes(self):
        for pipeline, fitted in (
            (self.pipeline(device=Mock()), True),
            (self.pipeline(device=Mock(), materials={"fit": "never"}), False),
            (self.pipeline(), False),
        ):
            pipeline.make("touch")
            [touch] = [outcome for outcome in pipeline.outcomes if outcome.product == "touch"]
            assert ("brick and stone are felt more gently" in touch.why) == fitted
            assert pipeline.surface.materials[0] == library()["brick"]

    def test_given_device_replaces_the_configured_one(self):
        strong = load_method("device", "force-dimension")(model="sigma")
        pipeline = self.pipeline(device=strong)
        felt = pipeline.feel(Mock(), 0.3, in_real_time=False)
        [touch] = [outcome for outcome in pipeline.outcomes if outcome.product == "touch"]
        assert "brick and stone are felt more gently than they are" in touch.why
        configured = self.pipeline(device=Mock()).feel(seconds=0.3, in_real_time=False)
        assert np.array_equal(felt.force_n, configured.force_n)
        assert pipeline.preflight(Mock()).safe
