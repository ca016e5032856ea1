"""The stiffness of laws that do not state it: unmeasured, a guard cannot limit it, and a stiff law shakes the hand."""

import math
import threading
import time
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest

from simulated_handle import wall
from tangible_core import HapticSurface, load_method
from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import NO_FORCE, TICK_COLUMNS, DeviceSpec, Force, HapticState, TickFlag
from tangible_core.errors import BrokenMethod
from tangible_core.plugins.interfaces import PlainTouch
from tangible_core.servo import Safety, Servo
from tangible_core.servo.guard import stiffness
from tangible_core.servo.guard.stiffness import DEPTHS_M, STEP_M, find_stiffness
from tangible_core.session import run_simulated
from tangible_core.testing.synthetic.scenes import ramp
from tangible_devices.mock import Mock
from waiting import until

SPEC = DeviceSpec(8.0, 3000.0, 20.0, (0.08, 0.08, 0.08), 1e-6)
AT_ONCE = Safety(ramp_s=0, max_step_n=10, passivity="off")
FLAGS, FZ = TICK_COLUMNS.index("flags"), TICK_COLUMNS.index("fz_n")
LEVEL_M = 0.002


class Law(PlainTouch):
    """A force by position, and the number of calls."""

    def __init__(self, law: Callable[[float, float, float], tuple[float, float, float]]) -> None:
        self.law, self.asked = law, 0

    def force(self, state: HapticState) -> Force:
        self.asked += 1
        return Force(*self.law(*state.position_m))


def level(push_n: Callable[[float], float], height_m: float = LEVEL_M) -> Law:
    """Return a law that pushes up by a function of the depth under level ground."""
    return Law(lambda x, y, z: (0.0, 0.0, push_n(height_m - z) if z < height_m else 0.0))


def spring(k: float, height_m: float = LEVEL_M) -> Law:
    return level(lambda depth: k * depth, height_m)


class Plain(PlainTouch):
    """A spring that the loop can unpickle."""

    def __init__(self, k: float) -> None:
        self.k = k

    def force(self, state: HapticState) -> Force:
        return Force(0.0, 0.0, self.k * max(0.0, LEVEL_M - state.position_m[2]))


class TestLimitOfUnstatedStiffness:
    """5,000 N/m, where the mock's own table says 3,000, and damping of 1.5 N s/m leaves 0.8 of 3,000."""

    def test_session_limits_a_law_of_unstated_stiffness(self) -> None:
        recording = run_simulated(spring(5000.0), Mock(hand=None, path="circle", z_m=0.0015), 0.2, limits=AT_ONCE)
        assert recording.force_n[:, 2].max() == pytest.approx(2400 * 0.0005, rel=1e-6)
        assert (recording.rows[:, FLAGS].astype(int) & TickFlag.STIFFNESS_LIMITED).all()

    @pytest.mark.usefixtures("loop_in_thread")
    def test_loop_limits_a_swapped_law_of_unstated_stiffness(self) -> None:
        with Servo(Plain(5000.0), Mock(hand=None, path="circle", z_m=0.0015), AT_ONCE) as servo:
            assert servo.how.endswith("; Plain does not state its stiffness; 5000 N/m was measured")
            until(lambda: servo.report().ticks > 100)
            hard = servo.ring.since(0)[0]
            servo.swap(Plain(50.0))
            until(lambda: last_force(servo) == pytest.approx((50 * 0.0005, False), rel=1e-6))
        felt_n, flags = hard[:, FZ], hard[:, FLAGS].astype(int)
        assert 0 < felt_n.max() <= 2401 * 0.0005
        assert (flags[felt_n > 0] & TickFlag.STIFFNESS_LIMITED).all()


def last_force(servo: Servo) -> tuple[float, bool]:
    """Return the force of the last tick, and whether it was scaled down."""
    last = servo.ring.since(0)[0][-1]
    return float(last[FZ]), bool(int(last[FLAGS]) & TickFlag.STIFFNESS_LIMITED)


class TestStatedStiffness:
    @pytest.mark.parametrize("said", [0.0, 1234.5, np.float32(2.0), 3])
    def test_stated_stiffness_is_used_unchanged(self, said: float) -> None:
        touch = spring(5000.0)
        touch.stiffness_n_per_m = said
        assert find_stiffness(touch, SPEC) == (float(said), "")
        assert touch.asked == 0

    @pytest.mark.parametrize("said", [math.nan, math.inf, -1.0])
    def test_stated_stiffness_that_is_invalid_is_refused(self, said: float) -> None:
        touch = spring(5000.0)
        touch.stiffness_n_per_m = said
        with pytest.raises(BrokenMethod, match=r"^Law states a stiffness of .* N/m; state 0 or more, or None"):
            find_stiffness(touch, SPEC)

    def test_compiled_law_of_unstated_stiffness_is_measured(self) -> None:
        said = wall(1500.0)
        silent = CompiledTouch(said.tick, said.fixed)
        assert silent.stiffness_n_per_m is None
        assert find_stiffness(silent, SPEC).n_per_m == pytest.approx(1500, rel=1e-6)
        assert find_stiffness(said, SPEC) == (1500.0, "")


