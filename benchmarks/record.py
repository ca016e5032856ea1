"""Recordings: what a tick takes on disk and in time, and what a kill costs."""

import subprocess
import sys
import tempfile
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from time import perf_counter

import numpy as np

from tangible_core.data import HapticSurface
from tangible_core.plugins.interfaces import Touch
from tangible_core.servo import Safety
from tangible_core.session import Recording, Writer, run_simulated
from tangible_devices.mock import Mock
from tangible_render.proxy import Proxy

from .figures import Figure, judged, part

KILLS = 20
BATCH = 100  # ticks in a tenth of a second, which is how often a session appends
# A thousand ticks a second, as they happen, by the clock that all processes share.
WRITES = """
import sys, time
from pathlib import Path
import numpy as np
from tangible_core.data import TICK_COLUMNS
from tangible_core.session import Writer
with Writer(Path(sys.argv[1])) as writer:
    print("ready", flush=True)
    while True:
        end = time.monotonic() + 0.1
        rows = np.zeros((100, len(TICK_COLUMNS)))
        rows[:, 0] = np.linspace(end - 0.099, end, 100)
        time.sleep(max(0.0, end - time.monotonic()))
        writer.append(rows)
"""


def section() -> str:
    """Return the section as Markdown."""
    head = "A minute of a trembling hand on a rough relief through `proxy` with friction, in netCDF."
    return "\n".join([head, "", *judged(figures())])


def figures() -> Iterator[Figure]:
    """Size, time, error and loss."""
    with tempfile.TemporaryDirectory() as folder:
        minute = part("a minute", _minute)
        yield from _writing(Path(folder) / "minute.nc", minute)
        yield from _reading(Path(folder) / "minute.nc")
        lost_s = part(f"{KILLS} kills", partial(_losses_s, Path(folder) / "killed.nc"))
        told = f"{1000 * np.median(lost_s):.0f} ms median, {1000 * max(lost_s):.0f} ms most of {KILLS}"
        yield Figure("`kill -9`: time of ticks lost", "<= 200 ms", told, max(lost_s) <= 0.2)


def _touch() -> Touch:
    across = np.linspace(-3, 3, 256)
    waves = 0.01 + 0.008 * np.sin(2 * across)[None, :] * np.cos(2 * across)[:, None]
    rough = np.random.default_rng(0).normal(0, 1e-5, waves.shape)
    return Proxy(static_friction=0.4, dynamic_friction=0.3).touch(HapticSurface.from_heights(waves + rough))


def _minute() -> Recording:
    free = Safety(ramp_s=0, max_step_n=10, passivity="off")  # forces as the law gives them
    return run_simulated(_touch(), Mock(tremor_m=2e-4), 60.0, limits=free)


def _writing(path: Path, minute: Recording) -> Iterator[Figure]:
    times = []
    with Writer(path) as writer:
        head = path.stat().st_size
        for rows in np.split(minute.rows, range(BATCH, len(minute.rows), BATCH)):
            start = perf_counter()
            writer.append(rows)
            times.append(perf_counter() - start)
    size = (path.stat().st_size - head) / len(minute.rows)
    yield Figure("bytes a tick; 17 float64 are 136", "<= 96", f"{size:.0f}", size <= 96)
    p50, p99 = 1e6 * np.percentile(times, [50, 99])
    yield Figure(f"append {BATCH} ticks", "p99 <= 1 % of 100 ms", f"{p50:.0f} us p50, {p99:.0f} us p99", p99 <= 1000)
    hour_mb = 60 * path.stat().st_size / 1e6
    yield Figure("an hour, from the minute", "<= 350 MB", f"{hour_mb:.0f} MB", hour_mb <= 350)


def _reading(path: Path) -> Iterator[Figure]:
    start = perf_counter()
    Recording.load(path)
    seconds = perf_counter() - start
    yield Figure("read a minute", "<= 1 s", f"{seconds:.2f} s", seconds <= 1)


def _losses_s(path: Path) -> list[float]:
    """From the last tick in the file to the kill, at moments by chance."""
    moments = np.random.default_rng(0).uniform(0.2, 0.6, KILLS)
    return [_loss_s(path, moment) for moment in moments]


def _loss_s(path: Path, moment_s: float) -> float:
    program = subprocess.Popen([sys.executable, "-c", WRITES, str(path)], stdout=subprocess.PIPE)
    with program:
        assert program.stdout is not None and program.stdout.readline() == b"ready\n"
        time.sleep(moment_s)
        program.kill()
        killed_s = time.monotonic()
    return killed_s - float(Recording.load(path).time_s[-1])
