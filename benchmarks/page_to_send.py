"""A page that was sent: how large its file is, how soon it opens, and how soon it answers a touch."""

import statistics
import tempfile
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from tangible_core import Pipeline, Scene
from tangible_depth import Luminance
from tangible_send.page import MAX_BYTES
from tangible_texture import Gradient

from .figures import Figure, judged, part
from .ui_drive import browser, percentile, window

if TYPE_CHECKING:
    from playwright.sync_api import Browser

RUNS = 3
MEGAPIXELS = 12
STEPS = 120
READY = "() => window.tangible !== undefined && figures.firstMs > 0"


def section() -> str:
    """Return the section as Markdown."""
    found = list(_figures())
    return "\n".join(
        [
            f"A photograph of {MEGAPIXELS} megapixels by `tangible export --to page`, opened from its file in Chromium "
            f"without a graphics card (SwiftShader); medians of {RUNS} openings in a browser that runs.",
            "",
            *judged(found),
        ]
    )


def _figures() -> Iterator[Figure]:
    with tempfile.TemporaryDirectory(prefix="tangible-bench-") as folder:
        path = part("export", lambda: _sent(Path(folder)))
        size = path.stat().st_size
        yield Figure("file", f"<= {MAX_BYTES / 1e6:g} MB", f"{size / 1e6:.2f} MB", size <= MAX_BYTES)
        with browser() as chromium:
            runs = [part(f"open {n + 1}", partial(_opened, chromium, path)) for n in range(RUNS + 1)][1:]
    open_s, p50, p95 = (statistics.median(column) for column in zip(*runs, strict=True))
    yield Figure("address to explorable and drawn", "<= 1.5 s", f"{open_s:.2f} s", open_s <= 1.5)
    yield Figure("touch to drawn with its force, p50 / p95", "<= 60 ms", f"{p50:.0f} / {p95:.0f} ms", p95 <= 60)


def _sent(folder: Path) -> Path:
    from PIL import Image
    from skimage import data

    side = round((MEGAPIXELS * 1e6) ** 0.5)
    picture = np.asarray(Image.fromarray(data.astronaut()).resize((side, side), Image.Resampling.BICUBIC))
    noise = np.random.default_rng(1).normal(0, 4, picture.shape)
    photo = np.clip(picture + noise, 0, 255).astype(np.uint8)
    done = Pipeline(Scene.photo(photo), depth=Luminance(), texture=Gradient()).export(folder, ["page"])
    [path] = done.files["page"]
    return path


def _opened(chromium: "Browser", path: Path) -> tuple[float, float, float]:
    context = window(chromium)
    try:
        page = context.new_page()
        begun_s = time.perf_counter()
        page.goto(f"{path.as_uri()}?measure")
        page.wait_for_function(READY)
        open_s = time.perf_counter() - begun_s
        box = page.locator("#terrain").bounding_box()
        assert box is not None
        x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2
        page.mouse.move(x - 100, y)
        page.mouse.down()
        page.evaluate("figures.trips.length = 0")
        for step in range(STEPS):
            page.mouse.move(x - 100 + 1.5 * step, y + 20 * np.sin(step / 9))
        page.mouse.up()
        trips = page.evaluate("figures.trips")
    finally:
        context.close()
    return open_s, percentile(trips, 50), percentile(trips, 95)
