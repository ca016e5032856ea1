"""The force loop in its process: what is felt is not the surface, or a force is left when the loop ends."""

import os
import signal
import subprocess
import sys
from pathlib import Path

import numpy as np
import pytest

from ctrl_c import HEARING
from faulty_touch import FaultyTouch
from loop_devices import Circling, Failing
from loop_scenes import SOFT_N_PER_M, held_force, proxy
from tangible_core import HapticSurface, load_method
from tangible_core.data import TICK_COLUMNS, TickFlag
from tangible_core.errors import ConfigError
from tangible_core.servo import OVER, Safety, Servo
from tangible_core.servo.ring import shared_folder
from waiting import until

FLAGS = TICK_COLUMNS.index("flags")
FORCE = slice(TICK_COLUMNS.index("fx_n"), TICK_COLUMNS.index("fx_n") + 3)
LEVEL = HapticSurface.from_heights(np.full((32, 32), 0.002, np.float32))
AT_ONCE = Safety(ramp_s=0, stale_s=1.0)  # a late tick takes no force away
DEEP_M = 0.05
"""Height of a surface with a force to speak of even with a stiffness of SOFT_N_PER_M."""

pytestmark = pytest.mark.usefixtures("patient")


def ticks(servo: Servo) -> np.ndarray:
    return servo.ring.since(0)[0]


class TestTicks:
    @pytest.mark.usefixtures("loop_in_thread")
    @pytest.mark.parametrize(
        ("device", "how"),
        [
            (Circling(z_m=0.001), "Python" if sys.platform != "linux" else "the whole loop is compiled"),
            (Circling(z_m=0.001, exchanges=True), "Python calls the device"),
            (Failing(fault="none"), "the tick is in Python"),
        ],
    )
    def test_each_kind_of_loop_renders_the_surface(self, device, how: str) -> None:
        with Servo(proxy(DEEP_M, stiffness_n_per_m=SOFT_N_PER_M), device, AT_ONCE, seconds=0.3) as servo:
            assert how in servo.how
            assert servo.start_s > 0
            until(lambda: not servo.running)
            report, rows = servo.report(), ticks(servo)
        depth = DEEP_M - (0.001 if isinstance(device, Circling) else -0.001)
        assert (report.ticks, len(rows), report.stopped) == (300, 300, OVER)
        np.testing.assert_allclose(rows[-1, FORCE], (0, 0, SOFT_N_PER_M * depth), atol=1e-6)
        np.testing.assert_allclose(rows[-1, 8:11], (*rows[-1, 2:4], DEEP_M), atol=1e-6)
        assert int(rows[-1, FLAGS]) & TickFlag.TOUCHING
        assert (np.diff(rows[:, 0]) > 0).all()
        due_s, late_s = rows[-1, 0] - rows[-1, 1], rows[-1, 1]
        periods = 299 + report.overruns - int(1000 * late_s)  # a tick each, or none; and what the last one missed
        assert due_s == pytest.approx(0.001 * periods, abs=1e-9)

    @pytest.mark.parametrize("seconds", [0, float("nan"), float("inf")])
    def test_servo_time_that_is_invalid_is_refused(self, seconds: float) -> None:
        with pytest.raises(ConfigError, match="seconds"):
            Servo(proxy(), Circling(), seconds=seconds)


