"""A kiosk: scenes in rotation on one device, for as long as an exhibition; the device may be unplugged and return."""

import math
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from threading import Event
from typing import NamedTuple, final

import numpy as np

from ...data import TICK_COLUMNS, HapticSurface, ServoReport, TickFlag
from ...errors import DeviceError, check_positive
from ...plugins.interfaces import Film, HapticDevice, Touch
from ...runtime.stopping import stop_asked, stoppable
from ...runtime.system.timers import now_ns
from ...servo import OVER, Beacon, Safety, Servo
from ...servo.beacon import BUTTON
from ...servo.reports import LoopTotals, brief_report, report
from ..film import Player, Reliefs
from ..live import LOOK_EVERY_S, ignore, watch_loop
from ..parts_felt import with_part
from ..recording import INTERRUPTED, STOPPED
from ..recording.tick_arrays import ARRAYS

FIRST_PAUSE_S, LONGEST_PAUSE_S = 1.0, 8.0
"""First and longest pause between two searches for a device; each is twice as long, as a search starts a process."""
PERIOD_S = 0.001
"""Period of a loop, after which the last tick of a lost device is recorded."""
SHORTEST_S = 0.1
"""Shortest remaining time for which a device is opened."""


class Slot(NamedTuple):
    """A scene of the rotation, and the limits of its forces."""

    touch: Touch | Film
    limits: Safety
    parts: HapticSurface | None = None
    """The surface with the names of parts and materials for reports; None for none."""
    beacon: Beacon | None = None
    """A beacon to a part of this scene, on in each of its turns until a button has released a beacon."""
    reliefs: Callable[[], Reliefs] | None = None
    """A function that makes the reliefs of a touch that is a film; called for each turn."""


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
        return _Kiosk(slots, device, seconds, each_s, on_report, keep, on_start, on_wait, threads).run()


