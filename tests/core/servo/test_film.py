"""A moving surface: shown by one process and read by the loop's, in the same memory."""

import os
import signal
import subprocess
import sys
import time
from contextlib import nullcontext, suppress
from pathlib import Path

import numpy as np
import pytest

from faulty_touch import Fault, FaultyFilm
from loop_devices import Circling, Failing
from loop_scenes import SOFT_N_PER_M, held_force
from moving_plane import MovingPlane, level
from tangible_core import HapticSurface, load_method
from tangible_core.compiled.touch import CompiledTouch
from tangible_core.data import TICK_COLUMNS, Relief
from tangible_core.errors import BrokenMethod, ConfigError, DeviceError
from tangible_core.plugins.interfaces import Touch
from tangible_core.servo import Packed, Safety, Servo, beacon_to, null_touch, pack_touch, parcel
from tangible_core.servo.guard.layout import GIVEN_J
from tangible_core.servo.ring import shared_folder
from tangible_core.session import run_simulated
from waiting import until

pytestmark = pytest.mark.usefixtures("own_memory", "patient")

AT_ONCE = Safety(ramp_s=0, stale_s=1.0)  # a late tick takes no force away
FRAME = TICK_COLUMNS.index("frame")
DEVICES = [Circling(z_m=0.008), Circling(z_m=0.008, exchanges=True), Failing(fault="none")]


def proxy() -> Touch:
    return load_method("render", "proxy")().touch(HapticSurface.from_heights(np.full((16, 16), 0.01, np.float32)))


def left_behind() -> set[Path]:
    return set(shared_folder().glob(f"tangible-{os.getpid()}-*"))


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
        with Servo(proxy(), Circling(), AT_ONCE) as servo:
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

    def test_film_that_cannot_be_sent_leaves_the_scene_before(self) -> None:
        with Servo(MovingPlane(), Circling(), AT_ONCE) as servo:
            before, broken = servo.film, MovingPlane()
            assert isinstance(broken.touch, CompiledTouch)
            broken.touch.stiffness_n_per_m = -1.0
            with pytest.raises(Exception, match="stiffness of"):
                servo.swap(broken)
            assert servo.film is before
            servo.show(level(0.02), 5)
            until(lambda: servo.report().frame == 5)
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

    def test_packed_film_in_the_same_process_is_shown_by_the_servo(self) -> None:
        made = pack_touch(MovingPlane(0.01), Circling().spec())
        with Servo(made, Circling(z_m=0.009), AT_ONCE) as servo:
            assert servo.film is made.film
            servo.show(level(0.012), 3)
            until(lambda: servo.report().frame == 3)
        assert pack_touch(proxy(), Circling().spec()).film is None
        for path in left_behind():
            path.unlink()

    def test_film_memory_is_shared_by_all_who_unpack_it(self) -> None:
        path = parcel.pack(MovingPlane(0.01))
        here, again, there = parcel.share(path), parcel.share(path), parcel.unpack(path)
        here.show(level(0.0123), 9)
        assert again.plane.tolist() == there.plane.tolist() == here.plane.tolist()
        assert there.touch.fixed[0] is there.plane and there.touch.fixed[2] is there.touch.moving
        assert not path.exists()


def usage(process: int | str) -> np.ndarray:
    """Return the process's number of descriptors and mappings, and its own memory, KiB."""
    of = Path(f"/proc/{process}")
    status = of.joinpath("status").read_text()
    anonymous = int(status.partition("RssAnon:")[2].split()[0])
    return np.array(
        [len(list(of.joinpath("fd").iterdir())), len(of.joinpath("maps").read_text().splitlines()), anonymous]
    )


