"""A server and a browser for measurements: started, driven by a mouse, ended."""

import math
import os
import shutil
import subprocess
import sys
import tempfile
import time
from collections.abc import Generator, Sequence
from contextlib import contextmanager
from dataclasses import dataclass
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from playwright.sync_api import Browser, BrowserContext, Page

KEY = "measured"
FLAGS = [
    "--no-sandbox",
    "--use-gl=angle",
    "--use-angle=swiftshader",
    "--enable-unsafe-swiftshader",
    "--ignore-gpu-blocklist",
    "--enable-precise-memory-info",
]
# The first that is installed is measured; the shell is the same without windows.
BROWSERS = ("chromium", "google-chrome", "google-chrome-stable", "chromium-browser", "chromium-headless-shell")
SIZE = {"width": 1180, "height": 720}
LONGEST_S = 120.0
CONFIG = """\
scene: {left: left.png, right: right.png, focal_px: 994.978, baseline_m: 0.193001, offset_px: 31.086}
want: touch
depth: {use: semi-global}
texture: {use: gradient, segments: 6}
workspace: {width_m: 0.08, relief_m: 0.02, smooth_m: 0.0003}
render: {use: proxy, stiffness_n_per_m: 800}
device: {use: pointer}
"""


@dataclass
class Served:
    """A server that listens."""

    process: subprocess.Popen[str]
    url: str
    begun_s: float  # when its command was given, Unix time


@contextmanager
def scene_640() -> Generator[Path]:
    """Provide a pipeline file of the motorcycle, cut to 640 x 480."""
    from PIL import Image
    from skimage import data

    left, right, _ = data.stereo_motorcycle()
    with tempfile.TemporaryDirectory(prefix="tangible-bench-") as folder:
        for name, picture in (("left", left), ("right", right)):
            Image.fromarray(picture[10:490, 40:680]).save(Path(folder) / f"{name}.png")
        config = Path(folder) / "motorcycle.yaml"
        config.write_text(CONFIG)
        yield config


@contextmanager
def served(*words: object, **env: str) -> Generator[Served]:
    """`tangible ui` with these words."""
    command = [tangible(), "ui", *map(str, words), "--no-browser", "--port", "0"]
    begun_s = time.time()
    process = subprocess.Popen(
        command, env={**os.environ, "TANGIBLE_UI_TOKEN": KEY, **env}, stdout=subprocess.PIPE, text=True
    )
    assert process.stdout is not None
    try:
        yield Served(process, process.stdout.readline().split()[-1], begun_s)
    finally:
        end(process)


def tangible() -> str:
    """Return the program of this environment."""
    return shutil.which("tangible", path=str(Path(sys.executable).parent)) or "tangible"


def end(process: subprocess.Popen[str]) -> None:
    """As a service manager does: Ctrl-C may be ignored where this runs in the background; killed if it does not end."""
    process.terminate()
    try:
        process.wait(10)
    except subprocess.TimeoutExpired:
        process.kill()
        process.wait()


@contextmanager
def browser() -> "Generator[Browser]":
    """Chromium without a window and without a graphics card."""
    from playwright.sync_api import sync_playwright

    found = (path for name in BROWSERS if (path := shutil.which(name)))
    path = os.environ.get("TANGIBLE_UI_BROWSER") or next(found, None)
    with sync_playwright() as playwright:
        chromium = playwright.chromium.launch(executable_path=path, args=FLAGS)
        try:
            yield chromium
        finally:
            chromium.close()


def window(chromium: "Browser") -> "BrowserContext":
    """Return a window of the browser with an empty tab, at rest. Making one takes a second of processor time."""
    found = chromium.new_context(viewport=SIZE, locale="en-GB")  # pyright: ignore[reportArgumentType]
    found.new_page()
    time.sleep(1.0)
    return found


def opened(chromium: "Browser", url: str, within: "BrowserContext | None" = None) -> "Page":
    """Return a tab with the page, which keeps figures; in a window that is there, or in one of its own."""
    page = (within or chromium.new_context(viewport=SIZE, locale="en-GB")).new_page()  # pyright: ignore[reportArgumentType]
    page.goto(f"{url}&measure")
    return page


def until(page: "Page", said: str) -> Any:
    """Return the value of an expression of the page, once it has one. Raises: TimeoutError."""
    end_s = time.monotonic() + LONGEST_S
    while not (found := page.evaluate(said)):
        if time.monotonic() > end_s:
            raise TimeoutError(f"the page did not come to {said}")
        time.sleep(0.02)
    return found


def painted(page: "Page") -> float:
    """When the surface was drawn first, Unix time."""
    return until(page, "figures.firstMs") / 1e3


def felt(page: "Page") -> float:
    """When a touch was felt first, Unix time."""
    return until(page, "figures.feltMs") / 1e3


def drag(page: "Page", seconds: float, hz: float = 60.0, where: str = "#terrain") -> None:
    """Return a mouse, held down, on a curve that crosses the whole surface."""
    box = page.locator(where).bounding_box()
    assert box is not None
    middle = box["x"] + box["width"] / 2, box["y"] + box["height"] * 0.55
    page.mouse.move(*middle)
    page.mouse.down()
    begun_s, moves = time.monotonic(), 0
    while (passed_s := time.monotonic() - begun_s) < seconds:
        across, along = math.cos(1.1 * passed_s), math.sin(1.7 * passed_s)
        page.mouse.move(middle[0] + 0.28 * box["width"] * across, middle[1] + 0.22 * box["height"] * along)
        moves += 1
        time.sleep(max(0.0, begun_s + moves / hz - time.monotonic()))
    page.mouse.up()


def percentile(values: Sequence[float], share: float) -> float:
    """As numpy has it; NaN of nothing."""
    return float(np.percentile(values, share)) if len(values) else math.nan
