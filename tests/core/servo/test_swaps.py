"""Swaps of scenes in a force loop: memory is full after a day of them, a stop is lost, or a broken scene ends all."""

import io
import os
import random
import signal
import threading
from pathlib import Path

import numpy as np
import pytest

from faulty_touch import FaultyTouch
from loop_devices import Circling, Failing
from loop_scenes import left_behind, proxy
from moving_plane import MovingPlane, level
from tangible_core.errors import DeviceError
from tangible_core.plugins.interfaces import HapticDevice
from tangible_core.servo import Safety, Servo
from tangible_core.servo.framing import StartReply, receive, send
from tangible_core.servo.ring import STOP, SWAP, Ring
from tangible_core.servo.ticks import loop
from waiting import until

pytestmark = pytest.mark.usefixtures("own_memory")

AT_ONCE = Safety(ramp_s=0, max_step_n=10)


@pytest.mark.parametrize("kept", [0, 4, 8, -1])
def test_receive_of_half_a_message_is_none(kept: int) -> None:
    whole = io.BytesIO()
    send(whole, StartReply("how"))
    assert receive(io.BytesIO(whole.getvalue())) == StartReply("how")
    assert receive(io.BytesIO(whole.getvalue()[:kept])) is None


@pytest.mark.usefixtures("patient")
class TestSwaps:
    @pytest.mark.usefixtures("loop_in_thread")
    def test_swap_of_unreadable_scene_is_refused_and_the_loop_goes_on(self) -> None:
        with Servo(FaultyTouch(), Failing(fault="none"), AT_ONCE) as servo:
            with pytest.raises(LookupError, match="not in process"):
                servo.swap(FaultyTouch("does not arrive"))
            there = servo.report().ticks
            until(lambda: servo.report().ticks > there + 20)
            servo.swap(FaultyTouch())
            assert servo.stop("enough").stopped == "enough"
        assert not left_behind()

    @pytest.mark.parametrize(
        ("device", "few", "many"),
        [
            (Circling(z_m=0.009), 20, 60),
            # dear: Python ticks all the while
            pytest.param(Circling(z_m=0.009, exchanges=True), 10, 20, marks=pytest.mark.whole),
            pytest.param(Circling(z_m=0.009), 200, 5000, marks=pytest.mark.nightly),
            pytest.param(Failing(fault="none"), 200, 500, marks=pytest.mark.whole),
        ],
    )
    def test_swaps_leave_no_descriptors_or_memory(self, device: HapticDevice, few: int, many: int) -> None:
        with Servo(proxy(), device, AT_ONCE) as servo:

            def swap(times: int) -> list[tuple[int, int, int]]:
                for i in range(times):
                    servo.swap(MovingPlane(0.01) if i % 2 else proxy())
                    if i % 2:
                        servo.show(level(0.011), i)
                return [usage(servo.process_id), usage("self")]

            first = swap(few)
            for descriptors, mappings, kibibytes in np.subtract(swap(many), first):
                assert abs(descriptors) <= 2
                assert abs(mappings) <= 10
                assert kibibytes <= 10_000
            assert servo.stop("enough").stopped == "enough"
        assert not left_behind()

    def test_scenes_in_reference_cycles_are_collected(self) -> None:
        """800 kB each."""
        with Servo(FaultyTouch("knows itself"), Failing(fault="none"), AT_ONCE) as servo:
            for _ in range(5):
                servo.swap(FaultyTouch("knows itself"))
            *_, first = usage(servo.process_id)
            for _ in range(40):
                servo.swap(FaultyTouch("knows itself"))
            assert usage(servo.process_id)[-1] - first < 10_000


def usage(process: int | str) -> tuple[int, int, int]:
    """Return the process's number of descriptors and mappings, and its own memory, KiB."""
    of = Path(f"/proc/{process}")
    status = of.joinpath("status").read_text()
    anonymous = int(status.partition("RssAnon:")[2].split()[0])
    return len(list(of.joinpath("fd").iterdir())), len(of.joinpath("maps").read_text().splitlines()), anonymous


def test_swap_keeps_the_word_stop() -> None:
    """At a moment that is rare in thousands of swaps: STOP is set after the loop last read it."""
    ring = Ring.create(64)
    ring.header[STOP], ring.header[SWAP] = 1, 1
    loop.take_over(ring)
    found = int(ring.header[STOP]), int(ring.header[SWAP])
    ring.remove()
    assert found == (1, 0)


@pytest.mark.usefixtures("patient")
@pytest.mark.parametrize("round", [0, *(pytest.param(each, marks=pytest.mark.nightly) for each in range(1, 6))])
def test_sigterm_during_swaps_is_not_lost(round: int, tmp_path: Path) -> None:
    with Servo(FaultyTouch(), Failing(fault="none"), AT_ONCE) as servo:
        timer = threading.Timer(random.Random(round).uniform(0, 0.2), os.kill, [servo.process_id, signal.SIGTERM])
        timer.start()
        with pytest.raises(DeviceError, match="received a signal to end"):
            for _ in range(100_000):
                servo.swap(FaultyTouch())
        timer.join()
        until(lambda: not servo.running)
