"""Swaps of scenes in a force loop: they leave no memory, lose no stop, and a broken scene is refused."""

import gc
import io
import os
import random
import signal
import threading
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from faulty_touch import FaultyTouch
from loop_devices import Circling, Failing
from loop_scenes import proxy
from tangible_core.errors import DeviceError
from tangible_core.plugins.interfaces import HapticDevice
from tangible_core.runtime.system import priority
from tangible_core.servo import Safety, Servo
from tangible_core.servo.child import Child
from tangible_core.servo.framing import Start, StartReply, Swap, SwapReply, receive, send
from tangible_core.servo.parcel import pack
from tangible_core.servo.ring import LAST, PERIOD_NS, STOP, SWAP, Ring, shared_folder
from tangible_core.servo.ticks import loop
from waiting import until

pytestmark = pytest.mark.usefixtures("own_memory")

AT_ONCE = Safety(ramp_s=0, max_step_n=10)


def left_behind() -> set[Path]:
    return set(shared_folder().glob(f"tangible-{os.getpid()}-*"))


@pytest.mark.parametrize("kept", [0, 4, 8, -1])
def test_receive_of_half_a_message_is_none(kept: int) -> None:
    """Such as by a process that was killed while it wrote."""
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
            (Circling(), 200, 500),
            (Circling(exchanges=True), 20, 60),  # dear: Python ticks all the while
            pytest.param(Circling(exchanges=True), 200, 500, marks=pytest.mark.nightly),
            (Failing(fault="none"), 200, 500),
        ],
    )
    def test_swaps_leave_no_descriptors_or_memory(self, device: HapticDevice, few: int, many: int) -> None:
        """Checks descriptors, mappings and memory of the loop's process, and that its threads still respond."""
        scenes = [proxy(), proxy(0.003)]
        with Servo(scenes[0], device, AT_ONCE) as servo:

            def swap(times: int) -> tuple[int, int, int]:
                for i in range(times):
                    servo.swap(scenes[i % 2])
                return usage(servo.process_id)

            first = swap(few)
            last = swap(many)
            descriptors, mappings, kibibytes = np.subtract(last, first)
            assert abs(descriptors) <= 2
            assert abs(mappings) <= 10
            assert kibibytes <= 2_500
            assert servo.stop("enough").stopped == "enough"

    def test_scenes_in_reference_cycles_are_collected(self) -> None:
        """800 kB each."""
        with Servo(FaultyTouch("knows itself"), Failing(fault="none"), AT_ONCE) as servo:
            for _ in range(10):
                servo.swap(FaultyTouch("knows itself"))
            *_, first = usage(servo.process_id)
            for _ in range(100):
                servo.swap(FaultyTouch("knows itself"))
            assert usage(servo.process_id)[-1] - first < 20_000

    @pytest.mark.nightly
    def test_five_thousand_swaps_leave_no_memory(self) -> None:
        with Servo(proxy(), Circling(), AT_ONCE) as servo:
            for _ in range(200):
                servo.swap(proxy())
            first = usage(servo.process_id)
            for _ in range(5000):
                servo.swap(proxy())
            descriptors, _, kibibytes = np.subtract(usage(servo.process_id), first)
            assert abs(descriptors) <= 2
            assert kibibytes <= 10_000


def usage(process: int) -> tuple[int, int, int]:
    """Return the process's number of descriptors and mappings, and its own memory, KiB."""
    of = Path(f"/proc/{process}")
    status = of.joinpath("status").read_text()
    anonymous = int(status.partition("RssAnon:")[2].split()[0])
    return len(list(of.joinpath("fd").iterdir())), len(of.joinpath("maps").read_text().splitlines()), anonymous


