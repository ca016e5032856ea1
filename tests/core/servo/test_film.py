"""A moving surface, shown by one process and read by the loop's: a film that stands still, tears or leaves force."""

import time
from contextlib import nullcontext, suppress
from pathlib import Path

import numpy as np
import pytest

from faulty_touch import Fault, FaultyFilm
from loop_devices import Circling, Failing
from loop_scenes import SOFT_N_PER_M, held_force, left_behind, proxy
from moving_plane import MovingPlane, level
from tangible_core import HapticSurface, load_method
from tangible_core.data import TICK_COLUMNS, Relief
from tangible_core.errors import BrokenMethod, DeviceError
from tangible_core.servo import Packed, Safety, Servo, beacon_to, null_touch, pack_touch
from tangible_core.servo.guard.layout import GIVEN_J
from tangible_core.session import run_simulated
from waiting import until

pytestmark = pytest.mark.usefixtures("own_memory", "patient")

AT_ONCE = Safety(ramp_s=0, stale_s=1.0)  # a late tick takes no force away
FRAME = TICK_COLUMNS.index("frame")
EXCHANGING = pytest.param(Circling(z_m=0.008, exchanges=True), marks=pytest.mark.whole)
DEVICES = [Circling(z_m=0.008), EXCHANGING, Failing(fault="none")]


@pytest.mark.usefixtures("loop_in_thread")
class TestShow:
    @pytest.mark.parametrize("device", DEVICES)
    def test_shown_frames_move_the_surface_of_the_loop(self, device) -> None:
        """For each kind of loop; ticks have the frame, and the guard counts the surface's work."""
        film = MovingPlane(0.01, stiffness_n_per_m=SOFT_N_PER_M)
        depth_m = 0.002 if isinstance(device, Circling) else 0.011
        with Servo(film, device, AT_ONCE) as servo:
            until(lambda: servo.report().force.z == pytest.approx(SOFT_N_PER_M * depth_m))  # not one that still grows
            before = servo.report()
            servo.show(level(0.012), 7)
            until(lambda: servo.report().frame == 7 and servo.film is not None and servo.film.arrived)
            until(lambda: servo.report().force.z - before.force.z == pytest.approx(SOFT_N_PER_M * 0.002))
            given_j = servo.ring.guard[GIVEN_J]
            servo.stop()
            rows, _ = servo.ring.since(0)
        # The force before a step does the work of it: half the steps' work less, which late ticks make large.
        assert 0.002 * depth_m <= given_j / SOFT_N_PER_M <= 0.002 * (depth_m + 0.001) * 1.001
        assert before.frame == 0 and set(rows[:, FRAME]) == {0.0, 7.0}
        assert film.plane[0] == 0.01, "what was handed over is not what is felt"

    def test_show_without_film_is_refused(self) -> None:
        film = MovingPlane()
        with Servo(proxy(0.01), Circling(), AT_ONCE) as servo:
            with pytest.raises(DeviceError, match="stands still and shows no frame; start with a film"):
                servo.show(level(0.011), 1)
            until(lambda: servo.ring.count)
            assert servo.film is servo.report().frame is None
            servo.swap(film)
            servo.show(level(0.011), 1)
            until(lambda: servo.report().frame == 1)
            servo.swap(null_touch())
            with pytest.raises(DeviceError, match="stands still"):
                servo.show(level(0.011), 2)
            servo.swap(film)  # once more, as it was handed over
            until(lambda: servo.report().frame == 0)
            servo.stop()
            with pytest.raises(DeviceError, match="the force loop has ended: stopped"):
                servo.show(level(0.011), 3)
            assert servo.film is not None and servo.film.arrived
        assert not left_behind()


@pytest.mark.usefixtures("loop_in_thread")
class TestPacked:
    def test_packed_film_is_shown_by_its_packer(self) -> None:
        """Even if another process starts the loop, with the file's name and the stiffness alone."""
        made = pack_touch(MovingPlane(0.01), Circling().spec())
        handed_on = Packed(str(made.parcel), made.stiffness_n_per_m)
        with Servo(null_touch(), Circling(z_m=0.009), AT_ONCE) as servo:
            servo.swap(handed_on)
            with pytest.raises(DeviceError, match="start with a film"):
                servo.show(level(0.012), 1)
            assert made.film is not None
            made.film.show(level(0.012), 3)
            until(lambda: servo.report().frame == 3 and made.film.arrived)
        assert not left_behind()


class TestFaults:
    @pytest.mark.parametrize("fault", ["no number", pytest.param("exits", marks=pytest.mark.whole)])
    def test_law_that_fails_under_a_film_and_a_beacon_leaves_no_force(self, tmp_path: Path, fault: Fault) -> None:
        record, labels = tmp_path / "force", np.zeros((64, 64), np.int32)
        labels[:8, :8] = 1
        surface = HapticSurface(Relief(np.zeros((64, 64), np.float32), (0.08, 0.08)), labels, None, ("wall", "door"))
        beacon = beacon_to(surface, "door")
        servo = Servo(FaultyFilm(fault, at=400), Failing(fault="none", record=str(record), simulated=False), AT_ONCE)
        expected = nullcontext() if fault == "no number" else pytest.raises(BrokenMethod)
        with expected, servo:
            servo.pull_to(beacon)
            until(lambda: held_force(record) > 0)
            with suppress(DeviceError, BrokenMethod):  # as the loop ends
                while servo.running and "NOT_FINITE" not in servo.report().flagged:
                    servo.show(level(0.011), 1)
                    time.sleep(0.01)
            if fault == "no number":  # the loop goes on, and lets none of it through
                until(lambda: not any(servo.report().force))
                assert servo.running
        assert held_force(record) == 0
        assert not left_behind()


class TestSimulated:
    def feel(self, frames, seconds: float = 0.3, film: MovingPlane | None = None):
        mock = load_method("device", "mock").model_validate(
            {"path": "circle", "z_m": 0.009, "lift_m": 0.01, "hand": None}
        )
        return run_simulated(film or MovingPlane(0.01), mock, seconds, limits=AT_ONCE, frames=frames)

    def test_simulated_frames_follow_the_device_clock_or_stay_the_first(self) -> None:
        film, asked = MovingPlane(0.01), list[float]()

        def frames(time_s: float) -> None:
            asked.append(time_s)
            if len(asked) % 100 == 1:
                film.show(level(0.01 + 0.001 * len(asked) / 100), len(asked) // 100)

        felt = self.feel(frames, film=film)
        assert np.allclose(asked, np.arange(300) / 1000)
        assert felt.frame.tolist() == [0] * 100 + [1] * 100 + [2] * 100
        assert felt.proxy_m[199, 2] == pytest.approx(0.01101)
        assert film.dropped == 0
        film = MovingPlane(0.01)
        moved, stood = self.feel(None, film=film), self.feel(None, film=MovingPlane(0.01).touch)
        assert np.array_equal(moved.rows[:, :FRAME], stood.rows[:, :FRAME])
        assert (moved.frame == 0).all()
