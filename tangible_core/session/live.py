"""A session in real time: the force loop in its own process, watched and recorded from here."""

import logging
import time
from collections.abc import Callable, Generator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from typing import final

import numpy as np

from ..data import UNTOUCHED, ServoReport, TickFlag
from ..plugins.interfaces import HapticDevice, Touch
from ..servo import Safety, Servo
from .recording import INTERRUPTED, Recording
from .tick_file import About
from .writer import Writer

log = logging.getLogger(__name__)
LOOK_EVERY_S = 0.05
"""How often what was felt is taken from the loop's ring: what a crash of this process can lose of a recording."""
REPORT_EVERY_S = 0.1


def feel(
    touch: Touch,
    device: HapticDevice,
    seconds: float | None,
    limits: Safety,
    on_report: Callable[[ServoReport], None],
    keep: Callable[[np.ndarray], None],
    on_start: Callable[[Servo], None] = lambda _: None,
) -> ServoReport:
    """Feel in real time, until the seconds are over, Ctrl-C, or what else ends a `Servo`; then the force is zero.

    on_report: called ten times a second, and at the end. keep: given all ticks, as rows of `data.TICK_COLUMNS`, in a
    thread of its own. What these raise ends the session, such as a full disk.
    Raises: ConfigError if seconds is not positive and finite, DeviceError if the device cannot be opened, and what a
    plugin raises.
    """
    with ThreadPoolExecutor(1) as aside, Servo(touch, device, limits, seconds) as servo:  # the force goes first
        on_start(servo)
        keeper, next_s = _Keeper(servo, keep), time.monotonic()
        try:
            while servo.running:
                time.sleep(LOOK_EVERY_S)
                aside.submit(keeper.look).result()
                if time.monotonic() >= next_s:
                    next_s += REPORT_EVERY_S
                    on_report(servo.report())
            last = servo.stop()
        except KeyboardInterrupt:
            last = servo.stop(INTERRUPTED)
        aside.submit(keeper.look).result()
        on_report(last)
    return last


@final
class _Keeper:
    """Hands on each tick once. A look is made in a thread of its own, where no Ctrl-C ends it half done: nobody would
    know which ticks are kept."""

    def __init__(self, servo: Servo, keep: Callable[[np.ndarray], None]) -> None:
        self._servo, self._keep = servo, keep
        self._next = 0

    def look(self) -> None:
        """Hand on what came since the last look."""
        rows, following = self._servo.ring.since(self._next)
        if lost := following - self._next - len(rows):
            log.warning("%d ticks were overwritten before they could be recorded; the machine is too busy", lost)
        if len(rows):
            self._keep(rows)
        self._next = following


@contextmanager
def keeping(path: Path, about: About) -> Generator[Writer]:
    """A writer to a file of any of the recordings' suffixes.

    What it appends is safe at once, in a .nc file; where another suffix was asked for, that file is made of it at the
    end, and goes. Raises: OutputError as `Writer` and `Recording.save`.
    """
    growing = path if path.suffix == ".nc" else path.with_name(f"{path.name}.nc")
    with Writer(growing, about) as writer:
        yield writer
    if growing != path:
        Recording.load(growing).save(path)
        growing.unlink()


def figures(report: ServoReport) -> dict[str, float]:
    """How the loop was, in numbers, by name."""
    times = {"period": report.period_us, "late": report.late_us}
    return {
        "ticks": report.ticks,
        "seconds": report.time_s,
        "contact_share": report.flagged.get("TOUCHING", 0) / max(1, report.ticks),
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
    }


LIMITS = [flag.name or "" for flag in TickFlag if not flag & UNTOUCHED]
"""What safety does to a force, by the names of the flags."""