class TestFaults:
    @pytest.mark.parametrize("times", [60, pytest.param(5000, marks=pytest.mark.nightly)])
    def test_swaps_of_films_and_touches_leave_no_memory(self, times: int) -> None:
        """In the loop's process, and in this one, which maps each film too."""
        with Servo(proxy(), Circling(z_m=0.009), AT_ONCE) as servo:

            def swap(count: int) -> tuple[np.ndarray, np.ndarray]:
                for i in range(count):
                    servo.swap(MovingPlane(0.01) if i % 2 else proxy())
                    if i % 2:
                        servo.show(level(0.011), i)
                return usage(servo.process_id), usage("self")

            first = swap(60)
            last = swap(times)
            for before, after in zip(first, last, strict=True):
                descriptors, mappings, kibibytes = after - before
                assert abs(descriptors) <= 2 and abs(mappings) <= 10
                assert kibibytes <= 10_000
        assert not left_behind()

    def test_loop_killed_during_a_film_leaves_no_force(self, tmp_path: Path) -> None:
        record = tmp_path / "force"
        device = Failing(fault="none", record=str(record), simulated=False)
        with Servo(MovingPlane(0.01, 100.0), device, AT_ONCE) as servo:
            until(lambda: record.exists() and float(record.read_text() or 0) > 0)
            until(lambda: bool(servo.show(level(0.011), 1) or servo.report().frame))
            os.kill(servo.process_id, signal.SIGKILL)
            with pytest.raises(DeviceError, match=r"died|stood still"):
                for number in range(2, 1_000_000):
                    servo.show(level(0.01 + 0.001 * (number % 3)), number)
                    time.sleep(0.001)
            assert float(record.read_text()) == 0
        assert not left_behind()

    @pytest.mark.parametrize("fault", ["blocks", "exits", "odd error", "no number"])
    def test_law_that_fails_under_a_film_and_a_beacon_leaves_no_force(self, tmp_path: Path, fault: Fault) -> None:
        """While frames are shown, and the beacon pulls to a part that the hand is not on."""
        record, labels = tmp_path / "force", np.zeros((64, 64), np.int32)
        labels[:8, :8] = 1
        surface = HapticSurface(Relief(np.zeros((64, 64), np.float32), (0.08, 0.08)), labels, None, ("wall", "door"))
        beacon = beacon_to(surface, "door")
        servo = Servo(FaultyFilm(fault, at=400), Failing(fault="none", record=str(record), simulated=False), AT_ONCE)
        expected = nullcontext() if fault in ("blocks", "no number") else pytest.raises(BrokenMethod)
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

    def test_host_killed_during_a_film_leaves_no_force(self, tmp_path: Path) -> None:
        record = tmp_path / "force"
        program = subprocess.Popen([sys.executable, "-c", HOST.format(path=sys.path, record=str(record))])
        until(lambda: record.exists() and float(record.read_text() or 0) > 0)
        time.sleep(0.1)
        program.kill()
        program.wait()
        until(lambda: float(record.read_text() or 1) == 0)
        until(lambda: not set(shared_folder().glob(f"tangible-{program.pid}-*")))


HOST = """
import sys, time
sys.path[:] = {path}
from moving_plane import MovingPlane, level
from tangible_core.servo import Safety, Servo
from loop_devices import Failing
if __name__ == "__main__":
    with Servo(MovingPlane(0.01, 100.0), Failing(fault="none", record={record!r}), Safety(ramp_s=0)) as servo:
        number = 0
        while True:
            servo.show(level(0.01 + 0.001 * (number % 3)), number)
            number += 1
            time.sleep(0.002)
"""


class TestSimulated:
    def feel(self, frames, seconds: float = 0.3, film: MovingPlane | None = None):
        mock = load_method("device", "mock").model_validate(
            {"path": "circle", "z_m": 0.009, "lift_m": 0.01, "hand": None}
        )
        return run_simulated(film or MovingPlane(0.01), mock, seconds, limits=AT_ONCE, frames=frames)

    def test_simulated_frames_follow_the_device_clock(self) -> None:
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

    def test_error_of_frames_ends_the_session(self) -> None:
        def frames(_: float) -> None:
            raise ConfigError("there is no such frame")

        with pytest.raises(ConfigError, match="no such frame"):
            self.feel(frames)

    def test_film_without_shown_frames_equals_its_first_frame_to_the_bit(self) -> None:
        film = MovingPlane(0.01)
        moved, stood = self.feel(None, film=film), self.feel(None, film=MovingPlane(0.01).touch)
        assert np.array_equal(moved.rows[:, :FRAME], stood.rows[:, :FRAME])
        assert (moved.frame == 0).all()
