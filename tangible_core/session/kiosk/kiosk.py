"""A kiosk: scenes in rotation on one device, for as long as an exhibition; the device may be unplugged and return."""

import math
import time
from collections.abc import Callable, Sequence
from concurrent.futures import ThreadPoolExecutor
from dataclasses import dataclass, replace
from functools import partial
from threading import Event
from typing import final

import numpy as np

from ...data import TICK_COLUMNS, ServoReport, TickFlag
from ...errors import DeviceError, check_positive
from ...plugins.interfaces import HapticDevice
from ...runtime.stopping import stop_asked, stoppable
from ...runtime.system.service import tell_service_manager
from ...runtime.system.timers import now_ns
from ...servo import OVER, Servo
from ...servo.reports import LoopTotals, brief_report, report
from ..live import LOOK_EVERY_S, ignore, watch_loop
from ..parts_felt import with_part
from ..recording import INTERRUPTED, STOPPED
from ..recording.tick_file import ARRAYS
from .rotation import Rotation, Slot

ALIVE = "WATCHDOG=1"  # the message to systemd by which a program says that it does not hang
# First and longest pause between two searches for a device; each is twice as long, as a search starts a process.
FIRST_PAUSE_S, LONGEST_PAUSE_S = 1.0, 8.0


@final
class DeviceWait:
    """The reason for which a session waits, and the pause until the next search."""

    def __init__(self, notify: Callable[[str], None]) -> None:
        """notify: called with a sentence, once for each reason and when the device is back."""
        self._notify = notify
        self._reason, self._pause_s = "", FIRST_PAUSE_S

    def end(self) -> None:
        """End the wait, if there was one: the device is open."""
        if self._reason:
            self._notify("the device is back; the session goes on")
        self._reason, self._pause_s = "", FIRST_PAUSE_S

    def pause(self, why: str, end_reason: Callable[[], str]) -> str:
        """Wait until the next search for the device; return why the session ends, if it does."""
        if why != self._reason:
            self._reason = why
            self._notify(f"no force; waiting for the device: {why}")
            tell_service_manager(f"READY=1\nSTATUS=waiting for the device: {why.partition(chr(10))[0]}")
        until_s = time.monotonic() + self._pause_s
        self._pause_s = min(2 * self._pause_s, LONGEST_PAUSE_S)
        while not (reason := end_reason()) and time.monotonic() < until_s:
            time.sleep(LOOK_EVERY_S)
            tell_service_manager(ALIVE)
        return reason


PERIOD_S = 0.001  # period of a loop, after which the last tick of a lost device is recorded


@final
class SessionTotals:
    """The totals of all loops of a session, and the time since its first tick."""

    def __init__(self, keep: Callable[[np.ndarray], None]) -> None:
        """keep: called with all ticks, their times those of the session."""
        self._keep = keep
        self._first_ns = 0
        """Time at which the first tick of the session was due; 0 before it."""
        self.since_s: float = 0.0
        """Time from then to the first tick of the current loop."""
        self._before: LoopTotals | None = None
        self._row: np.ndarray | None = None

    @property
    def begun(self) -> bool:
        """True once a loop has begun."""
        return self._first_ns > 0

    @property
    def passed_s(self) -> float:
        """Time since the first tick, with or without a device; 0 before it."""
        return (now_ns() - self._first_ns) / 1e9 if self.begun else 0.0

    def begin(self, began_ns: int) -> None:
        """Begin a loop, whose first tick was due at this time."""
        self._first_ns = self._first_ns or began_ns
        self.since_s = (began_ns - self._first_ns) / 1e9

    def report(self, servo: Servo, stopped: str) -> ServoReport:
        """Return the report of the session so far."""
        return report(servo.ring, stopped, self._before, self.since_s)

    def keep(self, rows: np.ndarray) -> None:
        """Pass on ticks of the current loop."""
        rows[:, ARRAYS["time_s"]] += self.since_s
        self._row = rows[-1].copy()
        self._keep(rows)

    def close(self, servo: Servo) -> None:
        """Add the totals of a lost loop to the session, and record a tick without force."""
        totals = LoopTotals.of(servo.ring)
        self._before = totals if self._before is None else self._before.plus(totals)
        if self._row is not None:
            self._row[ARRAYS["time_s"]] += PERIOD_S
            self._row[ARRAYS["force_n"]], self._row[ARRAYS["flags"]] = 0.0, float(TickFlag.STALE)
            self._keep(self._row[None])
            self._row = None


