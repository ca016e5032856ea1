"""The pictures of the page in the docs are compared with the page: otherwise the docs show another one.

TANGIBLE_UI_PICTURES=1 pytest --whole --nightly tests/ui/browser/test_screenshots.py   # takes them anew
"""

import io
import itertools
import os
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image

from browser_tabs import SETTLED
from command_line import tangible
from drawn_parts import drawn
from page_files import ROOT
from page_panels import bring, wait_for_force
from waiting import until

if TYPE_CHECKING:
    from playwright.sync_api import Page

pytestmark = pytest.mark.nightly
DOCS = ROOT / "docs/pictures"
MAX_BYTES = 170_000
MAX_CHANGE = 8
"""Mean difference of small copies, of 255, from which on a picture shows another page."""
PANEL_PX = 320
"""Pictures up to this width are of one panel, whose lines depend on times and on what was made before."""
KEPT = bool(os.environ.get("TANGIBLE_UI_PICTURES"))
COLOURS = 200
"""Colours of a palette: the photograph is small, and the rest has few."""
PICTURES: dict[str, dict[str, Any]] = {
    "ui": {"viewport": {"width": 1440, "height": 900}, "color_scheme": "light"},
    "ui-dark": {"viewport": {"width": 1440, "height": 900}, "color_scheme": "dark"},
    "ui-phone": {"viewport": {"width": 390, "height": 844}, "color_scheme": "light", "locale": "de-DE"},
}


HERE = """() => {
  const [text, path] = ["yaml-text", "save-path"].map((id) => document.getElementById(id));
  const folder = path.value.replace(/[^/]*$/, "");
  for (const each of [text, path]) each.value = each.value.replaceAll(folder, "");
}"""

SUBTITLE = """() => {
  const said = document.getElementById("said");
  said.style = "position: fixed; inset: auto 0 4.2rem 20rem; width: auto; height: auto; clip-path: none; clip: auto;"
    + "z-index: 9; text-align: center; font-size: 1.3rem; background: Canvas";
  said.textContent = "";
}"""
"""What is spoken, on the screen."""


@pytest.fixture
def url(opened: Callable[..., str]) -> str:
    return opened("builtin/motorcycle")


@pytest.mark.parametrize("name", PICTURES)
def test_screenshot_of_the_page(open_page: Callable[..., Any], url: str, tmp_path: Path, name: str):
    page = open_page(url, draws=True, **PICTURES[name])
    wait_for_force(page)
    if name == "ui-dark":
        page.locator("#look").select_option("materials")
    picture = touched(page)
    page.mouse.up()
    keep(picture, name)


VARIANTS: dict[str, dict[str, Any]] = {
    "": {"viewport": {"width": 1240, "height": 780}, "color_scheme": "light"},
    "-dark": {"viewport": {"width": 1240, "height": 780}, "color_scheme": "dark"},
    "-phone": {"viewport": {"width": 390, "height": 844}, "color_scheme": "light", "has_touch": True},
}
TASKS = {"parts": "parts-task", "feel": "feel", "hand-on": "export-task"}


def test_screenshots_of_start_and_tasks(
    opened: Callable[..., str], serve: Callable[..., Any], open_page: Callable[..., Any], tmp_path: Path
):
    empty, url = serve().url, opened(astronaut_file(tmp_path))
    for variant, options in VARIANTS.items():
        page = open_page(empty, draws=True, **options)
        page.locator("#start .tile button", has_text="coins").wait_for()
        keep(shot(page), f"ui/start{variant}")
        page.close()
        page = open_page(url, draws=True, **options)
        wait_for_force(page)
        for task, name in TASKS.items():
            page.locator(f"#tab-{task}").click()
            if task == "hand-on":
                page.wait_for_selector("#export .exporters")
                page.evaluate(HERE)
            page.evaluate(SETTLED)
            picture = touched(page) if task == "feel" else shot(page)
            page.mouse.up()
            keep(picture, f"ui/{name}{variant}")
        page.close()  # the next one gets the hand


