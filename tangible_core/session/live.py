"""A session in real time: the force loop in its own process, watched and recorded from here."""

import time
from collections.abc import Callable, Generator
from concurrent.futures import ThreadPoolExecutor
from contextlib import contextmanager
from pathlib import Path
from threading import Event
from typing import Any

import numpy as np

from ..data import UNTOUCHED, FilmFelt, ServoReport, TickFlag
from ..plugins.interfaces import Film, HapticDevice, Touch
from ..runtime.stopping import stop_asked, stoppable
from ..servo import Beacon, Safety, Servo
from .keeper import Keeper
from .recording import INTERRUPTED, STOPPED, Recording
from .tick_file import About
from .writer import Writer

LOOK_EVERY_S = 0.05
"""How often what was felt is taken from the loop's ring: what a crash of this process can lose of a recording."""
REPORT_EVERY_S = 0.1


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
    """Feel in real time, until time is over, Ctrl-C, `stop` or what else ends a `Servo`; then no force is left.

    on_report: called ten times a second, and at the end. keep: given all ticks, as rows of `data.TICK_COLUMNS`, in a
    thread of its own. on_start: called once the loop runs. What these raise ends the session, such as a full disk.
    stop: set from another thread, it ends the session within a tenth of a second. beacon: pulls from the start, until a
    button releases it (`Servo.pull_to`).
    Raises: ConfigError if seconds is not positive and finite, DeviceError if the device cannot be opened, and what a
    plugin raises.
    """
    with stoppable(stop):
        servo = Servo(touch, device, limits, seconds)

        def begun(servo: Servo) -> None:
            servo.pull_to(beacon)
            (on_start or ignored)(servo)

        return attended(servo, on_report or ignored, keep or ignored, begun)


def attended(
    servo: Servo,
    tell: Callable[[ServoReport], None],
    keep: Callable[[np.ndarray], None],
    on_start: Callable[[Servo], None],
    look: Callable[[], str] = str,
) -> ServoReport:
    """Start this loop, watch over it until something ends it, and leave no force.

    look: called twenty times a second, for what else there is to do; says why the loop shall end, if it shall.
    Raises: as `run_in_real_time`.
    """
    with ThreadPoolExecutor(1) as aside, servo:  # the force goes first
        on_start(servo)
        keeper, next_s, ended = Keeper(servo, keep), time.monotonic(), ""
        try:
            while servo.running and not ended:
                time.sleep(LOOK_EVERY_S)
                aside.submit(keeper.look).result()
                if time.monotonic() >= next_s:
                    next_s += REPORT_EVERY_S
                    tell(servo.report())
                ended = STOPPED if stop_asked() else look()
            last = servo.stop(ended)
        except KeyboardInterrupt:
            last = servo.stop(INTERRUPTED)
        aside.submit(keeper.look).result()
        tell(last)
    return last


def ignored(_: Any) -> None:
    """Nobody listens."""


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
        **({} if report.film is None else _of_film(report.film)),
    }


def _of_film(film: FilmFelt) -> dict[str, float]:
    return {f"frames_{name}": value for name, value in film._asdict().items() if value is not None}


LIMITS = [flag.name or "" for flag in TickFlag if not flag & UNTOUCHED]
"""What safety does to a force, by the names of the flags."""
