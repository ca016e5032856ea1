"""Checks of stiffness and damping. Otherwise a surface that buzzes on its device would be called safe."""

from typing import Any

import numpy as np
import pytest

from flights import fly, grades, level, material, surface_with_materials, value_in_cure
from tangible_core.preflight.checks.cures import FIT, soften
from tangible_core.preflight.checks.stiffness import law_damping, law_stiffness, material_stiffness, quantisation
from tangible_core.servo.guard.safety import Safety


class TestStiffness:
    """The device renders 4000 N/m by its damping, of which the guard leaves 3200; its specification has 10,000 N/m."""

    @pytest.mark.parametrize(
        ("stiffness", "verdict"), [(0.26, "warn"), (3200, "ok"), (3201, "warn"), (4000, "warn"), (4001, "unsafe")]
    )
    def test_stiffness_is_graded_by_the_damping(self, stiffness: float, verdict: str):
        found, *_ = law_stiffness(fly(level(), stiffness_n_per_m=stiffness))
        assert found.verdict == verdict
        assert found.bound == 3200 or stiffness == 0.26, "so soft that a hand goes through"

    @pytest.mark.parametrize(
        ("changes", "limit"),
        [
            ({"period_s": 0.002}, 2000),
            ({"safety": Safety(delay_ticks=1)}, 4000 / 3),
            ({"device": {"damping_n_s_per_m": 0.5}}, 1000),
            ({"max_stiffness_n_per_m": 1000.0}, 1000),
            ({"max_stiffness_n_per_m": 1000.0, "period_s": 0.004}, 250),
            ({"safety": Safety(friction_n=0.02), "resolution_m": 2e-5}, 2000),
        ],
    )
    def test_lowest_limit_comes_first(self, changes: dict[str, Any], limit: float):
        flight = fly(level(), **changes)
        assert flight.ceilings[0].limit_n_per_m == pytest.approx(limit)

    def test_lowest_ceiling_is_after_the_margin(self):
        """2 f / resolution is 2000 N/m, of which the guard leaves 1600."""
        coarse = {"safety": Safety(friction_n=0.02), "resolution_m": 2e-5}
        for stiffness, verdict in ((1600.0, "ok"), (1601.0, "warn"), (2001.0, "unsafe")):
            found, *_ = law_stiffness(fly(level(), stiffness_n_per_m=stiffness, **coarse))
            assert (found.verdict, found.bound) == (verdict, pytest.approx(1600))
            assert found.source.startswith("Abbott")
        coarse = {"safety": Safety(friction_n=0.033), "resolution_m": 2e-5, "max_stiffness_n_per_m": 3000.0}
        left = [ceiling.most_n_per_m for ceiling in fly(level(), **coarse).ceilings]
        assert left == pytest.approx([2400, 2640, 3000])
        limits = [
            ceiling.limit_n_per_m for ceiling in fly(level(), max_stiffness_n_per_m=3000.0, period_s=0.00025).ceilings
        ]
        assert sorted(limits) == pytest.approx([3000, 12_000])
        undamped = fly(level(), device={"damping_n_s_per_m": 0.0}, max_stiffness_n_per_m=1000.0)
        assert undamped.ceilings[0].limit_n_per_m == 1000

    @pytest.mark.parametrize(("asked", "given_n"), [(None, 8.0), (2.0, 2.0), (50.0, 8.0)])
    def test_max_force_is_the_lesser_of_device_and_option(self, asked: float | None, given_n: float):
        assert fly(level(), safety=Safety(max_force_n=asked)).max_force_n == given_n

    def test_stiffness_cure_passes_and_coupling_lowers_the_stiffness(self):
        flight = fly(level(), stiffness_n_per_m=20_000.0)
        verdicts = list(law_stiffness(flight))
        assert grades(verdicts) == ["unsafe", "unsafe"]
        for verdict in verdicts:
            softer = fly(level(), stiffness_n_per_m=value_in_cure(verdict, "render.stiffness_n_per_m"))
            assert next(each for each in law_stiffness(softer) if each.source == verdict.source).verdict == "ok"
        flight = fly(level(), stiffness_n_per_m=20_000.0, safety=Safety(coupling="auto"))
        assert grades(law_stiffness(flight)) == ["ok", "ok"]
        assert flight.felt_n_per_m(1600.0) == pytest.approx(800)

    def test_stiff_materials_are_named_and_textures_clean_below(self):
        surface = surface_with_materials(material("soft"), material("hard", stiffness_n_per_m=5000.0))
        [unfitted, *_] = law_stiffness(fly(surface))
        assert unfitted.cure == "`materials.fit: device`"
        flight = fly(surface, fitted=True)
        [law, *_] = law_stiffness(flight)
        assert "`hard: {stiffness_n_per_m: 3200}`" in law.cure
        assert "soft" not in law.cure
        verdicts = list(material_stiffness(flight))
        assert [(verdict.of, verdict.verdict) for verdict in verdicts] == [("soft", "ok"), ("hard", "unsafe")]
        assert value_in_cure(verdicts[1], "stiffness_n_per_m") == 3200
        rough = {"texture": "stochastic", "roughness_m": 1e-4}
        made_of = [material(f"{each:g}", **rough, stiffness_n_per_m=each) for each in (900.0, 950.0, 5000.0)]
        clean, buzzes, unsafe = material_stiffness(fly(surface_with_materials(*made_of)))
        assert grades((clean, buzzes, unsafe)) == ["ok", "warn", "unsafe"]
        assert value_in_cure(buzzes, "stiffness_n_per_m") == 900

    @pytest.mark.parametrize(("own", "verdict"), [(1.0, "ok"), (1.01, "warn")])
    def test_damping_is_graded_with_the_stiffness(self, own: float, verdict: str):
        """b > K T / 2 + B, with b 2 N s/m and K 2000 N/m."""
        flight = fly(level(), "penalty-gradient", stiffness_n_per_m=2000.0)
        object.__setattr__(flight.probes, "damping_n_s_per_m", np.full_like(flight.probes.damping_n_s_per_m, own))
        [found] = law_damping(flight)
        assert (found.verdict, found.bound) == (verdict, pytest.approx(1.0))

    def test_damping_bound_falls_with_delay_and_stiffness(self):
        """b > K T (1 + 2 d) / 2 + B, with b 2 N s/m, K 1000 N/m and d 1."""
        for stiffness, safety, bound in ((1000.0, Safety(delay_ticks=1), 0.5), (6000.0, Safety(), 0)):
            [found] = law_damping(fly(level(), "penalty-gradient", stiffness_n_per_m=stiffness, safety=safety))
            assert found.bound == pytest.approx(bound)
        soft, hard = {"stiffness_n_per_m": 500.0}, {"stiffness_n_per_m": 3000.0}
        pair = material("soft", damping_n_s_per_m=1.6, **soft), material("hard", damping_n_s_per_m=0.4, **hard)
        assert grades(law_damping(fly(surface_with_materials(*pair)))) == ["ok"]
        swapped = material("soft", damping_n_s_per_m=0.4, **soft), material("hard", damping_n_s_per_m=1.6, **hard)
        [found] = law_damping(fly(surface_with_materials(*swapped)))
        assert (found.verdict, found.value) == ("warn", pytest.approx(1.6, rel=0.01))
        assert found.bound == pytest.approx(0.5, rel=0.01)

    def test_encoder_step_that_is_felt_is_a_warning(self):
        [fine] = quantisation(fly(level(), stiffness_n_per_m=800.0, press_n=1.0, resolution_m=8.75e-5))
        [coarse] = quantisation(fly(level(), stiffness_n_per_m=800.0, press_n=1.0, resolution_m=9e-5))
        assert (fine.verdict, coarse.verdict) == ("ok", "warn")
        softer = value_in_cure(coarse, "render.stiffness_n_per_m")
        assert grades(quantisation(fly(level(), stiffness_n_per_m=softer, press_n=1.0, resolution_m=9e-5))) == ["ok"]


def test_materials_that_are_too_stiff_alone_are_softened():
    """In a loop of 500 Hz a library does it: 500 N/m is no more than 500 N/m."""
    made_of = material("cork", stiffness_n_per_m=500.0), material("oak", stiffness_n_per_m=900.0)
    flight = fly(surface_with_materials(*made_of), fitted=True, period_s=0.002)
    assert soften(flight, 500.0) == "in a file for `materials.library`, `oak: {stiffness_n_per_m: 500}`"
    assert soften(fly(surface_with_materials(*made_of)), 500.0) == [FIT]
    assert [each.key for each in soften(fly(surface_with_materials(*made_of), fitted=True), 500.0)] == [
        "safety.stiffness_margin"
    ]