class Session:
    """The loop's side of a session in a thread of this process, with the pipes of a host."""

    def __init__(self, device: Any) -> None:
        self.others = set(threading.enumerate())
        self.ring = Ring.create(64)
        self.settings, memory = AT_ONCE.arrays(device.spec(), 0.0)
        self.ring.guard[: memory.size] = memory
        self.ring.header[[PERIOD_NS, LAST]] = 200_000, 2**62
        pipes = [(os.fdopen(read, "rb", 0), os.fdopen(write, "wb", 0)) for read, write in (os.pipe(), os.pipe())]
        (commands, self.commands), (self.replies, replies) = self.pipes = pipes
        self.child = Child(commands, replies)
        self.thread = threading.Thread(target=self.child.main)
        self.thread.start()
        send(self.commands, Start(str(self.ring.path), str(pack(proxy())), device, self.settings, 30.0))

    def heard(self) -> Any:
        return receive(self.replies)

    def close(self) -> None:
        self.commands.close()
        until(lambda: self.others.issuperset(threading.enumerate()))  # one that is just starting cannot be joined
        for pipe in (end for both in self.pipes for end in both):
            pipe.close()
        self.ring.remove()


ENDS: list[Callable[[Session], None]] = [
    lambda session: session.ring.header.__setitem__(STOP, 1),  # the host
    lambda session: session.child.stop("a signal"),  # what a signal's handler does
    lambda session: session.commands.close(),  # the host is gone
]


@pytest.fixture
def in_this_process(monkeypatch: pytest.MonkeyPatch):
    """Request no real-time rights and no locked memory, and leave the garbage collector alone."""
    monkeypatch.setattr(priority, "request", lambda: (False, "nothing asked"))
    yield
    gc.unfreeze()


def test_swap_keeps_the_word_stop() -> None:
    """At a moment that is rare in thousands of swaps: STOP is set after the loop last read it."""
    ring = Ring.create(64)
    ring.header[STOP], ring.header[SWAP] = 1, 1
    loop.take_over(ring)
    found = int(ring.header[STOP]), int(ring.header[SWAP])
    ring.remove()
    assert found == (1, 0)


@pytest.mark.parametrize("most", [800, pytest.param(5000, marks=pytest.mark.nightly)])
@pytest.mark.parametrize("device", [Circling(), Circling(exchanges=True)])
def test_stop_during_thousands_of_swaps_is_not_lost(device, most: int, in_this_process: None) -> None:
    """Sessions are ended in one of three ways at a random moment."""
    rng, swaps, sessions, scene, sent = random.Random(0), 0, 0, proxy(), list[Path]()
    while swaps < most:
        session = Session(device)
        assert isinstance(session.heard(), StartReply)
        end, wait_s = ENDS[sessions % 3], rng.uniform(0, most / 20_000)
        timer = threading.Timer(wait_s, end, [session])
        timer.start()
        with suppress(OSError, ValueError):
            while not session.ring.header[STOP]:
                sent.append(pack(scene))
                send(session.commands, Swap(str(sent[-1]), session.settings))
                if not isinstance(session.heard(), SwapReply):
                    break
                swaps += 1
        timer.join()
        session.close()
        assert session.ring.header[STOP] == 1
        sessions += 1
    assert sessions > 10
    for path in sent:  # a loop that has ended takes none
        path.unlink(missing_ok=True)


@pytest.mark.usefixtures("patient")
@pytest.mark.parametrize("round", [0, 1, *(pytest.param(each, marks=pytest.mark.nightly) for each in range(2, 6))])
def test_sigterm_during_swaps_is_not_lost(round: int, tmp_path: Path) -> None:
    with Servo(FaultyTouch(), Failing(fault="none"), AT_ONCE) as servo:
        timer = threading.Timer(random.Random(round).uniform(0, 0.2), os.kill, [servo.process_id, signal.SIGTERM])
        timer.start()
        with pytest.raises(DeviceError, match="received a signal to end"):
            for _ in range(100_000):
                servo.swap(FaultyTouch())
        timer.join()
        until(lambda: not servo.running)
