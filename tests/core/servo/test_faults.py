"""Faults around a force loop: each one leaves no force, in bounded time, and is reported."""

import copyreg
import gc
import io
import os
import random
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import contextmanager, suppress
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pytest

from faulty_touch import FaultyTouch, OddError
from loop_devices import Circling, Failing
from tangible_core import HapticSurface, load_method
from tangible_core.errors import BrokenMethod, DeviceError
from tangible_core.plugins.interfaces import Touch
from tangible_core.servo import Safety, Servo, host, supervisor
from tangible_core.servo.child import Child
from tangible_core.servo.framing import Start, StartReply, Swap, SwapReply, receive, send
from tangible_core.servo.parcel import pack
from tangible_core.servo.ring import COUNT, LAST, PERIOD_NS, STOP, SWAP, Ring, shared_folder
from tangible_core.servo.ticks import loop, priority
from waiting import until

pytestmark = pytest.mark.usefixtures("own_memory")

AT_ONCE = Safety(ramp_s=0, max_step_n=10)
MOST_TICKS_AFTER = 500
"""Of 1 ms each, after whatever ends a loop: on a machine that is busy elsewhere, and far from the 3 s of one that is
not stopped but killed. How few they are on a machine that is not busy, the benchmark `servo_faults` says."""


def proxy(height_m: float = 0.002) -> Touch:
    level = HapticSurface.from_heights(np.full((16, 16), height_m, np.float32))
    return load_method("render", "proxy")().touch(level)


def held_force(path: Path) -> float:
    """Return the force that the device holds; NaN if it was never open."""
    text = path.read_text() if path.exists() else ""
    return float(text) if text else float("nan")


def ticks(servo: Servo) -> int:
    try:
        return int(servo.ring.header[COUNT])
    except DeviceError:  # it was not made yet
        return 0


def left_behind() -> set[Path]:
    return set(shared_folder().glob(f"tangible-{os.getpid()}-*"))


class Interrupt:
    """Raises KeyboardInterrupt before the n-th line of `host` or `supervisor` that the main thread comes to."""

    def __init__(self, line: int, servo: Servo) -> None:
        self._left, self._servo = line, servo
        self.ticks = -1
        """Ticks when it was raised; -1 if it was not."""

    def trace(self, frame: FrameType, event: str, _: Any) -> Any:
        if frame.f_code.co_filename not in (host.__file__, supervisor.__file__):
            return None
        if event in ("line", "call"):
            self._left -= 1
            if self._left == 0:
                self.ticks = ticks(self._servo)
                raise KeyboardInterrupt
        return self.trace


