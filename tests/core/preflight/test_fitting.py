"""All verdicts and their cures: else one would undo another, or an unsafe surface be called safe."""

import json
import math
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from flights import SPEC, level, material
from tangible_core import Pipeline, Scene, load_method
from tangible_core.materials.assignment import library
from tangible_core.pipeline.config.editing import edit_text
from tangible_core.preflight import Preflight, Verdict
from tangible_core.preflight.fitting import fit, fit_surface
from tangible_core.preflight.verdict import Change, check_bound
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


def test_fit_changes_damping_and_surface_once():
    """b is 2 N s/m: 2000 N/m leave 1, without delay."""
    damped = material(stiffness_n_per_m=1000.0, damping_n_s_per_m=5.0)
    assert fit(damped, SPEC, Safety()).damping_n_s_per_m == pytest.approx(1.5)
    assert fit(damped, SPEC, Safety(delay_ticks=1)).damping_n_s_per_m == pytest.approx(0.5)
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

    def test_touch_outcome_describes_the_changes_for_the_given_device(self):
        for pipeline, fitted in (
            (self.pipeline(device=Mock()), True),
            (self.pipeline(device=Mock(), materials={"fit": "never"}), False),
            (self.pipeline(), False),
        ):
            pipeline.make("touch")
            [touch] = [outcome for outcome in pipeline.outcomes if outcome.product == "touch"]
            assert ("brick and stone are felt more gently" in touch.why) == fitted
            assert pipeline.surface.materials[0] == library()["brick"]
        strong = load_method("device", "force-dimension")(model="sigma")
        pipeline = self.pipeline(device=strong)
        felt = pipeline.feel(Mock(), 0.3, in_real_time=False)
        [touch] = [outcome for outcome in pipeline.outcomes if outcome.product == "touch"]
        assert "brick and stone are felt more gently than they are" in touch.why
        configured = self.pipeline(device=Mock()).feel(seconds=0.3, in_real_time=False)
        assert np.array_equal(felt.force_n, configured.force_n)
        assert pipeline.preflight(Mock()).safe


RELIEF = "workspace.relief_m"


def low(value: str, worse: str = "warn") -> Verdict:
    """Return a verdict whose cure is a lower relief."""
    cure = [Change(RELIEF, value, "at most"), ", or press less"]
    return check_bound(
        "slope", "a wall", 2.0, "<=", 1.0, "share", "", cure=cure, says=f"it is over {value}", worse=worse
    )


def high(value: str) -> Verdict:
    return check_bound(
        "features", "3 mm wide", 1.0, ">=", 2.0, "m", "", cure=[Change(RELIEF, value, "at least")], says="too low"
    )


OK = check_bound("stiffness", "the law", 1.0, "<=", 2.0, "N/m", "", cure="softer", says="too stiff")


@pytest.mark.parametrize(
    ("verdicts", "sentence", "grade"),
    [
        ([OK], "Safe: nothing is wrong.", "ok"),
        ([OK, low("0.01")], "Safe, but it is over 0.01.", "warn"),
        ([low("0.01"), low("0.02")], "Safe, but it is over 0.01 and it is over 0.02.", "warn"),
        ([low("0.01"), low("0.02", "unsafe"), OK], "Unsafe, because it is over 0.02.", "unsafe"),
        ([low("0.01")] * 3 + [low("0.02")], "Safe, but it is over 0.01 and it is over 0.02.", "warn"),
        (
            [low(f"0.0{n}") for n in range(1, 6)],
            "Safe, but it is over 0.01, it is over 0.02, it is over 0.03 and 2 more things.",
            "warn",
        ),
    ],
)
def test_sentence_summarises_the_worst_verdicts(verdicts: list[Verdict], sentence: str, grade: str):
    found = Preflight.of(verdicts)
    assert (found.sentence, found.grade, found.safe) == (sentence, grade, grade != "unsafe")
    assert repr(found).splitlines()[0] == sentence
    assert len(repr(found).splitlines()) == 1 + sum(verdict.verdict != "ok" for verdict in verdicts)


def test_cures_of_one_key_get_the_strictest_value():
    found = Preflight.of([low("0.01"), low("0.0021"), low("0.014")])
    assert {each.cure for each in found} == {"`workspace.relief_m: 0.0021`, or press less"}
    assert {change.value for each in found for change in each.changes} == {"0.0021"}
    one, other = Preflight.of([high("0.02"), low("0.01", "unsafe")])
    assert one.changes == ()
    assert one.cure == "(not by `workspace.relief_m`, which another check wants at most 0.01)"
    assert other.cure.startswith("`workspace.relief_m: 0.01`")


def test_as_data_has_all_fields_and_applicable_changes():
    fit = check_bound(
        *("textures", "brick", math.inf, "<=", 1.0, "N/m", "here"),
        cure=[Change("materials.fit", "device", "is"), "; or ", Change(RELIEF, "0.0012", "at most")],
        says="brick buzzes",
        worse="unsafe",
    )
    said = json.loads(json.dumps(Preflight.of([fit, OK]).as_data(), allow_nan=False))
    assert (said["grade"], said["safe"], said["sentence"]) == ("unsafe", False, "Unsafe, because brick buzzes.")
    wrong, fine = said["verdicts"]
    assert (wrong["verdict"], wrong["check"], wrong["of"], wrong["says"]) == (
        "unsafe", "textures", "brick", "brick buzzes",
    )  # fmt: skip
    assert (wrong["value"], wrong["bound"], wrong["stands"]) == (None, 1.0, "inf N/m > 1 N/m")
    assert wrong["changes"] == [
        {"key": "materials.fit", "value": "device", "towards": "is"},
        {"key": RELIEF, "value": 0.0012, "towards": "at most"},
    ]
    assert (fine["changes"], fine["cure"], fine["stands"]) == ([], "", "1 N/m <= 2 N/m")
    text = "scene: builtin/brick\nmaterials: {by: rules}  # mine\nworkspace: {relief_m: 4 mm}\n"
    cured = edit_text(text, Path("p.yaml"), {each["key"]: each["value"] for each in wrong["changes"]})
    assert cured == text.replace("rules}", "rules, fit: device}").replace("4 mm", "1.2 mm")