class TestMeasuredStiffness:
    @pytest.mark.parametrize("k", [1.0, 2e5])
    def test_spring_is_measured_exactly(self, k: float) -> None:
        found = find_stiffness(spring(k), SPEC)
        assert found.n_per_m == pytest.approx(k, rel=1e-6)
        assert found.how == f"Law does not state its stiffness; {k:.4g} N/m was measured"

    def test_steep_ground_and_walls_are_measured(self) -> None:
        """The stiffness along the force is k (1 + g^2)."""
        slope = load_method("render", "penalty-gradient")(stiffness_n_per_m=500.0).touch(ramp((0.6, 0.8), 0.06).surface)
        slope.stiffness_n_per_m = None
        assert find_stiffness(slope, SPEC).n_per_m == pytest.approx(1000, rel=0.01)
        law = Law(lambda x, y, z: (-3000.0 * x, 0.0, 2.0) if z < LEVEL_M else NO_FORCE)
        assert find_stiffness(law, SPEC).n_per_m == pytest.approx(3000, rel=1e-6)

    def test_stiffening_law_is_measured_up_to_the_device_force(self) -> None:
        """F = c d^2, whose slope counts at the deepest place with a force that the device can give."""
        c = 1e6
        assert find_stiffness(level(lambda depth: c * depth**2), SPEC).n_per_m == pytest.approx(
            2 * c * (DEPTHS_M[2] + STEP_M / 2), rel=0.02
        )
        weak = DeviceSpec(1.0, 3000.0, 20.0, SPEC.workspace_m, 1e-6)
        assert find_stiffness(level(lambda depth: c * depth**2), weak).n_per_m == pytest.approx(
            2 * c * (DEPTHS_M[1] + STEP_M / 2), rel=0.02
        )

    @pytest.mark.parametrize(
        "law",
        [
            lambda x, y, z: NO_FORCE,
            lambda x, y, z: (0.0, 0.0, 2.0 * (z < LEVEL_M)),
            lambda x, y, z: (0.0, 0.0, (1.0 + (x // 0.001) % 2) * (z < LEVEL_M)),
            lambda x, y, z: (0.0, 0.0, math.nan),
        ],
        ids=["none", "a step", "cells", "nan"],
    )
    def test_force_that_jumps_is_not_a_spring(self, law: Any) -> None:
        assert find_stiffness(Law(law), SPEC).n_per_m == 0

    def test_vibration_at_rest_is_not_a_spring(self) -> None:
        class Shaking(Law):
            def force(self, state: HapticState) -> Force:
                x, y, z = super().force(state)
                return Force(x, y, z * (1 + self.asked % 2))

        shaking = Shaking(lambda x, y, z: (0.0, 0.0, 2.0 * (z < LEVEL_M)))
        assert find_stiffness(shaking, SPEC).n_per_m == 0

    @pytest.mark.parametrize(("width_m", "height_m"), [(0.004, 0.0123), (0.02, 0.0), (0.3, 0.2)])
    def test_surface_of_any_size_is_found(self, width_m: float, height_m: float) -> None:
        def law(x: float, y: float, z: float) -> tuple[float, float, float]:
            inside = abs(x) < width_m / 2 and abs(y) < width_m / 2 and z < height_m
            return 0.0, 0.0, 700.0 * (height_m - z) * inside

        assert find_stiffness(Law(law), SPEC).n_per_m == pytest.approx(700, rel=1e-6)

    def test_measurement_finds_a_stiff_quarter_and_leaves_the_law_unchanged(self) -> None:
        law = Law(lambda x, y, z: (0.0, 0.0, (9000.0 if x > 0.01 and y > 0.01 else 500.0) * max(0.0, LEVEL_M - z)))
        assert find_stiffness(law, SPEC).n_per_m == pytest.approx(9000, rel=1e-6)
        heights = np.random.default_rng(0).uniform(0, 0.002, (32, 32)).astype(np.float32)
        touch = load_method("render", "proxy")(static_friction=0.4).touch(HapticSurface.from_heights(heights))
        touch.stiffness_n_per_m = None
        before = touch.path(np.full((3, 3), 0.001))
        assert find_stiffness(touch, SPEC) == find_stiffness(touch, SPEC)
        np.testing.assert_array_equal(touch.path(np.full((3, 3), 0.001)), before)


def law_at_fault(fault: Callable[[], object]) -> Law:
    """Return a spring of 900 N/m that has this fault at places to the right."""

    def law(x: float, y: float, z: float) -> tuple[float, float, float]:
        if x > 0.01:
            fault()
        return 0.0, 0.0, 900.0 * max(0.0, LEVEL_M - z)

    return Law(law)


class TestFaultyLaw:
    @pytest.mark.parametrize("error", [ZeroDivisionError("at fault"), SystemExit(0)])
    def test_law_that_raises_keeps_the_slopes_before(
        self, error: BaseException, caplog: pytest.LogCaptureFixture
    ) -> None:
        def fail() -> None:
            raise error

        found = find_stiffness(law_at_fault(fail), SPEC)
        assert found.n_per_m == pytest.approx(900, rel=1e-6)
        assert found.how.endswith(f"then it raised {type(error).__name__}: {error}")
        assert found.how in caplog.text

    def test_law_that_blocks_or_cannot_be_copied_counts_as_zero(self, monkeypatch: pytest.MonkeyPatch) -> None:
        touch = spring(900.0)
        touch.lock = threading.Lock()  # pyright: ignore[reportAttributeAccessIssue]
        found = find_stiffness(touch, SPEC)
        assert found.n_per_m == 0
        assert "then it raised TypeError" in found.how
        monkeypatch.setattr(stiffness, "MAX_S", 0.3)
        ended = threading.Event()
        touch = law_at_fault(lambda: ended.wait(60))
        begun_s = time.monotonic()
        found = find_stiffness(touch, SPEC)
        ended.set()
        assert time.monotonic() - begun_s < 20
        assert found.n_per_m == pytest.approx(900, rel=1e-6)
        assert found.how.endswith("it took longer than 0.3 s")