class TestInterruptedStart:
    def test_interrupt_at_any_line_of_the_start_leaves_no_force(self, tmp_path: Path) -> None:
        """Every line of the start, one run each: few ticks more, no force, no process, no file."""
        before, ran_through, line = left_behind(), False, 0
        while not ran_through:
            line += 1
            record = tmp_path / f"force {line}"
            servo = Servo(proxy(), Failing(fault="none", record=str(record)), AT_ONCE)
            interrupt = Interrupt(line, servo)
            sys.settrace(interrupt.trace)
            try:
                servo.__enter__()
            except KeyboardInterrupt:
                assert interrupt.ticks >= 0
            else:
                ran_through = True
            finally:
                sys.settrace(None)
            if ran_through:
                servo.stop()
                assert interrupt.ticks == -1
            assert ticks(servo) - max(interrupt.ticks, 0) <= MOST_TICKS_AFTER or ran_through, line
            assert not held_force(record) > 0, line
            assert left_behind() == before, line
        assert line > 25

    @pytest.mark.parametrize("delay_s", [0.05, 0.3, 0.6, 0.9])
    def test_ctrl_c_during_the_start_ends_both_processes(self, tmp_path: Path, delay_s: float) -> None:
        """As by the keyboard, even if the program was started with SIGINT ignored."""
        record, ready = tmp_path / "force", tmp_path / "ready"
        script = HOST.format(record=str(record), ready=str(ready), fault="none", at=0)
        program = subprocess.Popen(
            [sys.executable, "-c", script], stderr=subprocess.PIPE, text=True, start_new_session=True
        )
        until(ready.exists)
        time.sleep(delay_s)
        os.killpg(program.pid, signal.SIGINT)
        _, said = program.communicate(timeout=60)
        assert said.count("Traceback") == 1, said  # the host's; the loop's process says nothing
        assert said.rstrip().endswith("KeyboardInterrupt")
        until(lambda: not held_force(record) > 0)

    def test_start_that_takes_too_long_is_abandoned(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(supervisor, "COMPILING_S", 1.0)
        monkeypatch.setattr(supervisor, "STOPPING_S", 0.5)
        servo = Servo(FaultyTouch(), Failing(opens="late"), AT_ONCE)
        with pytest.raises(DeviceError, match="has not answered for 1 s"):
            servo.__enter__()
        with pytest.raises(ProcessLookupError):
            os.kill(servo.process_id, 0)
        assert not servo.running
        assert not left_behind()

    def test_process_that_cannot_be_started_is_an_error(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(supervisor, "command", lambda _: ["/no/such/python"])
        with pytest.raises(DeviceError, match="no process can be started"), Servo(proxy(), Circling()):
            pytest.fail("it was begun")
        assert not left_behind()

    def test_servo_not_started_is_an_error(self) -> None:
        servo = Servo(proxy(), Circling())
        with pytest.raises(DeviceError, match="with Servo"):
            servo.report()
        with pytest.raises(DeviceError, match="with Servo"):
            servo.swap(proxy())


HOST = """
import signal, time, numpy as np
from pathlib import Path
from tangible_core import HapticSurface, load_method
from tangible_core.servo import Safety, Servo
from loop_devices import Failing
from faulty_touch import FaultyTouch
signal.signal(signal.SIGINT, signal.default_int_handler)
device = Failing(fault="none", record={record!r}, simulated=False)
Path({ready!r}).touch()
with Servo(FaultyTouch({fault!r}, {at}), device, Safety(ramp_s=0, max_step_n=10)):
    time.sleep(60)
"""
"""A program with a session, to be killed, or interrupted from the keyboard."""


class TestStandstill:
    """A loop without ticks has 0.2 s; then its process is killed and the device opened once more to release it."""

    def feel(self, record: Path, law: Touch, fault: Any = "none") -> Servo:
        return Servo(law, Failing(fault=fault, record=str(record), simulated=False), AT_ONCE)

    @pytest.mark.parametrize(
        ("law", "fault"), [(FaultyTouch("blocks"), "none"), (FaultyTouch(), "blocks"), (proxy(), "blocks")]
    )
    def test_law_or_device_that_blocks_is_killed(self, tmp_path: Path, law: Touch, fault: str) -> None:
        record = tmp_path / "force"
        with self.feel(record, law, fault) as servo:
            until(lambda: not servo.running)
            assert servo.report().stopped == supervisor.STOOD_STILL
            assert servo.device_lost
            assert servo.report().peak_force_n > 0
            assert held_force(record) == 0
            assert servo.report().ticks == 99

    def test_suspended_process_is_killed(self, tmp_path: Path) -> None:
        record = tmp_path / "force"
        with self.feel(record, FaultyTouch()) as servo:
            until(lambda: held_force(record) > 0)
            os.kill(servo.process_id, signal.SIGSTOP)
            until(lambda: not servo.running)
            assert servo.report().stopped == supervisor.STOOD_STILL
            assert held_force(record) == 0

    @pytest.mark.usefixtures("loop_in_thread")
    def test_standstill_bound_counts_checks_and_grows_with_the_period(self, tmp_path: Path) -> None:
        """Ticks 0.3 s apart are not a standstill."""
        with Servo(FaultyTouch(), Failing(fault="none"), AT_ONCE, seconds=1.5, period_s=0.3) as servo:
            until(lambda: not servo.running)
            assert servo.report().ticks == 5
            assert servo.report().stopped == "the time is over"

    @pytest.mark.usefixtures("loop_in_thread")
    def test_law_that_compiles_on_first_use_is_not_a_standstill(self) -> None:
        """The law compiles before the first tick."""
        with Servo(FaultyTouch("begins slowly"), Failing(fault="none"), AT_ONCE, seconds=0.2) as servo:
            until(lambda: not servo.running)
            assert servo.report().stopped == "the time is over"

    def test_device_that_cannot_be_reopened_is_logged(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
    ) -> None:
        monkeypatch.setattr(supervisor, "STOPPING_S", 0.5)
        record = tmp_path / "force"
        device = Failing(fault="none", record=str(record), simulated=False, opens="once")
        with Servo(FaultyTouch(), device, AT_ONCE) as servo:
            until(lambda: held_force(record) > 0)
            os.kill(servo.process_id, signal.SIGSTOP)
            until(lambda: not servo.running)
        assert "may still hold its last force; switch it off" in caplog.text

    def test_law_that_blocks_without_host_leaves_no_force(self, tmp_path: Path) -> None:
        """Without a host to watch it, the loop's own process releases the device."""
        record = tmp_path / "force"
        script = HOST.format(record=str(record), ready=str(tmp_path / "ready"), fault="blocks", at=3000)
        program = subprocess.Popen([sys.executable, "-c", script], stderr=subprocess.DEVNULL)
        until(lambda: held_force(record) > 0)
        program.send_signal(signal.SIGSTOP)  # nobody watches from now on, and the law blocks in its 3000th tick
        (path,) = shared_folder().glob(f"tangible-{program.pid}-*.ring")
        ring = Ring.attach(path)
        until(lambda: ring.count == 2999)
        assert held_force(record) > 0
        program.kill()
        program.wait()
        until(lambda: held_force(record) == 0)

    @pytest.mark.parametrize("name", ["SIGTERM", "SIGHUP", "SIGQUIT"])
    def test_terminal_signals_to_the_loop_leave_no_force(self, tmp_path: Path, name: str) -> None:
        record, number = tmp_path / "force", getattr(signal, name)
        with handle_signal(number, signal.SIG_DFL), self.feel(record, FaultyTouch()) as servo:
            until(lambda: held_force(record) > 0)
            os.kill(servo.process_id, number)
            until(lambda: not servo.running)
            assert servo.report().stopped == "the process received a signal to end"
            assert held_force(record) == 0

    def test_signal_ignored_by_the_program_does_not_end_the_loop(self, tmp_path: Path) -> None:
        """Under nohup, when the terminal is closed."""
        with handle_signal(signal.SIGHUP, signal.SIG_IGN), self.feel(tmp_path / "force", FaultyTouch()) as servo:
            os.kill(servo.process_id, signal.SIGHUP)
            there = servo.report().ticks
            until(lambda: servo.report().ticks > there + 50)

    def test_stop_does_not_wait_for_a_blocking_law(self, tmp_path: Path) -> None:
        record = tmp_path / "force"
        with self.feel(record, FaultyTouch("blocks")) as servo:
            until(lambda: servo.report().ticks == 99)  # the hundredth never ends
        assert servo.report().peak_force_n > 0
        assert held_force(record) == 0

    @pytest.mark.skipif(not hasattr(signal, "SIGTSTP"), reason="this system has no Ctrl-Z")
    def test_ctrl_z_ends_the_loop_without_force(self, tmp_path: Path) -> None:
        record = tmp_path / "force"
        with self.feel(record, FaultyTouch()) as servo:
            until(lambda: held_force(record) > 0)
            os.kill(servo.process_id, signal.SIGTSTP)
            until(lambda: not servo.running)
            assert "paused from the keyboard" in servo.report().stopped
            assert held_force(record) == 0


@contextmanager
def handle_signal(number: int, how: signal.Handlers) -> Iterator[None]:
    """Set the handler of a signal in this process and in those that it starts."""
    before = signal.signal(number, how)
    try:
        yield
    finally:
        signal.signal(number, before)


@pytest.mark.usefixtures("patient")
@pytest.mark.usefixtures("loop_in_thread")
class TestPluginErrors:
    def test_error_that_cannot_be_unpickled_keeps_its_text(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        # distributed, which other tests of this process may have imported, teaches pickle every error that there is.
        monkeypatch.delitem(copyreg.dispatch_table, OddError, raising=False)
        record = tmp_path / "force"
        with (
            pytest.raises(BrokenMethod, match="OddError: a fault in the law"),
            Servo(FaultyTouch("odd error"), Failing(fault="none", record=str(record)), AT_ONCE) as servo,
        ):
            until(lambda: not servo.running)
        assert held_force(record) == 0

    @pytest.mark.parametrize(
        ("law", "fault", "name"),
        [(FaultyTouch("exits"), "none", "faulty_touch"), (FaultyTouch(), "exits", "loop_devices")],
    )
    def test_sys_exit_of_plugin_is_an_error_with_its_name(self, tmp_path: Path, law, fault, name: str) -> None:
        record = tmp_path / "force"
        with (
            pytest.raises(BrokenMethod, match=rf"{name} called sys\.exit\(3\)"),
            Servo(law, Failing(fault=fault, record=str(record)), AT_ONCE) as servo,
        ):
            until(lambda: not servo.running)
        assert held_force(record) == 0

    def test_message_that_cannot_be_read_ends_the_loop(self, monkeypatch: pytest.MonkeyPatch) -> None:
        """If the host cannot read a message, the loop is stopped and the error raised."""

        def deaf(_: object) -> object:
            raise EOFError("half a message")

        monkeypatch.setattr(supervisor, "receive", deaf)
        with pytest.raises(EOFError, match="half a message"), Servo(proxy(), Circling()):
            pytest.fail("it was begun")


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

    @pytest.mark.parametrize("device", [Circling(), Circling(exchanges=True), Failing(fault="none")])
    def test_hundreds_of_swaps_leave_no_descriptors_or_memory(self, device) -> None:
        """Checks descriptors, mappings and memory of the loop's process, and that its threads still respond."""
        scenes = [proxy(), proxy(0.003)]
        with Servo(scenes[0], device, AT_ONCE) as servo:

            def swap(times: int) -> tuple[int, int, int]:
                for i in range(times):
                    servo.swap(scenes[i % 2])
                return usage(servo.process_id)

            first = swap(200)
            last = swap(500)
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
        send(self.commands, Start(str(self.ring.path), str(pack(proxy())), device, self.settings))

    def heard(self) -> Any:
        return receive(self.replies)

    def close(self) -> None:
        self.commands.close()
        for thread in set(threading.enumerate()) - self.others:
            thread.join(20)
            assert not thread.is_alive()
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
@pytest.mark.parametrize("round", range(6))
def test_sigterm_during_swaps_is_not_lost(round: int, tmp_path: Path) -> None:
    with Servo(FaultyTouch(), Failing(fault="none"), AT_ONCE) as servo:
        timer = threading.Timer(random.Random(round).uniform(0, 0.2), os.kill, [servo.process_id, signal.SIGTERM])
        timer.start()
        with pytest.raises(DeviceError, match="received a signal to end"):
            for _ in range(100_000):
                servo.swap(FaultyTouch())
        timer.join()
        until(lambda: not servo.running)
