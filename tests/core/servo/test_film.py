"""A surface that moves while it is felt: shown from here, felt there, in the same memory."""

import time

import pytest

from moving_plane import MovingPlane, level
from tangible_core.servo import Packed, Safety, Servo, packed, still
from tangible_core.errors import DeviceError
from tangible_core.testing.loop_devices import Circling, Failing

AT_ONCE = Safety(ramp_s=0)


def until(condition, seconds: float = 10.0) -> None:
    end = time.monotonic() + seconds
    while not condition():
        assert time.monotonic() < end, "it did not happen"
        time.sleep(0.005)


DEVICES = [Circling(z_m=0.008), Circling(z_m=0.008, exchanges=True), Failing(fault="none")]


class TestShow:
    @pytest.mark.parametrize("device", DEVICES)
    def test_what_is_shown_here_is_felt_there(self, device) -> None:
        """By each of the three loops, and the ticks tell which frame it was."""
        film = MovingPlane(0.01, stiffness_n_per_m=100.0)
        with Servo(film, device, AT_ONCE) as servo:
            assert servo.film is not None and servo.film is not film
            until(lambda: servo.report().force.z > 0)
            before = servo.report()
            servo.show(level(0.012), 7)
            until(lambda: servo.film.arrived)
            until(lambda: servo.report().frame == 7)
            after = servo.report()
            assert (before.frame, film.arrived) == (0, True)
            assert after.force.z - before.force.z == pytest.approx(100.0 * 0.002, abs=1e-6)
            rows, _ = servo.ring.since(0)
            assert set(rows[:, -1]) == {0.0, 7.0}
