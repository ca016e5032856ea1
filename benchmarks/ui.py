"""The page in a real browser, drawing in software: how soon and how often, and what it does to the force loop."""

import gzip
import re
import statistics
from collections.abc import Iterator
from functools import partial
from pathlib import Path

from .figures import Figure, judged, part, table
from .servo_rounds import HEADINGS
from .ui_drive import browser, drag, felt, opened, painted, percentile, scene_640, served, window
from .ui_late import lateness, stale_ticks
from .ui_parts import editor
from .ui_tasks import large_relief, memory, stopped, swapped

STATIC = Path(__file__).parents[1] / "plugins/web/tangible_web/static"
IMPORTED = re.compile(r'(?:\bfrom|\bimport)\s*"\./([\w-]+\.js)"')
RUNS = 3
DRAG_S = 8.0


def section() -> str:
    """Return the section as Markdown."""
    found = [*smoothness(), *start(), *tasks(), *editor(), *size()]
    late, rows = lateness()
    found += lasting()  # last: half an hour, in which other work does no harm
    return "\n".join(
        [
            "Terrain 640 x 480, canvas 640 x 400, Chromium without a graphics card (SwiftShader), a mouse dragged 60 "
            f"times a second; medians of {RUNS} runs. Drawn: the pixels can be read.",
            "",
            *judged([*found, late]),
            "",
            "Ticks of the force loop, interleaved rounds:",
            "",
            *table(("felt with", *HEADINGS), rows),
        ]
    )


def smoothness() -> Iterator[Figure]:
    """Yield the cursor while the mouse is dragged."""
    runs = [part(f"drag {n + 1}", _dragged) for n in range(RUNS)]
    hz, tick, tick95, mouse, mouse95, pick, pick99 = (statistics.median(column) for column in zip(*runs, strict=True))
    yield Figure("cursor drawn", ">= 36 Hz", f"{hz:.0f} Hz", hz >= 36)
    yield Figure(
        "tick to drawn, p50 / p95", "<= 38 / 70 ms", f"{tick:.0f} / {tick95:.0f} ms", tick <= 38 and tick95 <= 70
    )
    yield Figure(
        "mouse to drawn with its force, p50 / p95",
        "<= 45 / 90 ms",
        f"{mouse:.0f} / {mouse95:.0f} ms",
        mouse <= 45 and mouse95 <= 90,
    )
    yield Figure("pick, p50 / p99", "<= 0.2 / 5 ms", f"{pick:.2f} / {pick99:.1f} ms", pick <= 0.2 and pick99 <= 5)


def _dragged() -> tuple[float, ...]:
    with scene_640() as config, served(config) as server, browser() as chromium:
        page = opened(chromium, server.url)
        felt(page)
        page.evaluate("Object.assign(figures, {drawn: [], trips: [], picks: []})")
        drag(page, DRAG_S)
        found = page.evaluate("figures")
    drawn, trips, picks = found["drawn"], found["trips"], found["picks"]
    span_s = (drawn[-1][3] - drawn[0][3]) / 1e3
    ticks = [each[1] for each in drawn]
    return (
        (len(drawn) - 1) / span_s,
        *(percentile(ticks, share) for share in (50, 95)),
        *(percentile(trips, share) for share in (50, 95)),
        *(percentile(picks, share) for share in (50, 99)),
    )


def start() -> Iterator[Figure]:
    """From the command to the first picture, and until it is felt; kernels compiled, results kept."""
    rounds = [(part(f"start {n + 1}", partial(_started, True)), _started(False)) for n in range(RUNS + 1)][1:]
    for where, each in (("", 0), (", in a window that is opened for it", 1)):
        paint_s, feel_s = (statistics.median(one[each][which] for one in rounds) for which in (0, 1))
        yield Figure(f"command to first paint, warm{where}", "<= 2.6 s", f"{paint_s:.2f} s", paint_s <= 2.6)
        yield Figure(f"command to felt, warm{where}", "<= 3 s", f"{feel_s:.2f} s", feel_s <= 3)


def _started(in_a_tab: bool) -> tuple[float, float]:
    """in_a_tab: the browser is warm and has a window, as on a desk; else it opens one, which takes it a second."""
    with scene_640() as config, browser() as chromium:
        desk = window(chromium)
        with served(config) as server:
            page = opened(chromium, server.url, desk if in_a_tab else None)
            return painted(page) - server.begun_s, felt(page) - server.begun_s


def tasks() -> Iterator[Figure]:
    """Yield the figures of long work, which must not slow the hand."""
    swap_s = statistics.median(part("swap", swapped))
    yield Figure("another law that is known, click to felt", "<= 400 ms", f"{1e3 * swap_s:.0f} ms", swap_s <= 0.4)
    stop_s, overruns = part("stop", stopped)
    said = f"{stop_s:.2f} s, {overruns} periods without a tick"
    yield Figure("stop of a stage", "<= 1.5 s, no tick changed", said, stop_s <= 1.5 and overruns == 0)
    paint_s, hz = part("18 megapixels", large_relief)
    yield Figure("relief of 18 megapixels", "draws", f"first paint {paint_s:.1f} s, cursor {hz:.0f} Hz", hz > 0)


def size() -> Iterator[Figure]:
    """Of what a browser fetches of the page when it is opened; a script that is imported later is not among it."""
    names = ["index.html", "app.css", "app.js"]
    for name in names:  # those that it imports come after it
        text = (STATIC / name).read_text("utf-8") if name.endswith(".js") else ""
        names += [each for each in IMPORTED.findall(text) if each not in names]
    kb = sum(len(gzip.compress((STATIC / name).read_bytes(), 9)) for name in names) / 1e3
    yield Figure("page, compressed", "<= 280 kB", f"{kb:.0f} kB", kb <= 280)


def lasting() -> Iterator[Figure]:
    """Yield the figures of a long session."""
    stale, seconds, asked = part("a minute of dragging", stale_ticks)
    yield Figure(f"stale ticks in {seconds:.0f} s of dragging", "0", str(stale), stale == 0)
    yield Figure("requests to another machine meanwhile", "0", str(asked), asked == 0)
    minutes, grown_page_mb, grown_server_mb = part("memory", memory)
    said = f"page {grown_page_mb:+.1f} MB, server {grown_server_mb:+.1f} MB"
    flat = max(grown_page_mb, grown_server_mb) <= 10
    yield Figure(f"memory after {minutes:g} minutes of a page left open", "flat: <= 10 MB more", said, flat)
