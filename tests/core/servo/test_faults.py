"""Faults around a force loop: one that leaves a force on the hand, or is never reported."""

import os
import signal
import subprocess
import sys
import time
from collections.abc import Iterator
from contextlib import contextmanager, nullcontext
from pathlib import Path
from types import FrameType
from typing import Any

import numpy as np
import pytest

from faulty_touch import FaultyTouch
from loop_devices import Circling, Failing
from loop_in_thread import loops_in_threads
from loop_scenes import held_force, left_behind, proxy
from tangible_core.errors import BrokenMethod, DeviceError
from tangible_core.plugins.interfaces import Touch
from tangible_core.runtime.system.timers import now_ns
from tangible_core.servo import Safety, Servo, host, limits, supervisor, watchdog
from tangible_core.servo.ring import COUNT, PREVIOUS_NS, Ring, shared_folder
from waiting import until

pytestmark = pytest.mark.usefixtures("own_memory")

AT_ONCE = Safety(ramp_s=0, max_step_n=10)
MAX_TICKS_AFTER = 500
"""Of 1 ms each, after whatever ends a loop: on a machine that is busy elsewhere, and far from the 3 s of one that is
not stopped but killed. How few they are on a machine that is not busy, the benchmark `servo_faults` says."""

MAX_AFTER_S = 2.0
"""Time that a busy machine takes, after a watchdog's time-out, to clear a process away and open the device again."""


def limited(watchdog_s: float) -> Safety:
    return AT_ONCE.model_copy(update={"watchdog_s": watchdog_s})