def test_sheet_of_the_demo(tmp_path: Path):
    assert tangible("demo", cwd=tmp_path).returncode == 0
    with Image.open(tmp_path / "out/demo/sheet.png") as sheet:
        keep(sheet.convert("RGB").resize((1080, 874), Image.Resampling.LANCZOS), "demo")


def test_film_of_the_page(opened: Callable[..., str], open_page: Callable[..., Any], tmp_path: Path):
    page = open_page(opened(astronaut_file(tmp_path)), draws=True, viewport={"width": 1180, "height": 720})
    wait_for_force(page)
    page.locator("#tab-feel").click()
    page.evaluate(SUBTITLE)
    frames, box = [shot(page)] * 10, page.locator("#terrain").bounding_box()
    for number in range(80):
        turn = 2 * np.pi * number / 80
        x, y = 0.5 - 0.2 * np.cos(turn), 0.5 + 0.14 * np.sin(2 * turn)
        page.mouse.move(box["x"] + x * box["width"], box["y"] + y * box["height"])
        page.mouse.down()
        page.wait_for_timeout(50)
        frames.append(shot(page))
    page.mouse.up()
    page.locator("#terrain").press("n")
    page.wait_for_function("() => document.querySelector('#said').textContent")
    frames += [shot(page)] * 15
    frames = [frame.resize((885, 540), Image.Resampling.LANCZOS) for frame in frames]
    path = (DOCS if KEPT else tmp_path) / "film.webp"
    frames[0].save(path, save_all=True, append_images=frames[1:], duration=100, loop=0, quality=50, method=4)
    assert path.stat().st_size < 3_000_000
    keep(frames[60], "film-still")


def shot(page: Any, **options: Any) -> Image.Image:
    return Image.open(io.BytesIO(page.screenshot(**options))).convert("RGB")


def test_screenshot_of_each_panel(open_page: Callable[..., Any], url: str, tmp_path: Path):
    size = {"width": 1440, "height": 1100}
    page = open_page(url, draws=KEPT, viewport=size, color_scheme="light", reduced_motion="reduce")
    wait_for_force(page)
    page.evaluate("document.querySelectorAll('details.panel').forEach((each) => (each.open = false))")
    names = page.evaluate("[...document.querySelectorAll('#left .panel, #right > .panel')].map(({ id }) => id)")
    assert len(names) > 15
    for name in names:
        panel = bring(page, name)
        panel.evaluate("(each) => (each.open = true)")
        prepare(page, name)
        panel.evaluate("(each) => each.scrollIntoView({ block: 'start' })")
        box = panel.bounding_box()
        cut = {"x": box["x"], "y": box["y"], "width": box["width"], "height": min(box["height"], 640)}
        keep(shot(page, clip=cut), f"ui/{name}")
        if name == "legible":
            keep(shot(page.locator("main")), "ui/legible-marks")
        panel.evaluate("(each) => (each.open = false)")


