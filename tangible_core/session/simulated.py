"""A session in simulated time: the loop of a touch and a device, in the device's own time."""

import logging
import math
from array import array
from collections.abc import Callable
from threading import Event
from typing import final

import numpy as np

from ..compiled.touch import FRAME, motion_array
from ..data import NO_FORCE, TICK_COLUMNS, Force, HapticState, ServoReport
from ..errors import DeviceError, check_positive
from ..plugins.interfaces import Film, HapticDevice, Link, Touch, as_touch
from ..runtime.stopping import stop_asked, stoppable
from ..servo import OVER, Beacon, Safety
from ..servo.beacon import BeaconMemory
from ..servo.guard.stiffness import find_stiffness
from ..servo.reports import brief_report
from ..servo.ticks.loop import GuardedForce, guard_touch
from .live import REPORT_EVERY_S, ignore
from .recording import INTERRUPTED, STOPPED, Recording
from .recording.replay import proxy_reader

log: logging.Logger = logging.getLogger(__name__)
# Greatest number of ticks of a recording in memory, at which the loop stops: an hour at 1 kHz, half a gigabyte.
MAX_TICKS = 3_600_000
FIRST_S = 0.001


def run_simulated(
    touch: Touch | Film,
    device: HapticDevice,
    seconds: float,
    on_report: Callable[[ServoReport], None] | None = None,
    limits: Safety | None = None,
    stop: Event | None = None,
    beacon: Beacon | None = None,
    frames: Callable[[float], None] | None = None,
) -> Recording:
    """Run until the device's clock has advanced by `seconds`, and return the recording.

    beacon: pulls from the first tick on, until a button releases it (`Servo.pull_to`). frames: called before each tick
    with the device's time since the first, to show the reliefs due by then (`Film.show`).

    The guard enforces the limits. `on_report` is called ten times a second of the device's time, and at the end.
    Ctrl-C, `stop` set from another thread, a device that stops answering or whose clock stands still, and a full
    recording (`MAX_TICKS`) end the session early: the force is zero, the recording so far is returned, and
    `Recording.stopped` has the reason.
    Raises: ConfigError if seconds is not positive and finite, DeviceError if the device cannot be opened, and whatever
    a faulty touch, `on_report` or `frames` raises, once the force is zero.
    """
    check_positive("seconds", seconds)
    touch, spec = as_touch(touch), device.spec()
    settings, memory = (limits or Safety()).arrays(spec, find_stiffness(touch, spec).n_per_m)
    pull = None if beacon is None else BeaconMemory.of(beacon).arrays
    allowed_force = guard_touch(touch, settings, memory, pull)
    tape = _Tape(touch, on_report or ignore)
    link = device.open()
    try:
        with stoppable(stop), link:
            _feel(allowed_force, link, seconds, tape, frames or ignore)
    except DeviceError as error:  # also when the device is gone before its force could be made zero
        tape.end_reason = tape.end_reason or str(error)
    if tape.end_reason:
        log.log(
            logging.INFO if tape.end_reason in (INTERRUPTED, STOPPED) else logging.WARNING,
            "stopped after %d ticks: %s",
            tape.ticks,
            tape.end_reason,
        )
    tape.report(tape.end_reason or OVER)
    recording = tape.recording()
    if recording.not_finite:
        log.warning("%d forces were not finite and were set to zero: the force law is at fault", recording.not_finite)
    return recording


def _feel(
    allowed_force: GuardedForce, link: Link, seconds: float, tape: "_Tape", frames: Callable[[float], None]
) -> None:
    """Tick until the time is over; the reason for an early end is in tape.end_reason."""
    try:
        state, period_s = link.read(), FIRST_S
        start_s = state.time_s
        while not tape.end_reason:
            frames(state.time_s - start_s)
            force, flags = allowed_force(state, period_s)
            link.write(force)
            tape.add(state, link.applied, flags)
            last_s, state = state.time_s, link.read()
            period_s = state.time_s - last_s
            if not period_s > 0:
                tape.end_reason = f"the device's clock stands still at {state.time_s} s"
            # ticks come at 0, T, 2 T ...: round(seconds / T) of them, whatever the rounding of their stamps
            elif state.time_s - start_s >= seconds - period_s / 2:
                return
            elif stop_asked():
                tape.end_reason = STOPPED
            elif tape.ticks >= MAX_TICKS:
                tape.end_reason = f"the recording is full, {MAX_TICKS} ticks; use a shorter time"
    except KeyboardInterrupt:
        tape.end_reason = INTERRUPTED
    except DeviceError as error:
        tape.end_reason = str(error)


@final
class _Tape:
    """The memory of a loop: its ticks, and the sums for its reports."""

    def __init__(self, touch: Touch, on_report: Callable[[ServoReport], None]) -> None:
        self.end_reason = ""
        self.ticks = 0
        self._numbers = array("d")
        self._proxy, self._moving = proxy_reader(touch), motion_array(touch)
        self._on_report = on_report
        self._reports = 0
        self._start_s = self._peak_n = self._work_j = 0.0
        self._state, self._force = HapticState((0.0, 0.0, 0.0)), NO_FORCE

    def add(self, state: HapticState, force: Force, flags: int) -> None:
        if not self.ticks:
            self._start_s, self._state = state.time_s, state
        way = zip(self._force, state.position_m, self._state.position_m, strict=True)
        self._work_j += sum(force_n * (now - then) for force_n, now, then in way)
        self._peak_n = max(self._peak_n, math.hypot(*force))
        motion = *state.position_m, *state.velocity_m_per_s
        row = state.time_s, 0.0, *motion, *self._proxy(), *force, flags, state.buttons, self._moving[FRAME]
        self._numbers.extend(row)  # all at once: Ctrl-C leaves whole rows
        self._state, self._force = state, force
        self.ticks += 1
        if state.time_s - self._start_s >= REPORT_EVERY_S * (self._reports + 1):
            self._reports += 1
            self.report("")

    def report(self, stopped: str) -> None:
        last = np.array(self._numbers[-len(TICK_COLUMNS) :]).reshape(-1, len(TICK_COLUMNS))
        self._on_report(brief_report(last, self.ticks, self._peak_n, self._work_j, stopped))

    def recording(self) -> Recording:
        return Recording(np.array(self._numbers, np.float64).reshape(-1, len(TICK_COLUMNS)), self.end_reason)
