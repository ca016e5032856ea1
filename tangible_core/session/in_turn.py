"""Scenes that are felt in turn on one device, for as long as an exhibition: a device that goes may come back."""

import math
import time
from collections.abc import Callable, Sequence
from concurrent.futures import Future, ThreadPoolExecutor
from dataclasses import replace
from functools import partial
from threading import Event
from typing import NamedTuple, final

import numpy as np

from ..data import TICK_COLUMNS, HapticSurface, ServoReport, TickFlag
from ..errors import DeviceError, check_positive
from ..plugins.interfaces import Film, HapticDevice, Touch
from ..runtime.stopping import stop_asked, stoppable
from ..servo import OVER, Beacon, Safety, Servo
from ..servo.beacon import BUTTON
from ..servo.reports import LoopTotals, brief_report, report
from .film import Player, Reliefs
from .live import LOOK_EVERY_S, attended, ignored
from .parts_felt import with_part
from .recording import INTERRUPTED, STOPPED
from .tick_arrays import ARRAYS

FIRST_PAUSE_S, LONGEST_PAUSE_S = 1.0, 8.0
"""Before a device is looked for again; twice as long each time: to look for one starts a process."""
PERIOD_S = 0.001
SHORTEST_S = 0.1
"""No device is opened for less."""


class Turn(NamedTuple):
    """A scene, and what no force on it may do."""

    touch: Touch | Film
    limits: Safety
    parts: HapticSurface | None = None
    """The surface whose parts and materials reports tell; None for none."""
    beacon: Beacon | None = None
    """Pulls to a part of this scene whenever it is felt, until a button has released one."""
    reliefs: Callable[[], Reliefs] | None = None
    """Makes what is shown while it is felt, of a touch that is a film; anew for each turn."""


