"""The editor of parts: how soon a stroke is seen, a part is proposed, and a height that is dragged is felt."""

import statistics
import subprocess
import tempfile
from collections.abc import Generator, Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import TYPE_CHECKING

from .figures import Figure, part
from .ui_drive import browser, drag, felt, opened, percentile, scene_640, served, tangible, until

if TYPE_CHECKING:
    from playwright.sync_api import Page

LARGE = (4000, 3000)  # columns and rows of a photograph of twelve megapixels
DRAG_S = 5.0
HEIGHTS = 20
STROKES = [[[x, y], [x + 250, y + 150]] for y in (900, 1800, 2600) for x in (500, 1500, 2700)]
PROPOSE = """async (points) => {
  const begun = performance.now();
  await page.net.ask("parts_propose", { points, width_px: 30, kind: "grabcut", within: null });
  return performance.now() - begun;
}"""
DRAG_HEIGHT = """async ([count, times]) => {
  const taken = [];
  for (let i = 0; i < times; i++) {
    const heights_m = Array.from({ length: count }, (_, k) => 3e-4 * k + (k === 3 ? 1e-4 * i : 0));
    const begun = performance.now();
    await page.net.ask("parts_heights", { heights_m });
    taken.push(performance.now() - begun);
  }
  return taken;
}"""


def editor() -> Iterator[Figure]:
    """Yield the waits of a person who draws parts."""
    brush, proposed = part("parts of 12 megapixels", _large)
    p50, p95 = (percentile(brush, share) for share in (50, 95))
    yield Figure("brush on 12 megapixels, seen after, p50 / p95", "<= 50 ms", f"{p50:.0f} / {p95:.0f} ms", p50 <= 50)
    middle, most = statistics.median(proposed), max(proposed)
    yield Figure(
        "part proposed on 12 megapixels, median / longest", "<= 500 ms", f"{middle:.0f} / {most:.0f} ms", middle <= 500
    )
    times = part("heights of parts", _dragged)
    p50, p95 = (percentile(times, share) for share in (50, 95))
    told = f"{p50:.0f} / {p95:.0f} ms"
    yield Figure("height that is dragged, felt after, p50 / p95", "<= 150 ms", told, p50 <= 150)


def _large() -> tuple[list[float], list[float]]:
    from PIL import Image
    from skimage import data

    with tempfile.TemporaryDirectory(prefix="tangible-bench-") as folder:
        photo = Path(folder) / "photo.png"
        Image.fromarray(data.astronaut()).resize(LARGE).save(photo)
        with _editor(photo) as page:
            proposed = [page.evaluate(PROPOSE, points) for points in STROKES]
            page.locator("#parts-editor .bar").first.get_by_role("button", name="Brush", exact=True).click()
            page.evaluate("performance.clearMeasures()")
            drag(page, DRAG_S, where="#parts-picture")
            brush = page.evaluate("performance.getEntriesByName('parts shown').map((each) => each.duration)")
    return brush, proposed


def _dragged() -> list[float]:
    with scene_640() as config, _editor(config.parent / "left.png") as page:
        count = page.locator("#parts-list [role=option]").count()
        page.evaluate("figures.waits = false")  # a page that nobody measures draws beside what it sends and hears
        page.evaluate(DRAG_HEIGHT, [count, 3])  # what is made once for all heights
        return page.evaluate(DRAG_HEIGHT, [count, HEIGHTS])


@contextmanager
def _editor(photo: Path) -> "Generator[Page]":
    words = [tangible(), "parts", str(photo), "--out", str(photo.parent / "parts")]
    subprocess.run(words, check=True, stdout=subprocess.DEVNULL)
    (config,) = (photo.parent / "parts").glob("*.yaml")
    with served(config) as server, browser() as chromium:
        page = opened(chromium, server.url)
        felt(page)
        page.locator("#tab-parts").click()
        page.locator("#parts-edit").click()
        until(page, "document.querySelector('#parts-list [role=option]')")
        yield page