def ticks(servo: Servo) -> int:
    try:
        return int(servo.ring.header[COUNT])
    except DeviceError:  # it was not made yet
        return 0


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
    @pytest.mark.parametrize("every", [1, pytest.param(6, marks=pytest.mark.whole)])
    def test_interrupt_at_any_line_of_the_start_leaves_no_force(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, every: int
    ) -> None:
        if every == 1:
            loops_in_threads(monkeypatch)
        before, ran_through, line = left_behind(), False, 1 - every
        while not ran_through:
            line += every
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
            assert ticks(servo) - max(interrupt.ticks, 0) <= MAX_TICKS_AFTER or ran_through, line
            assert not held_force(record) > 0, line
            assert left_behind() == before, line
        assert line > 25

    @pytest.mark.parametrize("delay_s", [0.05, *(pytest.param(each, marks=pytest.mark.whole) for each in (0.3, 0.6))])
    def test_ctrl_c_during_the_start_ends_both_processes(self, tmp_path: Path, delay_s: float) -> None:
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

    def test_late_start_is_abandoned(self, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> None:
        monkeypatch.setattr(limits, "FIRST_TICK_S", 1.0)
        monkeypatch.setattr(limits, "KILL_S", 0.5)
        servo = Servo(FaultyTouch(), Failing(opens="late", simulated=False), AT_ONCE)
        with pytest.raises(DeviceError, match="has not answered for 1 s"):
            servo.__enter__()
        assert not caplog.messages, "no force was sent"
        with pytest.raises(ProcessLookupError):
            os.kill(servo.process_id, 0)
        assert not servo.running
        assert not left_behind()

    def test_process_that_cannot_be_started_is_an_error(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(supervisor, "command", lambda _: ["/no/such/python"])
        with pytest.raises(DeviceError, match="no process can be started"), Servo(proxy(), Circling()):
            pytest.fail("it was begun")
        assert not left_behind()


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
    """A loop without ticks has 0.14 s; then its process lets the device go."""

    def feel(self, record: Path, law: Touch, fault: Any = "none", opens: Any = "always") -> Servo:
        return Servo(law, Failing(fault=fault, record=str(record), simulated=False, opens=opens), AT_ONCE)

    @pytest.mark.parametrize(
        ("law", "fault", "opens"),
        [
            (FaultyTouch("blocks"), "none", "once"),  # its own process lets the device go: opening it takes long
            (FaultyTouch("holds Python"), "none", "always"),  # the loop's own watchdog does not run then
            (FaultyTouch(), "blocks", "always"),
            (proxy(), "blocks", "always"),
        ],
    )
    def test_law_or_device_that_blocks_is_killed(self, tmp_path: Path, law: Touch, fault: str, opens: str) -> None:
        record = tmp_path / "force"
        with self.feel(record, law, fault, opens) as servo:
            until(lambda: not servo.running)
            assert servo.report().stopped == watchdog.STOOD_STILL
            assert servo.device_lost
            assert servo.report().peak_force_n > 0
            assert (held_force(record), servo.report().ticks) == (0, 99)

    @pytest.mark.parametrize(
        ("first_s", "then_s", "law", "limit_s"),
        [
            (0.5, None, FaultyTouch(), 0.5),  # the loop's process is stopped: the host kills it
            (0.2, 0.5, FaultyTouch(), 0.5),
            (0.2, 0.5, FaultyTouch("blocks", 3000), 0.35),  # its own watchdog ends it
        ],
    )
    def test_force_is_zero_within_the_time_out_of_the_scene(
        self,
        tmp_path: Path,
        caplog: pytest.LogCaptureFixture,
        first_s: float,
        then_s: float | None,
        law,
        limit_s: float,
    ) -> None:
        record = tmp_path / "force"
        device = Failing(fault="none", record=str(record), simulated=False)
        with Servo(law if then_s is None else FaultyTouch(), device, limited(first_s)) as servo:
            if then_s is not None:
                servo.swap(law, limited(then_s))
            until(lambda: held_force(record) > 0)
            if limit_s == 0.5:
                os.kill(servo.process_id, signal.SIGSTOP)
            until(lambda: not servo.running)
            last_s = time.time() - (now_ns() - servo.ring.header[PREVIOUS_NS]) / 1e9
            killed = [line.created for line in caplog.records if "is killed" in line.message]
            still_s = min([*killed, time.time()]) - last_s  # a killed process may take long to be gone
            assert servo.report().stopped == watchdog.STOOD_STILL
            assert held_force(record) == 0
        assert limit_s - 0.05 <= still_s < limit_s + MAX_AFTER_S

    @pytest.mark.usefixtures("loop_in_thread")
    def test_law_that_compiles_on_first_use_is_not_a_standstill(self) -> None:
        with Servo(FaultyTouch("begins slowly"), Failing(fault="none"), AT_ONCE, seconds=0.2) as servo:
            until(lambda: not servo.running)
            assert servo.report().stopped == "the time is over"
            assert servo.report().overruns < 400

    @pytest.mark.whole
    def test_device_that_cannot_be_reopened_is_logged(
        self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture
    ) -> None:
        monkeypatch.setattr(limits, "KILL_S", 0.5)
        record = tmp_path / "force"
        with self.feel(record, FaultyTouch(), opens="once") as servo:
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
        until(lambda: held_force(record) == 0 and not path.exists())

    @pytest.mark.parametrize(
        ("name", "stopped"),
        [
            ("SIGKILL", "died"),
            ("SIGTERM", "the process received a signal to end"),
            ("SIGHUP", "the process received a signal to end"),
            pytest.param("SIGQUIT", "the process received a signal to end", marks=pytest.mark.whole),
            ("SIGTSTP", "paused from the keyboard"),
        ],
    )
    def test_signal_to_the_loop_leaves_no_force(self, tmp_path: Path, name: str, stopped: str) -> None:
        """Whether it cleans up, or is killed and the host opens the device once more to release it."""
        record, number = tmp_path / "force", getattr(signal, name)
        catchable = name != "SIGKILL"
        with (
            handle_signal(number, signal.SIG_DFL) if catchable else nullcontext(),
            self.feel(record, FaultyTouch()) as servo,
        ):
            until(lambda: held_force(record) > 0)
            os.kill(servo.process_id, number)
            until(lambda: not servo.running)
            assert stopped in servo.report().stopped
            assert held_force(record) == 0

    def test_signal_ignored_by_the_program_does_not_end_the_loop(self, tmp_path: Path) -> None:
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


@pytest.mark.usefixtures("loop_in_thread")
class TestStaleDriver:
    """A driver in Python that hangs and repeats its state pushes a hand that is elsewhere by then."""

    @pytest.mark.parametrize(
        ("law", "fault"),
        [
            (FaultyTouch(), "repeats"),
            *((proxy(), each) for each in ("repeats", "alternates", "time goes back", "time is NaN")),
            (proxy(), "time is infinite"),
        ],
    )
    def test_state_that_does_not_become_newer_ends_the_force_after_stale_s(self, law: Touch, fault: Any) -> None:
        safety = Safety(ramp_s=0, max_step_n=10, stale_s=0.05)
        with Servo(law, Failing(fault=fault, simulated=False), safety, seconds=0.4) as servo:
            until(lambda: not servo.running)
            ticks, flagged = servo.ring.since(0)[0], servo.report().flagged
        time_s, force_n = ticks[:, 0], np.linalg.norm(ticks[:, 11:14], axis=1)
        newest_s = time_s[98]  # of the last read before the fault
        assert (force_n[5:99] > 0).all()
        late = time_s > newest_s + safety.stale_s
        assert late.any()
        assert (force_n[late] == 0).all()
        assert flagged["STALE"] == np.count_nonzero(late)


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
    @pytest.mark.parametrize(
        ("law", "fault", "name"),
        [
            (FaultyTouch("exits"), "none", r"faulty_touch called sys\.exit\(3\)"),
            (FaultyTouch(), "exits", r"loop_devices called sys\.exit\(3\)"),
            (FaultyTouch("odd error"), "none", "OddError: a fault in the law"),  # it cannot be unpickled
        ],
    )
    def test_error_or_sys_exit_of_plugin_is_raised_by_its_name(self, tmp_path: Path, law, fault, name: str) -> None:
        record = tmp_path / "force"
        with (
            pytest.raises(BrokenMethod, match=name),
            Servo(law, Failing(fault=fault, record=str(record)), AT_ONCE) as servo,
        ):
            until(lambda: not servo.running)
        assert held_force(record) == 0

    def test_message_that_cannot_be_read_ends_the_loop(self, monkeypatch: pytest.MonkeyPatch) -> None:
        def deaf(_: object) -> object:
            raise EOFError("half a message")

        monkeypatch.setattr(supervisor, "receive", deaf)
        servo = Servo(proxy(), Circling())
        with pytest.raises(EOFError, match="half a message"), servo:
            pytest.fail("it was begun")
        assert servo._loop.child.poll() is not None