def run_in_turn(
    turns: Sequence[Turn],
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
    """Feel scenes in turn, each for so long, the first again after the last, as `run_in_real_time` feels one.

    The loop goes on from one to the next, whose force fades in. on_wait: without it, the session ends with its device;
    with it, the device is waited for, no force being left, and the scene is felt on when it is there. It is told so in
    words, once for each reason and when the device is back. Reports and ticks are then of the whole session: time goes
    on meanwhile, and one tick, STALE and without force, says where the device went. seconds: counted from the first
    tick on, device or not. on_start: called for each loop. threads: the most that work on the frames of a film at once.
    Raises: as `run_in_real_time`.
    """
    check_positive("each_s", min(each_s, 1.0))
    with stoppable(stop):
        return _Session(turns, device, seconds, each_s, on_report, keep, on_start, on_wait, threads).run()


@final
class _Session:
    """Loops that follow each other, one a device that is opened, and what they have in common."""

    def __init__(
        self,
        turns: Sequence[Turn],
        device: HapticDevice,
        seconds: float | None,
        each_s: float,
        on_report: Callable[[ServoReport], None] | None,
        keep: Callable[[np.ndarray], None] | None,
        on_start: Callable[[Servo], None] | None,
        on_wait: Callable[[str], None] | None,
        threads: int | None = None,
    ) -> None:
        self._turns, self._device, self._seconds, self._each_s = turns, device, seconds, each_s
        self._hear, self._keep_rows, self._begin = on_report or ignored, keep or ignored, on_start or ignored
        self._on_wait, self._threads = on_wait, threads
        self._at, self._due_s = 0, math.inf
        self._swapping: Future[None] | None = None
        self._first_ns = 0
        """When the first tick of all was due; 0 before there was one."""
        self._since_s = 0.0
        """From then until the first tick of the loop that runs."""
        self._before: LoopTotals | None = None
        self._last = brief_report(np.empty((0, len(TICK_COLUMNS))), 0, 0.0, 0.0, "")
        self._row: np.ndarray | None = None
        self._told, self._pause_s = "", FIRST_PAUSE_S
        self._player: Player | None = None
        self._released = False
        """Whether a button has released a beacon: nobody asks for another one."""

    def run(self) -> ServoReport:
        """Until something ends it that is not the device."""
        ended = ""
        while not ended:
            try:
                if (lost := self._feel()) is None:
                    return self._last
                ended = self._wait(lost)
            except KeyboardInterrupt:
                if not self._first_ns:
                    raise
                ended = INTERRUPTED
        self._last = replace(self._last, stopped=ended)
        self._hear(self._last)
        return self._last

    def _feel(self) -> str | None:
        """One loop; why its device is to be waited for, if that ended it."""
        turn = self._turns[self._at]
        servo = Servo(turn.touch, self._device, turn.limits, self._left_s())
        with ThreadPoolExecutor(1) as aside:
            look = partial(self._look, servo, aside)
            try:
                attended(servo, partial(self._tell, servo), self._keep, self._started, look)
            except DeviceError as error:
                if self._on_wait is None or not servo.device_lost:
                    raise
                return str(error)
            finally:
                self._stand()
        if self._on_wait is None or not servo.device_lost:
            return None
        self._let_go(servo)
        return self._last.stopped

    def _started(self, servo: Servo) -> None:
        began_ns = servo.ring.start_ns
        if self._told and self._on_wait is not None:
            self._on_wait("the device is there; the surface is felt")
        self._told, self._pause_s = "", FIRST_PAUSE_S
        self._first_ns = self._first_ns or began_ns
        self._since_s = (began_ns - self._first_ns) / 1e9
        self._due_s = time.monotonic() + self._each_s
        self._pull(servo)
        self._play(servo)
        self._begin(servo)

    def _look(self, servo: Servo, aside: ThreadPoolExecutor) -> str:
        """Go on to the next scene when it is time: it is sent beside what is kept and told meanwhile.

        Returns: that the time is over, where a loop began late; the first one counts its ticks.
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
        elif self._swapping is None and len(self._turns) > 1 and time.monotonic() >= self._due_s:
            self._look_at_beacon(servo)
            self._stand()
            self._swapping = aside.submit(servo.swap, *self._turns[self._next][:2])
        return self._ended() if self._since_s else ""

    def _play(self, servo: Servo) -> None:
        """The film of this scene, from its first frame."""
        self._player, reliefs, film = None, self._turns[self._at].reliefs, servo.film
        if reliefs is not None and film is not None:
            self._player = Player(reliefs(), film, self._threads)
            self._player.start()

    def _stand(self) -> None:
        """Nothing more is shown; what is felt is what was shown last."""
        if self._player is not None:
            self._player.stop()
            self._player.check()

    def _pull(self, servo: Servo) -> None:
        """To the part that this scene has a beacon to; not after a button has released one."""
        self._look_at_beacon(servo)
        if not self._released:
            servo.pull_to(self._turns[self._at].beacon)

    def _look_at_beacon(self, servo: Servo) -> None:
        self._released = self._released or servo.ring.beacon.state.why == BUTTON

    @property
    def _next(self) -> int:
        return (self._at + 1) % len(self._turns)

    def _tell(self, servo: Servo, found: ServoReport) -> None:
        found = report(servo.ring, found.stopped, self._before, self._since_s)
        film = self._player.felt if self._player is not None else None
        self._last = replace(with_part(found, self._turns[self._at].parts), film=film)
        self._hear(self._last)

    def _keep(self, rows: np.ndarray) -> None:
        rows[:, ARRAYS["time_s"]] += self._since_s
        self._row = rows[-1].copy()
        self._keep_rows(rows)

    def _let_go(self, servo: Servo) -> None:
        """What this loop counted is kept, and the recording says that no force is left."""
        self._look_at_beacon(servo)
        counted = LoopTotals.of(servo.ring)
        self._before = counted if self._before is None else self._before.plus(counted)
        if self._row is not None:
            self._row[ARRAYS["time_s"]] += PERIOD_S
            self._row[ARRAYS["force_n"]], self._row[ARRAYS["flags"]] = 0.0, float(TickFlag.STALE)
            self._keep_rows(self._row[None])
            self._row = None

    def _wait(self, why: str) -> str:
        """Until the device is to be looked for again; why that is not to be, if it is not."""
        assert self._on_wait is not None
        self._swapping = None
        if why != self._told:
            self._told = why
            self._on_wait(f"no force; waiting for the device: {why}")
        until_s = time.monotonic() + self._pause_s
        self._pause_s = min(2 * self._pause_s, LONGEST_PAUSE_S)
        while not (ended := self._ended()) and time.monotonic() < until_s:
            time.sleep(LOOK_EVERY_S)
        return ended

    def _ended(self) -> str:
        if stop_asked():
            return STOPPED
        left_s = self._left_s()
        return OVER if self._first_ns and left_s is not None and left_s <= SHORTEST_S else ""

    def _left_s(self) -> float | None:
        """Of the session's time; none if that has no end."""
        if self._seconds is None or not self._first_ns:
            return self._seconds
        return self._seconds - (time.monotonic_ns() - self._first_ns) / 1e9
