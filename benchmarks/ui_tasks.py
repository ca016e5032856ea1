"""What the page does on demand: another law, a stop, a large relief, a long stay."""

import os
import tempfile
import time
from pathlib import Path

import numpy as np

from .ui_drive import browser, drag, felt, opened, painted, scene_640, served, until
from .ui_late import ring_of

LAWS = ("penalty", "proxy")
SWAPS = 10
MINUTES = float(os.environ.get("TANGIBLE_MINUTES", "30"))
SETTLE_S = 60.0
LARGE = (4200, 4300)


def swapped() -> list[float]:
    """Seconds from another law chosen in its form until it is felt, each law known to this machine."""
    with scene_640() as config, served(config) as server, browser() as chromium:
        page = opened(chromium, server.url)
        felt(page)
        until(page, "document.getElementById('field:render')?.options.length > 1")
        times = [_swap(page, LAWS[n % 2]) for n in range(SWAPS + 2)]
    return times[2:]


def _swap(page: object, law: str) -> float:
    from typing import Any, cast

    tab = cast(Any, page)
    before = tab.evaluate("figures.touches.length")
    begun_ms = tab.evaluate(
        """law => {
          const choice = document.getElementById("field:render");
          choice.value = law;
          const begun = performance.timeOrigin + performance.now();
          choice.dispatchEvent(new Event("change", { bubbles: true }));
          return begun;
        }""",
        law,
    )
    return (until(tab, f"figures.touches[{before}]") - begun_ms) / 1e3


def stopped() -> tuple[float, int]:
    """Seconds from stop to the end of a stage that would take long, and periods without a tick meanwhile."""
    with tempfile.TemporaryDirectory() as cache, scene_640() as config:
        from PIL import Image

        config.write_text(config.read_text().replace("use: semi-global", "use: report"))
        for name in ("left.png", "right.png"):
            with Image.open(config.parent / name) as picture:
                picture.resize((3 * picture.width, 3 * picture.height)).save(config.parent / name)
        with served(config, TANGIBLE_CACHE_DIR=cache) as server, browser() as chromium:
            page = opened(chromium, server.url)
            ring = ring_of(server.process.pid)
            until(page, "figures.stage")
            time.sleep(0.3)
            overruns = ring.overruns
            begun_ms = page.evaluate("window.page.net.ask('stop_making'), performance.timeOrigin + performance.now()")
            ended_ms = until(page, "figures.stoppedMs")
            time.sleep(0.5)
            return (ended_ms - begun_ms) / 1e3, ring.overruns - overruns


def large_relief() -> tuple[float, float]:
    """Seconds to the first paint of 18 megapixels of heights, and how often the cursor is then drawn."""
    with tempfile.TemporaryDirectory(prefix="tangible-bench-") as folder:
        rows, columns = LARGE
        y, x = np.mgrid[0:rows, 0:columns].astype(np.float32) / 300
        np.save(Path(folder) / "hills.npy", np.sin(x) * np.sin(y))
        config = Path(folder) / "hills.yaml"
        config.write_text(
            "scene: {height: hills.npy}\nwant: touch\nworkspace: {width_m: 0.08, relief_m: 0.005, finest_m: 0}\n"
            "render: {use: penalty}\ndevice: {use: pointer}\n"
        )
        with served(config) as server, browser() as chromium:
            page = opened(chromium, server.url)
            paint_s = painted(page) - server.begun_s
            felt(page)
            page.evaluate("Object.assign(figures, {drawn: []})")
            drag(page, 5.0)
            drawn = page.evaluate("figures.drawn")
        return paint_s, (len(drawn) - 1) / ((drawn[-1][3] - drawn[0][3]) / 1e3)


def memory() -> tuple[float, float, float]:
    """Minutes that a page is left open and felt, and how many megabytes it and its server have grown."""
    with scene_640() as config, served(config) as server, browser() as chromium:
        page = opened(chromium, server.url)
        felt(page)
        session = page.context.new_cdp_session(page)

        def used() -> tuple[float, float]:
            session.send("HeapProfiler.collectGarbage")
            found = session.send("Runtime.getHeapUsage")["usedSize"]
            return found / 1e6, _resident_mb(server.process.pid)

        drag(page, SETTLE_S)
        before = used()
        end_s = time.monotonic() + 60 * MINUTES
        while time.monotonic() < end_s:
            drag(page, min(5.0, max(0.1, end_s - time.monotonic())))
            time.sleep(max(0.0, min(25.0, end_s - time.monotonic())))
        after = used()
    return MINUTES, after[0] - before[0], after[1] - before[1]


def _resident_mb(process: int) -> float:
    for line in Path(f"/proc/{process}/status").read_text().splitlines():
        if line.startswith("VmRSS:"):
            return int(line.split()[1]) / 1e3
    return 0.0
