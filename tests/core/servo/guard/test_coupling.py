"""The virtual coupling, a tool between device and force law: a wrong one throws the hand."""

import numpy as np
import pytest

from tangible_core.data import DeviceSpec, Force, HapticState, TickFlag
from tangible_core.plugins.interfaces import PlainTouch
from tangible_core.servo.guard.guard import couple, guard, wait
from tangible_core.servo.guard.safety import Coupling, Safety
from tangible_core.servo.ticks.loop import guard_touch

SPEC = DeviceSpec(8.0, 3000.0, 1.5, (0.08, 0.08, 0.08), 3e-5)
BARE = {"ramp_s": 0, "passivity": "off"}
"""Safety without any limit but those of a test."""


class TestCoupling:
    def test_coupling_absent_passes_the_device_state(self):
        settings, memory = Safety().arrays(SPEC, 500.0)
        state = (0.001, 0.002, -0.003, 0.1, -0.2, 0.3)
        assert couple(settings, memory, 0.001, *state) == state

    def test_tool_moves_by_backward_euler_along_every_axis(self):
        """m (v' - v) / T = F + k (p - x') + b (u - v'), x' = x + T v', T with the waits before, m = K T^2 / 2."""
        law, stiffness, damping, random = 500.0, 1000.0, 0.4, np.random.default_rng(2)
        coupling = Coupling(stiffness_n_per_m=stiffness, damping_n_s_per_m=damping)
        settings, memory = Safety(coupling=coupling, max_step_n=10, **BARE).arrays(SPEC, law)
        place, speed = random.uniform(-1e-3, 1e-3, 3), random.uniform(-0.1, 0.1, 3)
        assert couple(settings, memory, 0.001, *place, *speed) == (*place, *speed)
        tool, rate = place, speed
        for waits in (0, 2, 0, 1):
            push = random.uniform(0.1, 0.3, 3)
            left = guard(settings, memory, 0.001, *place, *speed, *push)[:3]
            np.testing.assert_allclose(left, stiffness * (tool - place) + damping * (rate - speed), atol=1e-12)
            place, speed = place + random.uniform(-1e-4, 1e-4, 3), random.uniform(-0.1, 0.1, 3)
            for _ in range(waits):
                wait(settings, memory, 0.001)
            period_s = 0.001 * (1 + waits)
            mass = law * period_s**2 / 2
            pull = push + stiffness * (place - tool) + damping * speed
            rate = (mass * rate + period_s * pull) / (mass + period_s * damping + period_s**2 * stiffness)
            tool = tool + period_s * rate
            np.testing.assert_allclose(couple(settings, memory, 0.001, *place, *speed), (*tool, *rate), rtol=1e-9)

    def test_python_law_gets_the_tool_state(self):
        asked: list[HapticState] = []

        class Asked(PlainTouch):
            def force(self, state: HapticState) -> Force:
                asked.append(state)
                return Force(0.0, 0.0, 1.0)

        (settings, memory), (_, twin) = (Safety(coupling="auto", **BARE).arrays(SPEC, 0.0) for _ in range(2))
        allowed = guard_touch(Asked(), settings, memory)
        for x in (0.0, 0.002):
            state = HapticState((x, 0.0, -0.001), (0.1, 0.0, 0.0), x, 3)
            tool = couple(settings, twin, 0.002, *state.position_m, *state.velocity_m_per_s)
            force, flags = allowed(state, 0.002)
            assert asked[-1] == (tool[:3], tool[3:], x, 3)
            assert (*force, flags) == guard(
                settings, twin, 0.002, *state.position_m, *state.velocity_m_per_s, 0.0, 0.0, 1.0
            )
        assert asked[-1].position_m[0] != 0.002
        assert allowed(state, 0.5) == ((0.0, 0.0, 0.0), TickFlag.STALE)

    @pytest.mark.parametrize("axis", [0, 1, 2])
    def test_tool_that_overflows_or_is_not_finite_returns_to_the_device(self, axis: int):
        settings, memory = Safety(coupling="auto", **BARE).arrays(SPEC, 500.0)
        far = 1e308 * np.eye(3)[axis]
        for place in (np.zeros(3), far, -far, np.zeros(3)):
            assert couple(settings, memory, 0.001, *place, 0.0, 0.0, 0.0) == (*place, 0.0, 0.0, 0.0)
            left = guard(settings, memory, 0.001, *place, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
            assert left == (0.0, 0.0, 0.0, 0)
        safety = Safety(coupling=Coupling(stiffness_n_per_m=1000, damping_n_s_per_m=1.5), **BARE)
        settings, memory = safety.arrays(SPEC, 1e5)
        for speed in (-1e308, 1e308):
            velocity = speed * np.eye(3)[axis]
            couple(settings, memory, 0.001, 0.0, 0.0, 0.0, *velocity)
            left = guard(settings, memory, 0.001, 0.0, 0.0, 0.0, *velocity, 0.0, 0.0, 0.0)
            assert left == (0.0, 0.0, 0.0, 0)

    @pytest.mark.parametrize("axis", [0, 1, 2])
    @pytest.mark.parametrize("speed", [1e308, -1e308])
    def test_tool_pulled_by_a_velocity_that_overflows_returns_to_the_device(self, axis: int, speed: float):
        safety = Safety(coupling=Coupling(stiffness_n_per_m=1000, damping_n_s_per_m=4), **BARE)
        settings, memory = safety.arrays(SPEC, 500.0)
        velocity = speed * np.eye(3)[axis]
        couple(settings, memory, 0.001, *[0.0] * 6)
        assert couple(settings, memory, 0.001, 0.0, 0.0, 0.0, *velocity) == (0.0, 0.0, 0.0, *velocity)
        left = guard(settings, memory, 0.001, 0.0, 0.0, 0.0, *velocity, 0.0, 0.0, 0.0)
        assert left == (0.0, 0.0, 0.0, 0)

    @pytest.mark.parametrize("axis", [0, 1, 2])
    @pytest.mark.parametrize(("way_m", "follows"), [(0.016, True), (0.021, False), (-1.0, False)])
    @pytest.mark.parametrize("begin_m", [(0.0, 0.0, 0.0), (0.03, -0.05, 0.04)])
    def test_tool_follows_a_device_that_jumps(
        self, axis: int, way_m: float, begin_m: tuple[float, float, float], follows: bool
    ):
        """Such as a released pointer: 8 N at 1000 N/m is a leash of 8 mm, and no hand moves 10 mm in a tick."""
        safety = Safety(coupling=Coupling(stiffness_n_per_m=1000, damping_n_s_per_m=0.4), **BARE)
        settings, memory = safety.arrays(SPEC, 500.0)
        couple(settings, memory, 0.001, *begin_m, 0.0, 0.0, 0.0)
        place = begin_m + way_m * np.eye(3)[axis]
        tool = couple(settings, memory, 0.001, *place, 0.0, 0.0, 0.0)
        assert (tool[axis] != place[axis]) == follows
        left = guard(settings, memory, 0.001, *place, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0)
        assert (left[axis] != 0.0) == follows

    def test_tool_stays_within_its_leash(self):
        safety = Safety(coupling=Coupling(stiffness_n_per_m=1000, damping_n_s_per_m=0.4), **BARE)
        settings, memory = safety.arrays(SPEC, 500.0)
        for _ in range(500):
            tool = couple(settings, memory, 0.001, *[0.0] * 6)
            guard(settings, memory, 0.001, *[0.0] * 6, 0.0, 0.0, 1e6)
        assert tool[2] == pytest.approx(8.0 / 1000)