SHORTEST_S = 0.1  # shortest remaining time for which a device is opened


def run_kiosk(
    slots: Sequence[Slot],
    device: HapticDevice,
    seconds: float | None = None,
    each_s: float = math.inf,
    *,
    on_report: Callable[[ServoReport], None] | None = None,
    keep: Callable[[np.ndarray], None] | None = None,
    on_start: Callable[[Servo], None] | None = None,
    on_wait: Callable[[str], None] | None = None,
    stop: Event | None = None,
    threads: int | None = None,
) -> ServoReport:
    """Run scenes in rotation, each for `each_s`, as `run_in_real_time` runs one.

    The loop swaps one scene for the next, whose force fades in.

    seconds: duration of the session from its first tick on, with or without a device. on_start: called for each loop.
    on_wait: if None, the session ends with its device; otherwise the session waits for the device, without force, and
    goes on with the scene when the device is back. on_wait gets a sentence, once for each reason and when the device is
    back. Reports and ticks are of the whole session: its time goes on while it waits, and one tick, STALE and without
    force, marks where the device was lost. threads: greatest number of threads for the frames of a film. Other
    parameters, and errors raised: as `run_in_real_time`.
    """
    check_positive("each_s", min(each_s, 1.0))
    with stoppable(stop):
        rotation, totals = Rotation(slots, each_s, threads), SessionTotals(keep or ignore)
        wait = None if on_wait is None else DeviceWait(on_wait)
        return _Kiosk(rotation, totals, wait, device, seconds, on_report or ignore, on_start or ignore).run()


@final
@dataclass
class _Kiosk:
    """A kiosk session: its loops one after the other, each with a newly opened device."""

    rotation: Rotation
    totals: SessionTotals
    wait: DeviceWait | None
    device: HapticDevice
    seconds: float | None
    on_report: Callable[[ServoReport], None]
    on_start: Callable[[Servo], None]
    last: ServoReport = brief_report(np.empty((0, len(TICK_COLUMNS))), 0, 0.0, 0.0, "")  # noqa: RUF009

    def run(self) -> ServoReport:
        """Run until the session ends for another reason than its device."""
        reason = ""
        while not reason:
            try:
                device_reason = self._run_loop()
                if device_reason is None or self.wait is None:
                    return self.last
                reason = self.wait.pause(device_reason, self._end_reason)
            except KeyboardInterrupt:
                if not self.totals.begun:
                    raise
                reason = INTERRUPTED
        self.last = replace(self.last, stopped=reason)
        self.on_report(self.last)
        return self.last

    def _run_loop(self) -> str | None:
        """Run one loop; if its device ended it, return why the session waits for the device."""
        slot = self.rotation.current
        servo = Servo(slot.touch, self.device, slot.limits, self._left_s())
        with ThreadPoolExecutor(1) as background:
            look = partial(self._look, servo, background)
            try:
                watch_loop(servo, partial(self._report, servo), self.totals.keep, self._begin, look)
            except DeviceError as error:
                if self.wait is None or not servo.device_lost:
                    raise
                return str(error)
            finally:
                self.rotation.stop_film()
        if self.wait is None or not servo.device_lost:
            return None
        self.rotation.note_release(servo)
        self.totals.close(servo)
        return self.last.stopped

    def _begin(self, servo: Servo) -> None:
        if self.wait is not None:
            self.wait.end()
        self.totals.begin(servo.ring.start_ns)
        self.rotation.begin(servo)
        self.on_start(servo)

    def _look(self, servo: Servo, background: ThreadPoolExecutor) -> str:
        """Rotate the scenes; return OVER at the end of the time, in loops after the first, else ""."""
        self.rotation.look(servo, background)
        return self._end_reason() if self.totals.since_s else ""

    def _report(self, servo: Servo, of_loop: ServoReport) -> None:
        whole = with_part(self.totals.report(servo, of_loop.stopped), self.rotation.current.parts)
        self.last = replace(whole, film=self.rotation.frames)
        tell_service_manager(ALIVE)
        self.on_report(self.last)

    def _end_reason(self) -> str:
        if stop_asked():
            return STOPPED
        left_s = self._left_s()
        return OVER if self.totals.begun and left_s is not None and left_s <= SHORTEST_S else ""

    def _left_s(self) -> float | None:
        """Return the remaining time of the session; None if it has no end."""
        return None if self.seconds is None else self.seconds - self.totals.passed_s
