"""The loop that joins a touch and a device, in the device's own time."""

import logging
import math
from array import array
from collections.abc import Callable
from typing import final

import numpy as np

from ..data import NO_FORCE, TICK_COLUMNS, Force, HapticState, ServoReport, TickFlag
from ..errors import ConfigError, DeviceError, OutputError
from ..interfaces import HapticDevice, Link, Touch
from .recording import INTERRUPTED, Recording
from .replay import proxy_of
from .writer import Writer

log = logging.getLogger(__name__)
MOST_TICKS = 3_600_000
"""Where a recording in memory is full, and the loop stops and says so: an hour at 1 kHz, half a gigabyte."""
REPORT_EVERY_S = 0.1
TOUCHING, LIMITED, NOT_FINITE = map(int, (TickFlag.TOUCHING, TickFlag.FORCE_LIMITED, TickFlag.NOT_FINITE))


def run(
    touch: Touch,
    device: HapticDevice,
    seconds: float,
    on_report: Callable[[ServoReport], None] | None = None,
    writer: Writer | None = None,
) -> Recording:
    """Feel for a while: read, force, write, until the device's clock has gone on by so many seconds.

    No force over the device's maximum and none that is not finite reaches it. `on_report` is called ten times a
    second of the device's time, and at the end. Ctrl-C, a device that stops answering or whose clock stands still, and
    a full recording (`MOST_TICKS`) end it early: the force is zero, what was felt so far is returned, and
    `Recording.stopped` says why.

    With a writer the ticks go to its file as often as reports come, and not into memory; it is closed at the end, and
    what is returned is what its file holds. Where it cannot write any more, the loop says so and goes on.
    Raises: ConfigError if seconds is not above 0 and finite, DeviceError if the device cannot be opened, and whatever
    a faulty touch or `on_report` raises, after the force was made zero.
    """
    if not 0 < seconds < math.inf:
        raise ConfigError(f"seconds: is {seconds}; a session takes more than 0 seconds, and an end")
    tape = _Tape(touch, device.spec().max_force_n, on_report or _ignore, writer)
    link = device.open()
    try:
        with link:
            _feel(touch, link, seconds, tape)
    except DeviceError as error:  # also when the device is gone before its force could be made zero
        tape.stopped = tape.stopped or str(error)
    if tape.stopped:
        log.log(
            logging.INFO if tape.stopped == INTERRUPTED else logging.WARNING,
            "stopped after %d ticks: %s",
            tape.ticks,
            tape.stopped,
        )
    tape.report(tape.stopped or "the time is over")
    recording = tape.recording()
    if recording.not_finite:
        log.warning("%d forces were not finite and were made zero: the renderer is at fault", recording.not_finite)
    return recording


def limited(force: Force, most_n: float) -> Force:
    """The force, scaled down to a magnitude of most_n where it is over it; zero where it is not finite.

    >>> limited(Force(6.0, 0.0, 8.0), 5.0)
    Force(x=3.0, y=0.0, z=4.0)
    """
    if math.hypot(*force) <= most_n:
        return force
    if not all(map(math.isfinite, force)):
        return NO_FORCE
    greatest = max(map(abs, force))  # divided by first, so that the magnitude cannot overflow
    x, y, z = (part / greatest for part in force)
    scale = most_n / math.hypot(x, y, z)
    return Force(x * scale, y * scale, z * scale)


def _feel(touch: Touch, link: Link, seconds: float, tape: "_Tape") -> None:
    """Tick until the time is over; a cause to end early is left in tape.stopped."""
    try:
        state = link.read()
        start_s = state.time_s
        while not tape.stopped:
            link.write(tape.allowed(touch.force(state)))
            tape.add(state, link.applied)
            last_s, state = state.time_s, link.read()
            if not state.time_s > last_s:
                tape.stopped = f"the device's clock stands still at {state.time_s} s"
            # ticks come at 0, T, 2 T ...: round(seconds / T) of them, whatever the rounding of their stamps
            elif state.time_s - start_s >= seconds - (state.time_s - last_s) / 2:
                return
            elif tape.held >= MOST_TICKS:
                tape.stopped = f"the recording is full, {MOST_TICKS} ticks; write it to a .nc file while it is felt"
    except KeyboardInterrupt:
        tape.stopped = INTERRUPTED
    except DeviceError as error:
        tape.stopped = str(error)


@final
class _Tape:
    """What the loop remembers: the ticks, and the sums for its reports."""

    def __init__(
        self, touch: Touch, max_force_n: float, on_report: Callable[[ServoReport], None], writer: Writer | None
    ) -> None:
        self.stopped = ""
        self.ticks = 0
        self._numbers = array("d")
        self._proxy = proxy_of(touch)
        self._max_force_n = max_force_n
        self._on_report = on_report
        self._writer = writer
        self._reports = self._flags = 0
        self._start_s = self._peak_n = self._work_j = 0.0
        self._state, self._force = HapticState((0.0, 0.0, 0.0)), NO_FORCE

    @property
    def held(self) -> int:
        """Ticks in memory."""
        return len(self._numbers) // len(TICK_COLUMNS)

    def allowed(self, force: Force) -> Force:
        """What may reach the device of a renderer's force."""
        safe = limited(force, self._max_force_n)
        self._flags = TOUCHING if any(force) else 0
        if safe is not force:
            self._flags |= LIMITED if all(map(math.isfinite, force)) else NOT_FINITE
        return safe

    def add(self, state: HapticState, force: Force) -> None:
        """One tick more, and a report when it is time."""
        if not self.ticks:
            self._start_s, self._state = state.time_s, state
        way = zip(self._force, state.position_m, self._state.position_m, strict=True)
        self._work_j += sum(held * (now - then) for held, now, then in way)
        self._peak_n = max(self._peak_n, math.hypot(*force))
        self._numbers.extend((state.time_s, 0.0, *state.position_m, *state.velocity_m_per_s))
        self._numbers.extend((*self._proxy(), *force, self._flags, state.buttons))
        self._state, self._force = state, force
        self.ticks += 1
        if state.time_s - self._start_s >= REPORT_EVERY_S * (self._reports + 1):
            self._reports += 1
            self.report("")

    def report(self, stopped: str) -> None:
        """Say how it goes, once what there is to say is safe in the file."""
        if self._writer is not None:
            self._hand_over(self._writer)
        self._on_report(
            ServoReport(
                ticks=self.ticks,
                time_s=self._state.time_s,
                state=self._state,
                force=self._force,
                peak_force_n=self._peak_n,
                work_j=self._work_j,
                stopped=stopped,
            )
        )

    def recording(self) -> Recording:
        """All of it; from the file, where there is one."""
        if self._writer is None:
            return Recording(self._rows(), self.stopped)
        self._writer.close(self.stopped)
        return Recording.load(self._writer.path)

    def _hand_over(self, writer: Writer) -> None:
        rows = self._rows()
        self._numbers = array("d")
        if not writer.closed:
            try:
                writer.append(rows)
            except OutputError as error:
                log.warning("%s; what is felt now is not recorded", error)

    def _rows(self) -> np.ndarray:
        return np.array(self._numbers, np.float64).reshape(-1, len(TICK_COLUMNS))


def _ignore(report: ServoReport) -> None:
    pass
