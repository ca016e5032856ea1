"""The examples of the docs: `python -m benchmarks.gallery docs/gallery` runs them and takes their pictures."""

import html
import io
import re
import runpy
import shlex
import subprocess
import sys
import tempfile
from collections.abc import Callable
from contextlib import chdir
from pathlib import Path
from typing import Any

import numpy as np
from matplotlib import pyplot
from matplotlib.figure import Figure
from PIL import Image

from .ui_drive import browser, tangible

STYLE = """<style>body {display: flex; gap: 24px; margin: 24px; height: 592px; overflow: hidden} img {flex: 1;
min-width: 0; object-fit: contain} pre {font: 19px/1.6 monospace; margin: 0; white-space: pre-wrap}</style>"""


def examples(folder: Path) -> list[Path]:
    """Return the files of all examples, sorted by name."""
    return sorted(path for path in folder.iterdir() if path.suffix in (".sh", ".yaml", ".py") and path.stem != "inputs")


def run(example: Path, folder: Path, call: Callable[[list[str]], str]) -> tuple[list[Path], str]:
    """Run the commands of an example, in comments too, then its Python; return what to look at, and what is printed."""
    text, printed = example.read_text("utf-8"), ""
    for path in (*example.parent.glob("*.yaml"), example):
        folder.joinpath(path.name).write_bytes(path.read_bytes())
    with chdir(folder):
        runpy.run_path(str(example.with_name("inputs.py")))
        for line in re.findall(r"^(?:# | *- run: )?(tangible .*)$", text, re.MULTILINE):
            brief = line.replace("--each 120", "--each 0.5").replace("--seconds inf", "--seconds 1")
            printed += f"$ {line.partition('  #')[0].strip()}\n{call(shlex.split(brief, comments=True)[1:])}\n"
        if example.suffix == ".py":
            runpy.run_path(example.name)
            pyplot.close("all")
    return [folder / name for name in re.findall(r"(?<=# look at: )\S+", text)], printed


def picture(chromium: Any, paths: list[Path], printed: str) -> Image.Image:
    """Return a picture of these files, or of a terminal; chromium: Playwright's browser."""
    images = "".join(f'<img src="{(_draw(path) if path.suffix == ".stl" else path).as_uri()}">' for path in paths)
    if ".html" not in images:
        paths = [Path(tempfile.gettempdir(), "gallery.html")]
        paths[0].write_text(STYLE + (images or f"<pre>{html.escape(printed)}</pre>"), "utf-8")
    with chromium.new_page(viewport={"width": 960, "height": 640}) as page:
        page.goto(paths[0].as_uri(), wait_until="networkidle")
        taken = Image.open(io.BytesIO(page.screenshot()))
    return taken.convert("RGB").resize((480, 320), Image.Resampling.LANCZOS)


def _draw(solid: Path) -> Path:
    corners = np.fromfile(solid, np.dtype([("at", "<f4", (4, 3)), ("", "u2")]), offset=84)["at"][:, 1:]
    x, y, z = corners[corners[..., 2].max(1) > 0].reshape(-1, 3).T  # all but the bottom
    axes = (figure := Figure(figsize=(9, 6))).add_subplot(projection="3d", elev=50, azim=-75)
    axes.plot_trisurf(x, y, z, triangles=np.arange(len(x)).reshape(-1, 3), color="0.9", linewidth=0, antialiased=False)
    axes.set_box_aspect(np.ptp(corners, axis=(0, 1)), zoom=1.5)
    axes.set_axis_off()
    figure.savefig(solid.with_suffix(".png"))
    return solid.with_suffix(".png")


if __name__ == "__main__":
    with browser() as chromium:
        for example in examples(Path(sys.argv[1]).absolute()):
            with tempfile.TemporaryDirectory() as made:
                done = run(example, Path(made), lambda words: subprocess.check_output([tangible(), *words], text=True))
                small = picture(chromium, *done).quantize(64, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
            small.save(example.with_suffix(".png"), optimize=True)
