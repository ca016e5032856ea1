"""The options of a force loop, its stiffness limits, and the arrays of its guard: wrong ones let a device shake."""

from pathlib import Path

import pytest

from tangible_core.data import DeviceSpec, TickFlag
from tangible_core.errors import ConfigError
from tangible_core.pipeline.config.parsing import parse_config
from tangible_core.plugins.registry import default_registry
from tangible_core.servo.guard import guard, layout
from tangible_core.servo.guard.safety import (
    Coupling,
    Safety,
    effective_damping_n_s_per_m,
    encoder_limit_n_per_m,
    gain,
    stiffness_limit_n_per_m,
)

FALCON = DeviceSpec(8.0, 3000.0, 20.0, (0.08, 0.08, 0.08), 3e-5)


def parse(text: str):
    return parse_config(f"scene: builtin/brick\n{text}", Path("p.yaml"), default_registry())


class TestPipelineFile:
    def test_file_has_documented_limits_unless_it_says_others(self):
        stated = Safety(
            max_force_n=None, max_step_n=0.5, ramp_s=0.5, stale_s=0.02, watchdog_s=0.2, stiffness_margin=0.8,
            delay_ticks=0, friction_n=None, passivity="coupled", coupling=None,
        )  # fmt: skip
        assert parse("").safety == Safety() == stated
        text = "safety: {max_force_n: 2, coupling: {stiffness_n_per_m: 900, damping_n_s_per_m: 0.2}, passivity: off}\n"
        safety = parse(text).safety
        coupling = Coupling(stiffness_n_per_m=900, damping_n_s_per_m=0.2)
        assert safety == Safety(max_force_n=2, coupling=coupling, passivity="off")

    @pytest.mark.parametrize(
        "wrong",
        [
            "max_force_n: 0", "max_force_n: -1", "max_force_n: .inf", "max_step: 1", "max_step_n: 0", "max_step_n: 11",
            "max_step_n: .nan", "ramp_s: .nan", "ramp_s: -1", "ramp_s: 61", "stale_s: 0.001", "stale_s: 1.1",
            "watchdog_s: 0.11", "watchdog_s: 0.51", "watchdog_s: .nan",
            "stiffness_margin: 0", "stiffness_margin: 1.01", "delay_ticks: -1", "delay_ticks: 9", "friction_n: 0",
            "passivity: on", "coupling: on", "coupling: {stiffness_n_per_m: 900, damping_n_s_per_m: -0.1}",
            "coupling: {stiffness_n_per_m: 0, damping_n_s_per_m: 0}", "coupling: {stiffness_n_per_m: 900}",
        ],
    )  # fmt: skip
    def test_file_options_out_of_bounds_are_refused(self, wrong: str):
        with pytest.raises(ConfigError, match="2:"):
            parse(f"safety: {{{wrong}}}\n")


class TestLimits:
    @pytest.mark.parametrize(("delay", "limit"), [(0, 4000), (1, 4000 / 3), (2, 800)])
    def test_stiffness_limit_follows_the_formula(self, delay: int, limit: float):
        assert stiffness_limit_n_per_m(2.0, 0.001, delay) == pytest.approx(limit, rel=1e-15)

    def test_encoder_limit_follows_the_formula(self):
        assert encoder_limit_n_per_m(0.05, 5e-5) == pytest.approx(2000)

    @pytest.mark.parametrize(("damping", "effective"), [(20.0, 1.5), (1.0, 1.0), (0.0, 1.5)])
    def test_damping_above_the_stiffness_limit_is_reduced(self, damping: float, effective: float):
        assert effective_damping_n_s_per_m(DeviceSpec(8.0, 3000.0, damping, (0.08, 0.08, 0.08), 3e-5)) == effective