@pytest.mark.usefixtures("loop_in_thread")
class TestSwap:
    @pytest.mark.parametrize("device", [Circling(z_m=0.0), Circling(z_m=0.0, exchanges=True), Failing(fault="none")])
    def test_swap_takes_effect_from_one_tick_to_the_next(self, device) -> None:
        with Servo(proxy(DEEP_M, stiffness_n_per_m=SOFT_N_PER_M), device, AT_ONCE) as servo:
            until(lambda: servo.report().ticks > 100)
            limited = AT_ONCE.model_copy(update={"max_force_n": 0.05})
            servo.swap(proxy(DEEP_M + 0.001, stiffness_n_per_m=SOFT_N_PER_M), limited)
            there = servo.report().ticks
            until(lambda: servo.report().ticks > there + 100)
            servo.stop()
            rows = ticks(servo)
        (swapped,) = np.flatnonzero(rows[:, FLAGS].astype(int) & TickFlag.SWAPPED)
        assert np.nanmax(rows[:swapped, 10]) == pytest.approx(DEEP_M, abs=1e-6)
        assert np.nanmin(rows[swapped + 5 :, 10]) == pytest.approx(DEEP_M + 0.001, abs=1e-6)
        assert rows[swapped - 1, 13] > 0.09
        # The guard's step is a share of the time since the last tick: this long the force may be on its way.
        on_its_way_s = 1.01e-3 * (rows[swapped - 1, 13] - 0.05) / AT_ONCE.max_step_n
        moved = rows[swapped:, 0] > rows[swapped - 1, 0] + on_its_way_s
        assert rows[swapped:][moved, 13].max() == pytest.approx(0.05)

    @pytest.mark.parametrize("device", [Circling(z_m=0.0), Failing(fault="none")])
    def test_swapped_scene_fades_in(self, device) -> None:
        fading = Safety(ramp_s=0.1, stale_s=1.0, max_step_n=10, passivity="off")
        with Servo(proxy(DEEP_M, stiffness_n_per_m=SOFT_N_PER_M), device, fading) as servo:
            until(lambda: len(ticks(servo)) > 50 and not int(ticks(servo)[-1, FLAGS]) & TickFlag.RAMPING)
            servo.swap(proxy(DEEP_M, stiffness_n_per_m=SOFT_N_PER_M))
            until(lambda: bool((ticks(servo)[:-1, FLAGS].astype(int) & TickFlag.SWAPPED).any()))
            until(lambda: not int(ticks(servo)[-1, FLAGS]) & TickFlag.RAMPING)
            servo.stop()
            rows = ticks(servo)
        flags = rows[:, FLAGS].astype(int)
        (swapped,) = np.flatnonzero(flags & TickFlag.SWAPPED)
        assert not flags[swapped - 1] & TickFlag.RAMPING
        share = (rows[swapped:, 0] - rows[swapped - 1, 0]) / 0.1
        assert (((flags[swapped:] & TickFlag.RAMPING) != 0) == (share < 1)).all() or np.abs(share - 1).min() < 1e-6
        whole = rows[swapped - 1, FORCE][2]
        assert whole > 0.05
        np.testing.assert_allclose(rows[swapped:, FORCE][:, 2], np.minimum(share, 1) * whole, rtol=1e-4)

    def test_swapped_law_changes_the_kind_of_loop(self) -> None:
        with Servo(proxy(), Circling()) as servo:
            assert "the tick is in Python" not in servo.how
            servo.swap(FaultyTouch())
            assert "the tick is in Python" in servo.how
            servo.swap(load_method("render", "penalty")().touch(LEVEL))
            assert "the tick is in Python" not in servo.how
            there = servo.report().ticks
            until(lambda: servo.report().ticks > there + 20)


class TestNoForceIsLeft:
    @pytest.mark.parametrize(
        ("fault", "stopped"), [("unplugged", "does not answer"), ("none", OVER), ("nan", OVER), ("hangs", OVER)]
    )
    @pytest.mark.usefixtures("loop_in_thread")
    def test_any_device_fault_leaves_no_force(self, fault, stopped: str, tmp_path: Path) -> None:
        record = tmp_path / "force"
        with Servo(proxy(), Failing(fault=fault, record=str(record)), AT_ONCE, seconds=1.0) as servo:
            until(lambda: not servo.running)
            assert stopped in servo.report().stopped
            assert held_force(record) == 0
            rows = ticks(servo)
        assert rows[:, FORCE].any(), "the device held one before"
        if fault == "nan":
            (bad,) = np.flatnonzero(rows[:, FLAGS].astype(int) & TickFlag.NOT_FINITE)
            np.testing.assert_array_equal(rows[bad, FORCE], 0)

    @pytest.mark.usefixtures("loop_in_thread")
    def test_driver_error_is_raised_in_the_host(self, tmp_path: Path) -> None:
        record = tmp_path / "force"
        with (
            pytest.raises(ZeroDivisionError, match="the driver's own fault"),
            Servo(proxy(), Failing(fault="bug", record=str(record)), AT_ONCE) as servo,
        ):
            until(lambda: not servo.running)
        assert held_force(record) == 0

    @pytest.mark.parametrize("killed_by", [signal.SIGKILL, pytest.param(signal.SIGINT, marks=pytest.mark.whole)])
    def test_killed_host_leaves_no_force_and_no_memory(self, tmp_path: Path, killed_by: signal.Signals) -> None:
        record = tmp_path / "force"
        script = [*HEARING, sys.executable, "-c", HOST.format(record=str(record))]
        host = subprocess.Popen(script, stderr=subprocess.DEVNULL, start_new_session=True)
        try:
            until(lambda: held_force(record) > 0)
            if killed_by == signal.SIGINT:
                os.killpg(host.pid, killed_by)  # as the keyboard does: host and loop both
            else:
                os.kill(host.pid, killed_by)
            until(lambda: held_force(record) == 0)
            host.wait(60)
            until(lambda: not list(shared_folder().glob(f"tangible-{host.pid}-*")))
        finally:
            host.kill()


HOST = """
import time
from loop_devices import Failing
from moving_plane import MovingPlane, level
from tangible_core.servo import Safety, Servo
with Servo(MovingPlane(0.01, 100.0), Failing(fault="none", record={record!r}), Safety(ramp_s=0)) as servo:
    for number in range(30_000):
        servo.show(level(0.01 + 0.001 * (number % 3)), number)
        time.sleep(0.002)
"""