@final
class _Kiosk:
    """The state of a kiosk session: its loops one after the other, each with a newly opened device."""

    def __init__(
        self,
        slots: Sequence[Slot],
        device: HapticDevice,
        seconds: float | None,
        each_s: float,
        on_report: Callable[[ServoReport], None] | None,
        keep: Callable[[np.ndarray], None] | None,
        on_start: Callable[[Servo], None] | None,
        on_wait: Callable[[str], None] | None,
        threads: int | None = None,
    ) -> None:
        self._slots, self._device, self._seconds, self._each_s = slots, device, seconds, each_s
        self._on_report, self._keep_rows, self._on_start = on_report or ignore, keep or ignore, on_start or ignore
        self._on_wait, self._threads = on_wait, threads
        self._at, self._due_s = 0, math.inf
        """Index of the current slot, and the time of its end."""
        self._swapping: Future[None] | None = None
        self._first_ns = 0
        """Time at which the first tick of the session was due; 0 before it."""
        self._since_s = 0.0
        """Time from then to the first tick of the current loop."""
        self._before: LoopTotals | None = None
        self._last = brief_report(np.empty((0, len(TICK_COLUMNS))), 0, 0.0, 0.0, "")
        self._row: np.ndarray | None = None
        self._wait_reason, self._pause_s = "", FIRST_PAUSE_S
        self._player: Player | None = None
        self._released = False
        """True once a button has released a beacon: then no beacon follows."""

    def run(self) -> ServoReport:
        """Run until the session ends for another reason than its device."""
        ended = ""
        while not ended:
            try:
                if (lost := self._run_loop()) is None:
                    return self._last
                ended = self._wait(lost)
            except KeyboardInterrupt:
                if not self._first_ns:
                    raise
                ended = INTERRUPTED
        self._last = replace(self._last, stopped=ended)
        self._on_report(self._last)
        return self._last

    def _run_loop(self) -> str | None:
        """Run one loop; if its device ended it, return why the session waits for the device."""
        slot = self._slots[self._at]
        servo = Servo(slot.touch, self._device, slot.limits, self._left_s())
        with ThreadPoolExecutor(1) as background:
            look = partial(self._look, servo, background)
            try:
                watch_loop(servo, partial(self._report, servo), self._keep, self._note_start, look)
            except DeviceError as error:
                if self._on_wait is None or not servo.device_lost:
                    raise
                return str(error)
            finally:
                self._stop_film()
        if self._on_wait is None or not servo.device_lost:
            return None
        self._close_loop(servo)
        return self._last.stopped

    def _note_start(self, servo: Servo) -> None:
        began_ns = servo.ring.start_ns
        if self._wait_reason and self._on_wait is not None:
            self._on_wait("the device is back; the session goes on")
        self._wait_reason, self._pause_s = "", FIRST_PAUSE_S
        self._first_ns = self._first_ns or began_ns
        self._since_s = (began_ns - self._first_ns) / 1e9
        self._due_s = time.monotonic() + self._each_s
        self._pull(servo)
        self._play(servo)
        self._on_start(servo)

    def _look(self, servo: Servo, background: ThreadPoolExecutor) -> str:
        """Swap in the next scene when it is time, in the background, while ticks are recorded and reported.

        Returns: OVER at the end of the time, in loops after the first, which counts its own ticks; else "".
        """
        if self._player is not None:
            self._player.check()
        if self._swapping is not None and self._swapping.done():
            swapped, self._swapping = self._swapping, None
            if servo.running:  # else it fails for what ended the loop
                swapped.result()
                self._at, self._due_s = self._next, time.monotonic() + self._each_s
                self._pull(servo)
                self._play(servo)
        elif self._swapping is None and len(self._slots) > 1 and time.monotonic() >= self._due_s:
            self._check_release(servo)
            self._stop_film()
            self._swapping = background.submit(servo.swap, *self._slots[self._next][:2])
        return self._end_reason() if self._since_s else ""

    def _play(self, servo: Servo) -> None:
        """Play the film of this scene, if it has one, from its first frame."""
        self._player, reliefs, film = None, self._slots[self._at].reliefs, servo.film
        if reliefs is not None and film is not None:
            self._player = Player(reliefs(), film, self._threads)
            self._player.start()

    def _stop_film(self) -> None:
        """Stop the film; the surface stays as the last frame left it."""
        if self._player is not None:
            self._player.stop()
            self._player.check()

    def _pull(self, servo: Servo) -> None:
        """Pull to the beacon of this scene, unless a button has released a beacon before."""
        self._check_release(servo)
        if not self._released:
            servo.pull_to(self._slots[self._at].beacon)

    def _check_release(self, servo: Servo) -> None:
        self._released = self._released or servo.ring.beacon.state.why == BUTTON

    @property
    def _next(self) -> int:
        return (self._at + 1) % len(self._slots)

    def _report(self, servo: Servo, of_loop: ServoReport) -> None:
        whole = report(servo.ring, of_loop.stopped, self._before, self._since_s)
        film = self._player.counts if self._player is not None else None
        self._last = replace(with_part(whole, self._slots[self._at].parts), film=film)
        self._on_report(self._last)

    def _keep(self, rows: np.ndarray) -> None:
        rows[:, ARRAYS["time_s"]] += self._since_s
        self._row = rows[-1].copy()
        self._keep_rows(rows)

    def _close_loop(self, servo: Servo) -> None:
        """Add the totals of a lost loop to the session, and record a tick without force."""
        self._check_release(servo)
        totals = LoopTotals.of(servo.ring)
        self._before = totals if self._before is None else self._before.plus(totals)
        if self._row is not None:
            self._row[ARRAYS["time_s"]] += PERIOD_S
            self._row[ARRAYS["force_n"]], self._row[ARRAYS["flags"]] = 0.0, float(TickFlag.STALE)
            self._keep_rows(self._row[None])
            self._row = None

    def _wait(self, why: str) -> str:
        """Wait until the next search for the device; return why the session ends, if it does."""
        assert self._on_wait is not None
        self._swapping = None
        if why != self._wait_reason:
            self._wait_reason = why
            self._on_wait(f"no force; waiting for the device: {why}")
        until_s = time.monotonic() + self._pause_s
        self._pause_s = min(2 * self._pause_s, LONGEST_PAUSE_S)
        while not (ended := self._end_reason()) and time.monotonic() < until_s:
            time.sleep(LOOK_EVERY_S)
        return ended

    def _end_reason(self) -> str:
        if stop_asked():
            return STOPPED
        left_s = self._left_s()
        return OVER if self._first_ns and left_s is not None and left_s <= SHORTEST_S else ""

    def _left_s(self) -> float | None:
        """Return the remaining time of the session; None if it has no end."""
        if self._seconds is None or not self._first_ns:
            return self._seconds
        return self._seconds - (now_ns() - self._first_ns) / 1e9