class TestArrays:
    @pytest.mark.parametrize(
        ("safety", "stiffness", "share"),
        [
            (Safety(), 2400.0, 1.0),
            (Safety(), 4800.0, 0.5),
            (Safety(delay_ticks=1), 1600.0, 0.5),
            (Safety(stiffness_margin=1), 3000.0, 1.0),
            (Safety(friction_n=0.03), 2000.0, 0.8),
            (Safety(), 0.0, 1.0),
        ],
    )
    def test_gain_is_the_stable_share_of_the_stiffness(self, safety: Safety, stiffness: float, share: float):
        settings, memory = safety.arrays(FALCON, stiffness)
        assert gain(settings, 0.001) == pytest.approx(share, rel=1e-12)
        assert memory[layout.GAIN] == gain(settings, 0.001)

    def test_gain_and_coupling_respect_the_device(self):
        """At 4 kHz the device's damping allows 9600 N/m, but its stated limit is 3000."""
        settings, memory = Safety(ramp_s=0, passivity="off").arrays(FALCON, 5000.0)
        assert gain(settings, 0.00025) == pytest.approx(3000 / 5000)
        for _ in range(4000):
            left = guard.guard(settings, memory, 0.00025, *[0.0] * 6, 0.0, 0.0, 0.1)
        assert 0.1 * 2400 / 5000 < left[2] <= 0.1 * 3000 / 5000
        for delay in range(9):
            settings, _ = Safety(coupling="auto", delay_ticks=delay).arrays(FALCON, 800.0)
            stiffness, damping = settings[[layout.COUPLING, layout.COUPLING_DAMPING]]
            assert (stiffness * 0.001 / 2 + damping) * (1 + 2 * delay) < 1.5
            assert gain(settings, 0.001) == 1.0

    @pytest.mark.parametrize("law", [800.0, 0.0])
    @pytest.mark.parametrize("delay", [0, 1])
    def test_automatic_coupling_is_half_the_stable_stiffness(self, law: float, delay: int):
        """And a quarter of the damping. The law is in series with it; a law of unknown stiffness may have any."""
        held, times = 2400 / (1 + 2 * delay), 1 + 2 * delay
        settings, _ = Safety(coupling="auto", delay_ticks=delay).arrays(FALCON, law)
        assert settings[layout.COUPLING] == pytest.approx(held / 2)
        assert settings[layout.COUPLING_DAMPING] == pytest.approx(1.5 / 4 / times)
        assert settings[layout.COUPLING_LAW] == pytest.approx(law or held)
        assert settings[layout.STIFFNESS] == pytest.approx(1 / (2 / held + 1 / law) if law else held / 2)

    def test_automatic_coupling_respects_the_encoder_limit(self):
        coarse, _ = Safety(coupling="auto", friction_n=0.015).arrays(FALCON, 800.0)
        assert coarse[layout.COUPLING] == pytest.approx(0.8 * 2 * 0.015 / 3e-5 / 2)

    @pytest.mark.parametrize(("law", "behind", "felt"), [(800.0, 800.0, 1 / (1 / 900 + 1 / 800)), (0.0, 2400.0, 900.0)])
    def test_custom_coupling_is_used_as_given(self, law: float, behind: float, felt: float):
        """A law of unknown stiffness may be as stiff as the device allows; the tool is heavy enough for that."""
        coupling = Coupling(stiffness_n_per_m=900, damping_n_s_per_m=0.2)
        settings, _ = Safety(coupling=coupling).arrays(FALCON, law)
        names = [layout.COUPLING, layout.COUPLING_DAMPING, layout.COUPLING_LAW]
        assert settings[names].tolist() == pytest.approx([900, 0.2, behind])
        assert settings[layout.STIFFNESS] == pytest.approx(felt)

    @pytest.mark.parametrize(
        ("passivity", "brake", "credit"), [("off", 0, 0), ("coupled", 7.5, 1.2), ("strict", 7.5, 0)]
    )
    def test_brake_and_credit_follow_the_passivity_option(self, passivity: str, brake: float, credit: float):
        settings, _ = Safety(passivity=passivity).arrays(FALCON, 800.0)
        assert settings[[layout.BRAKE, layout.CREDIT]] == pytest.approx([brake, credit])


def test_kernel_flags_match_the_record_flags():
    for name in ("TOUCHING", "FORCE_LIMITED", "SLEW_LIMITED", "STIFFNESS_LIMITED", "RAMPING", "NOT_FINITE", "DAMPED"):
        assert getattr(guard, name) == TickFlag[name]
    assert guard.STALE == TickFlag.STALE == 1 << (layout.FLAGS - 1)
