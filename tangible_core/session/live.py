"""A session in real time: the force loop in its own process, watched and recorded from this one."""

import logging
import time
from collections.abc import Callable, Generator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from threading import Event
from typing import Any, final

import numpy as np

from ..data import UNTOUCHED, ServoReport, TickFlag
from ..plugins.interfaces import Film, HapticDevice, Touch
from ..runtime.stopping import stop_asked, stoppable
from ..servo import Beacon, Safety, Servo
from .recording import INTERRUPTED, STOPPED, Recording
from .recording.tick_file import About, Writer

log: logging.Logger = logging.getLogger(__name__)
# Interval at which ticks are taken from the loop's ring, and so the most that a crash can lose of a recording.
LOOK_EVERY_S = 0.05
REPORT_EVERY_S = 0.1


@final
class RingDrain:
    """A drain that passes each tick of a loop to `keep` once, in tables of `data.TICK_COLUMNS`, as for a `Writer`.

    The owner of the loop calls `look` at least every few seconds, as a ring holds eight seconds, and once more after
    the loop has ended. Swapped scenes make no difference. Use it for one loop and from one thread at a time, preferably
    a thread that Ctrl-C cannot interrupt, as otherwise it is unknown which ticks were passed on.
    """

    def __init__(self, servo: Servo, keep: Callable[[np.ndarray], None], first: int = 0) -> None:
        """Begin with the tick of number `first`, such as `servo.ring.count` for all ticks from now on."""
        self._servo, self._keep = servo, keep
        self._next = first

    def look(self) -> None:
        """Pass on the ticks since the last call; logs how many were overwritten before, and so are lost.

        Raises: whatever `keep` raises, such as OutputError on a full disk; the loop goes on, and the next call passes
        these ticks on again.
        """
        rows, following = self._servo.ring.since(self._next)
        if lost_ticks := following - self._next - len(rows):
            log.warning("%d ticks were overwritten before they could be recorded; the machine is too busy", lost_ticks)
        if len(rows):
            self._keep(rows)
        self._next = following


def run_in_real_time(
    touch: Touch | Film,
    device: HapticDevice,
    seconds: float | None = None,
    limits: Safety | None = None,
    on_report: Callable[[ServoReport], None] | None = None,
    keep: Callable[[np.ndarray], None] | None = None,
    on_start: Callable[[Servo], None] | None = None,
    stop: Event | None = None,
    beacon: Beacon | None = None,
) -> ServoReport:
    """Run in real time, until the end of the time, Ctrl-C, `stop` or the end of the `Servo`; then no force is left.

    on_report: called ten times a second, and at the end. keep: called with all ticks, as rows of `data.TICK_COLUMNS`,
    in its own thread. on_start: called once the loop runs. An error of these, such as a full disk, ends the session.
    stop: set from another thread, it ends the session within a tenth of a second. beacon: pulls from the start, until a
    button releases it (`Servo.pull_to`).
    Raises: ConfigError if seconds is not positive and finite, DeviceError if the device cannot be opened, and whatever
    a plugin raises.
    """
    with stoppable(stop):
        servo = Servo(touch, device, limits, seconds)

        def start(servo: Servo) -> None:
            servo.pull_to(beacon)
            (on_start or ignore)(servo)

        return watch_loop(servo, on_report or ignore, keep or ignore, start)


def watch_loop(
    servo: Servo,
    on_report: Callable[[ServoReport], None],
    keep: Callable[[np.ndarray], None],
    on_start: Callable[[Servo], None],
    look: Callable[[], str] = str,
) -> ServoReport:
    """Start a loop, record and report it until something ends it, or `look` says why it must end; leave no force."""
    with ThreadPoolExecutor(1) as background, servo:  # in this order, the force ends first
        on_start(servo)
        drain, next_s, reason = RingDrain(servo, keep), time.monotonic(), ""
        try:
            while servo.running and not reason:
                time.sleep(LOOK_EVERY_S)
                background.submit(drain.look).result()
                if time.monotonic() >= next_s:
                    next_s += REPORT_EVERY_S
                    on_report(servo.report())
                reason = STOPPED if stop_asked() else look()
            last = servo.stop(reason)
        except KeyboardInterrupt:
            last = servo.stop(INTERRUPTED)
        background.submit(drain.look).result()
        on_report(last)
    return last


def ignore(_: Any) -> None:
    """Do nothing, where no function was given."""


@contextmanager
def keeping(path: Path, about: About) -> Generator[Writer]:
    """Open a writer to a recording of any suffix; one other than .nc is converted from a .nc file at the end."""
    growing = path if path.suffix == ".nc" else path.with_name(f"{path.name}.nc")
    with Writer(growing, about) as writer:
        yield writer
    if growing != path:
        Recording.load(growing).save(path)
        growing.unlink()


def figures(report: ServoReport) -> dict[str, float]:
    """Return the figures of a loop, by name."""
    times = {"period": report.period_us, "late": report.late_us}
    film = {} if report.film is None else report.film._asdict()
    return {
        "ticks": report.ticks,
        "seconds": report.time_s,
        "contact_share": report.contact_share or 0.0,
        "median_contact_force_n": report.median_contact_force_n or 0.0,
        "peak_force_n": report.peak_force_n,
        "work_j": report.work_j,
        **{
            f"{name}_{quantile.replace('most', 'max')}_us": value
            for name, spread in times.items()
            if spread
            for quantile, value in spread._asdict().items()
        },
        "overruns": report.overruns,
        **{name.lower(): report.flagged.get(name, 0) for name in LIMITS},
        **{f"frames_{name}": value for name, value in film.items() if value is not None},
    }


LIMITS = [flag.name or "" for flag in TickFlag if not flag & UNTOUCHED]
