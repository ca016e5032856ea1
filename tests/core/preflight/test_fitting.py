"""Materials limited to a device: the changes, the materials that stay, and the force that results."""

import math
from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from flights import SPEC, level, material
from tangible_core import HapticSurface, Pipeline, Scene, load_method
from tangible_core.data import TickFlag
from tangible_core.materials.assignment import library
from tangible_core.pipeline.feeling import Feeling
from tangible_core.preflight.fitting import fit, fit_surface
from tangible_core.servo import Safety
from tangible_core.session import run_simulated
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
    ("safety", "most"),
    [
        (Safety(), 3200.0),
        (Safety(stiffness_margin=0.5), 2000.0),
        (Safety(delay_ticks=1), 3200.0 / 3),
        (Safety(friction_n=0.01), 0.8 * 2 * 0.01 / 1e-5),
    ],
)
def test_fit_stiffness_and_texture_sum_to_the_limit(safety: Safety, most: float):
    hard, rough = material(stiffness_n_per_m=9000.0), material(**ROUGH, stiffness_n_per_m=500.0)
    assert fit(hard, SPEC, safety).stiffness_n_per_m == pytest.approx(most)
    fitted = fit(rough, SPEC, safety)
    assert fitted.stiffness_n_per_m + fitted.roughness_m * (2 * math.pi / 1e-3) ** 2 == pytest.approx(most)
    assert fit(replace(rough, stiffness_n_per_m=9000.0), SPEC, safety).roughness_m == 0


def test_fit_stated_stiffness_of_the_device_is_a_limit():
    assert (
        fit(material(stiffness_n_per_m=9000.0), replace(SPEC, max_stiffness_n_per_m=1000.0), Safety()).stiffness_n_per_m
        == 800
    )


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


@pytest.mark.parametrize("name", ["glass", "ice"])
@pytest.mark.parametrize("device", ["mock", "falcon-simulated"])
def test_guard_softens_no_fitted_material(name: str, device: str):
    surface = level(labels=np.zeros((32, 32), np.int32), materials=(library()[name],))
    felt = run_simulated(Proxy().touch(surface), load_method("device", device)(), 1.0)
    assert np.count_nonzero(felt.flags & TickFlag.TOUCHING) > 100
    assert not np.any(felt.flags & TickFlag.STIFFNESS_LIMITED)


class TestPipeline:
    def pipeline(self, **changes: Any) -> Pipeline:
        labels = np.repeat(np.int32([[0, 1]]), 16, axis=1).repeat(32, axis=0)
        scene = Scene.photo(np.linspace(0, 1, 1024).reshape(32, 32), segments=labels)
        materials = {"by": {0: "brick", 1: "stone"}, **changes.pop("materials", {})}
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
        pipeline = self.pipeline(device=Mock())
        pipeline.make("touch")
        [touch] = [each for each in pipeline.outcomes if each.product == "touch"]
        assert touch.why == (
            "requested; brick and stone are felt more gently than they are: the device cannot go finer"
        )
        assert pipeline.surface.materials[0] == library()["brick"]

    def test_given_device_replaces_the_configured_one(self):
        strong = load_method("device", "force-dimension")(model="sigma")
        pipeline = self.pipeline(device=strong)
        felt = pipeline.feel(Mock(), 0.3, in_real_time=False)
        [touch] = [each for each in pipeline.outcomes if each.product == "touch"]
        assert "brick and stone are felt more gently than they are" in touch.why
        configured = self.pipeline(device=Mock()).feel(seconds=0.3, in_real_time=False)
        assert np.array_equal(felt.force_n, configured.force_n)
        assert pipeline.preflight(Mock()).safe

    def test_replay_uses_the_materials_of_the_session(self):
        """The guard is as weak as possible: after the ramp, the force of the law is the recorded one."""
        free = {"ramp_s": 0, "max_step_n": 10, "passivity": "off"}
        pipeline = self.pipeline(safety=free)
        felt = pipeline.feel(Mock(), 0.3, in_real_time=False)
        assert np.abs(Feeling(pipeline, Mock()).replay(felt).force_n - felt.force_n).max() < 1e-6
        assert np.abs(Feeling(pipeline).replay(felt).force_n - felt.force_n).max() > 0.01

    def test_fit_off_or_without_device_changes_nothing(self):
        for pipeline in (self.pipeline(device=Mock(), materials={"fit": "never"}), self.pipeline()):
            pipeline.make("touch")
            assert not any("softened" in each.why for each in pipeline.outcomes)

    def test_fit_surface_without_materials_is_unchanged(self):
        surface = HapticSurface.from_heights(np.zeros((2, 2)))
        assert fit_surface(surface, SPEC, Safety())[0] is surface