def test_screenshots_of_the_parts_editor(opened: Callable[..., str], open_page: Callable[..., Any], tmp_path: Path):
    page = open_page(
        opened(astronaut_file(tmp_path)), draws=True, viewport={"width": 1180, "height": 720}, color_scheme="light"
    )
    wait_for_force(page)
    bring(page, "parts").locator("#parts-edit").click()
    page.locator("#parts-list [role=option]", has_text="helmet").first.click()
    page.wait_for_timeout(500)
    keep(shot(page), "ui/parts-editor")

    page.keyboard.press("p")
    page.keyboard.press("t")
    box = page.locator("#parts-picture").bounding_box()
    scale = min(box["width"], box["height"]) / 512
    left, top = box["x"] + (box["width"] - 512 * scale) / 2, box["y"] + (box["height"] - 512 * scale) / 2
    page.mouse.move(left + 110 * scale, top + 350 * scale)
    page.mouse.down()
    page.mouse.move(left + 185 * scale, top + 390 * scale, steps=8)
    page.mouse.up()
    page.get_by_role("button", name="Accept").wait_for()
    page.wait_for_timeout(500)
    stage = page.locator("#parts-editor > .stage").bounding_box()
    picture = shot(page, clip=stage)
    keep(picture.resize((picture.width * 3 // 4, picture.height * 3 // 4)), "ui/parts-proposal")


def astronaut_file(folder: Path) -> Path:
    """Write a photograph with parts that were drawn by hand, and its pipeline file; return that."""
    astronaut = drawn("astronaut")
    Image.fromarray(astronaut.picture).save(folder / "astronaut.png")
    Image.fromarray(astronaut.parts.labels.astype(np.uint8)).save(folder / "parts.png")
    names = [name if astronaut.names.count(name) == 1 else f"{name} {n}" for n, name in enumerate(astronaut.names)]
    parts = [f"  {n + 1}: {{name: {name}, height_m: {astronaut.heights_m[n]}}}\n" for n, name in enumerate(names)]
    text = "scene: {photo: astronaut.png, segments: parts.png}\nworkspace: {width_m: 0.1, relief_m: 0.0064}\n"
    text += f"render: {{use: penalty, stiffness_n_per_m: 400}}\nheights: {{by: given}}\nparts:\n{''.join(parts)}"
    (folder / "astronaut.yaml").write_text(text)
    return folder / "astronaut.yaml"


def prepare(page: "Page", name: str) -> None:
    """Bring a panel to where it has something to say."""
    if name == "methods":
        page.wait_for_selector("#section-render", state="attached")
        page.evaluate("document.querySelector('#section-render').open = true")
    elif name == "preflight":
        page.locator("#preflight-check").click()
        page.wait_for_function("() => document.querySelector('#preflight').textContent.includes('Judged for')")
    elif name == "legible":  # on a print, fingers cannot read all of it
        page.get_by_label("Read on").select_option("print")
        page.locator("#legible-check").click()
        page.wait_for_selector("#legible .sentence")
    elif name == "export":
        for each in ("3D print (STL)", "Swell paper (SVG, PDF)"):
            page.get_by_label(each).check()
        page.locator("#export-run").click()
        page.wait_for_selector("#export .outcome")
    elif name == "description":
        page.wait_for_selector("#description li")
    elif name in ("yaml", "save"):  # without the place of this machine where the test runs
        page.evaluate(HERE)
    elif name == "materials":
        page.wait_for_function("() => document.querySelector('#materials select, #materials td')")
    page.evaluate(SETTLED)


def keep(picture: Image.Image, name: str) -> None:
    """Write the picture, small, if the environment wants it; else it is like the one in the docs, and not empty."""
    assert np.asarray(picture).std() > 5
    if KEPT:
        small = picture.quantize(COLOURS, Image.Quantize.FASTOCTREE, dither=Image.Dither.NONE)
        small.save(DOCS / f"{name}.png", optimize=True)
    assert (DOCS / f"{name}.png").stat().st_size < MAX_BYTES
    with Image.open(DOCS / f"{name}.png") as stored:
        change = np.abs(beside_the_surface(stored) - beside_the_surface(picture)).mean()
    assert change < MAX_CHANGE or picture.width <= PANEL_PX or name == "ui/legible-marks", (
        f"docs/pictures/{name}.png is out of date"
    )


def beside_the_surface(picture: Image.Image) -> np.ndarray:
    """Return a small copy of the left column, on a phone of its lower half: no surface, hand or number."""
    top = picture.height // 2 if picture.height > 2 * picture.width else 0
    column = picture.convert("RGB").crop((0, top, picture.width // 5, picture.height))
    return np.asarray(column.resize((48, 72)), float)


def touched(page: "Page") -> Image.Image:
    """Stroke the surface with the hand pressed, until there is a force; return a picture of it."""
    box = page.locator("#terrain").bounding_box()
    assert box
    page.mouse.move(box["x"] + 0.45 * box["width"], box["y"] + 0.5 * box["height"])
    page.mouse.down()
    force, steps = page.locator("#strip .short td").first, itertools.count()

    def felt() -> Image.Image | None:
        x, y = box["x"] + (0.45 + 0.001 * (next(steps) % 20)) * box["width"], box["y"] + 0.5 * box["height"]
        page.mouse.move(x, y)
        page.wait_for_timeout(50)
        return shot(page) if any(each in "123456789" for each in force.inner_text()) else None

    return until(felt, "a force")
