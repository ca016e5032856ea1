"""How late the ticks of the force loop are while a page draws, against the loop alone."""

import subprocess
import time
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path

import numpy as np

from tangible_core.data import TickFlag
from tangible_core.errors import DeviceError
from tangible_core.servo.ring import Ring, shared_folder
from tangible_core.session.recording.tick_file import ARRAYS

from .figures import Figure, part
from .servo_rounds import Round, no_later_figure, rows
from .ui_drive import browser, drag, end, felt, opened, scene_640, served, tangible

ROUNDS, ROUND_S = 8, 7.0
MINUTE_S = 60.0


def lateness() -> tuple[Figure, list[tuple[str, ...]]]:
    """Both kinds in turn, the order changed from round to round."""
    kinds: dict[str, Callable[[Path], Round]] = {"`tangible feel` and `tangible pointer`": _alone, "the page": _paged}
    found: dict[str, list[Round]] = {name: [] for name in kinds}
    with scene_640() as config:
        for number in range(ROUNDS):
            for name in list(kinds)[:: -1 if number % 2 else 1]:
                found[name].append(part(f"late {number + 1}: {name}", lambda name=name: kinds[name](config)))
    alone, paged = found.values()
    return no_later_figure("page open and dragged", paged, alone), rows(found)


def ring_of(process: int) -> Ring:
    """Return the ring of a host's loop, once it ticks. Raises: TimeoutError."""
    end_s = time.monotonic() + 60
    while time.monotonic() < end_s:
        for path in shared_folder().glob(f"tangible-{process}-*.ring"):
            with suppress(DeviceError):  # it is being made, or its loop has ended
                if (ring := Ring.attach(path)).count > 500:
                    return ring
        time.sleep(0.05)
    raise TimeoutError("no force loop began")


def _window(ring: Ring, during: Callable[[], object]) -> Round:
    before, overruns, first = ring.late.copy(), ring.overruns, ring.count
    during()
    ticks, _ = ring.since(first)
    latest_s = float(ticks[:, ARRAYS["late_s"]].max(initial=0.0))
    return Round(ring.late - before, ring.overruns - overruns, latest_s)


def _alone(config: Path) -> Round:
    words = [tangible(), "feel", str(config), "--seconds", "60"]
    loop = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, text=True)
    hand = None
    try:
        ring = ring_of(loop.pid)
        words = [tangible(), "pointer", "--path", "circle", "--seconds", "60", "--wait", "10"]
        hand = subprocess.Popen(words, stdout=subprocess.DEVNULL, stderr=subprocess.DEVNULL, text=True)
        time.sleep(1.5)
        return _window(ring, lambda: time.sleep(ROUND_S))
    finally:
        for process in filter(None, (hand, loop)):
            end(process)


def _paged(config: Path) -> Round:
    with served(config) as server, browser() as chromium:
        page = opened(chromium, server.url)
        felt(page)
        ring = ring_of(server.process.pid)
        time.sleep(1.5)
        return _window(ring, lambda: drag(page, ROUND_S))


def stale_ticks() -> tuple[int, float, int]:
    """Ticks without a fresh position in a minute of dragging, its seconds, and requests that left this machine."""
    asked: list[str] = []
    stale = 0
    with scene_640() as config, served(config) as server, browser() as chromium:
        page = opened(chromium, server.url)
        page.on("request", lambda request: asked.append(request.url))
        felt(page)
        ring = ring_of(server.process.pid)
        following = ring.count
        begun_s = time.monotonic()
        while time.monotonic() - begun_s < MINUTE_S:
            drag(page, 3.0)
            ticks, following = ring.since(following)
            stale += int(np.count_nonzero(ticks[:, ARRAYS["flags"]].astype(np.int64) & TickFlag.STALE))
    here = ("http://127.0.0.1", "ws://127.0.0.1", "data:", "blob:")
    return stale, time.monotonic() - begun_s, sum(not url.startswith(here) for url in asked)
