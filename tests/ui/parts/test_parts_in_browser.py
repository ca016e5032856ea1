"""The editor of parts: otherwise nobody gets from a photograph to named parts, by the keyboard alone."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zipfile import ZipFile

import numpy as np
import pytest
from PIL import Image

from browser_tabs import OpenPage
from page_panels import SPY, bring, wait_for_force
from tangible_core.parts import PartChoice, find_parts
from tangible_core.pipeline.config.parsing import load_config
from tangible_core.plugins.registry import default_registry
from tangible_core.scene.scene import Scene
from tangible_core.scene.scene_files import SceneFiles
from waiting import until

if TYPE_CHECKING:
    from playwright.sync_api import Locator, Page

WIDTH, HEIGHT = 240, 180
RELIEF = "workspace: {width_m: 0.08, relief_m: 0.006}\nrender: {use: penalty, stiffness_n_per_m: 400}\n"


@pytest.fixture
def photo(tmp_path: Path) -> Path:
    """A red ball before a grey wall over a brown table, each with a little noise."""
    y, x = np.mgrid[:HEIGHT, :WIDTH]
    picture = np.where((y > 130)[..., None], [120, 80, 40], [150, 155, 165]).astype(float)
    picture[(x - 150) ** 2 + (y - 90) ** 2 < 40**2] = [190, 40, 40]
    picture += np.random.default_rng(3).normal(scale=4, size=picture.shape)
    Image.fromarray(np.uint8(np.clip(picture, 0, 255))).save(tmp_path / "ball.png")
    return tmp_path / "ball.png"


def undo_the_first_parts(page: "Page") -> None:
    """Wait for the parts that the program proposes for a picture, and take them back: it is one part then."""
    until(lambda: "parts are proposed" in page.locator("#parts-told").inner_text(), "parts are proposed")
    assert len(names(page)) >= 3, "a ball, a wall and a table"
    page.keyboard.press("Control+z")
    until(lambda: len(names(page)) == 1, "undone to nothing")


def names(page: "Page") -> list[str]:
    """Return the names of the parts, from front to back."""
    return page.locator("#parts-list .name").all_inner_texts()


def read_parts(path: Path) -> tuple[Mapping[int, PartChoice], Any]:
    """Return a pipeline file's entries of parts, and the number of each pixel's part."""
    config = load_config(path, default_registry())
    assert isinstance(config.scene, SceneFiles) and config.parts is not None
    segments = Scene.read(config.scene, config.folder).segments
    assert segments is not None
    return config.parts, find_parts(segments).labels


def test_parts_editor_makes_five_parts_by_keyboard(opened: Callable[..., str], open_page: OpenPage, photo: Path):
    page = open_page("about:blank")
    page.add_init_script(SPY)
    page.goto(opened(photo) + "&measure")
    wait_for_force(page)
    until(lambda: focus_on(page, "left"), "F6")
    bring(page, "parts")
    enter(page, "#parts-edit")
    page.wait_for_selector("#parts-list [role=option]")
    until(lambda: focus_id(page) == "parts-list", "the list has the focus")
    undo_the_first_parts(page)
    name_part(page, "wall")

    # an outline with the crosshair: from the middle to the lower half
    press(page, "l")
    assert focus_id(page) == "parts-picture"
    cross(page, 2, 140)
    press(page, " ")
    for place in ((WIDTH - 2, 140), (WIDTH - 2, HEIGHT - 2), (2, HEIGHT - 2)):
        cross(page, *place)
    press(page, "Enter")
    until(lambda: len(names(page)) == 2, "an outline is painted")
    press(page, "o")
    name_part(page, "table")
    # a proposal where the crosshair stands
    press(page, "p", "t")
    cross(page, 150, 90)
    press(page, " ", " ")
    until(lambda: page.get_by_role("button", name="Accept").is_visible(), "proposed")
    press(page, "Enter")
    until(lambda: len(names(page)) == 3, "accepted")
    press(page, "o")
    name_part(page, "ball")
    # the brush, thicker
    press(page, "b", "t", "]", "]")
    cross(page, 40, 40)
    press(page, " ")
    cross(page, 40, 70)
    press(page, " ", "o")
    until(lambda: len(names(page)) == 4, "painted")
    name_part(page, "lamp")
    # the wall, cut in two
    until(lambda: step_to(page, "wall"), "the wall is in the list")
    press(page, "x")
    cross(page, 80, 1)
    press(page, " ")
    cross(page, 80, 145)
    press(page, " ", "o")
    until(lambda: len(names(page)) == 5, "split")
    name_part(page, "door")

    # heights and order
    until(lambda: step_to(page, "ball"), "the ball is in the list")
    page.evaluate("heard.length = 0")
    press(page, "Control+ArrowRight", "ArrowRight", "Shift+ArrowLeft")
    until(lambda: any("ball is number 1 of 5" in each for each in page.evaluate("heard")), "the order is said")
    said = page.locator("#parts-list [aria-selected=true] .height").inner_text()
    press(page, "Control+z")
    assert page.locator("#parts-list [aria-selected=true] .height").inner_text() != said
    press(page, "Control+Shift+z")

    # a question where something is unsaved; saved, and closed without one
    press(page, "Escape")
    page.wait_for_selector("dialog[open]")
    press(page, "Enter")
    until(lambda: page.locator("dialog").count() == 0, "answered")
    assert page.locator("#parts-editor").count() == 1, "it goes on"
    page.locator("#parts-list").focus()
    press(page, "Control+s")
    page.wait_for_selector("dialog[open]")
    assert str(photo.parent) in page.locator("dialog").inner_text(), "the folder of the photograph is offered"
    press(page, "Tab", "Enter")
    where = f"Saved: {photo.with_suffix('.yaml')}"
    until(lambda: where in page.locator("#parts-told").inner_text(), "saved, and where")
    press(page, "Escape")
    until(lambda: page.locator("#parts-editor").count() == 0, "closed")

    parts, labels = read_parts(photo.with_suffix(".yaml"))
    assert {part.name for part in parts.values()} == {"wall", "ball", "table", "lamp", "door"}
    assert parts[int(labels[90, 150]) + 1].name == "ball"
    assert parts[int(labels[170, 20]) + 1].name == "table"


def test_photograph_becomes_three_named_parts_on_swell_paper_in_twelve_actions(
    opened: Callable[..., str], open_page: OpenPage, photo: Path, tmp_path: Path
):
    (tmp_path / "before.yaml").write_text(f"scene: {{photo: {photo}}}\ndepth: luminance\n{RELIEF}")
    page = open_page(opened(tmp_path / "before.yaml") + "&measure")
    wait_for_force(page)
    hers = photo.with_name("her ball.png")
    photo.rename(hers)
    done: list[str] = []

    def click(where: "Locator") -> None:
        where.click()
        done.append(f"click {where}")

    page.locator("#open-files").set_input_files(hers)
    done.append("choose a file")
    until(lambda: "her ball" in page.evaluate("page.document.path"), "opened")
    click(page.locator("#tab-parts"))
    click(page.locator("#parts-edit"))
    until(lambda: "parts are proposed" in page.locator("#parts-told").inner_text(), "parts are proposed")
    assert len(names(page)) == 3, "a ball, a wall and a table"
    click(page.locator("#parts-list [role=option]").first)
    for name in ("ball", "table", "wall"):  # Enter leads from name to name, and back to the list
        page.keyboard.type(f"{name}\n")
        done.append(f"type {name}, Enter")
        until(lambda name=name: name in names(page), name)
    assert focus_id(page) == "parts-list"
    click(page.locator("#parts-save"))
    until(lambda: page.locator("#parts-editor").count() == 0, "saved and closed")
    click(page.locator("#tab-hand-on"))
    panel = page.locator("#export")
    until(lambda: panel.locator(".previews img").count() == 1, "the page is seen before it is made")
    title = panel.get_by_label("Title")
    assert title.input_value() == "", "the picture has none"
    title.fill("Her ball")
    done.append("type a title")
    with page.expect_download() as waited:  # the title is written before
        click(panel.get_by_role("button", name="Export", exact=True))
    assert waited.value.suggested_filename.endswith("-swell.pdf")
    assert "title: Her ball" in page.evaluate("page.document.text")
    until(lambda: "5 files are ready." in panel.inner_text(), "made")
    assert len(done) <= 12, done
    with page.expect_download() as waited:
        panel.locator("#export-zip").click()
    with ZipFile(waited.value.path()) as files:
        assert sorted(Path(each).name.rpartition("-swell")[2] for each in files.namelist()) == [
            "-ink.pdf", "-ink.svg", "-key.svg", ".pdf", ".svg",
        ]  # fmt: skip
        key = files.read(next(each for each in files.namelist() if each.endswith("-key.svg"))).decode()
        assert all(f'aria-label="{name}"' in key for name in ("ball", "table", "wall"))
        pdf = files.read(next(each for each in files.namelist() if each.endswith("swell.pdf")))
        assert pdf.startswith(b"%PDF") and pdf.count(b"/Type /Page\n") + pdf.count(b"/Type /Page ") >= 2


def press(page: "Page", *keys: str) -> None:
    for key in keys:
        page.keyboard.press(key)


def focus_id(page: "Page") -> str:
    return page.evaluate("document.activeElement.id")


def name_part(page: "Page", name: str) -> None:
    """Write the name of the part that is selected in the list, and go back to the list."""
    press(page, "Enter")
    page.keyboard.type(name)
    press(page, "Enter")
    assert name in names(page)
    page.locator("#parts-list").focus()  # where others have no name, theirs is next


def cross(page: "Page", x: int, y: int) -> None:
    """Bring the crosshair to a pixel, by keys, as it says itself where it is."""
    page.keyboard.press("i")
    across, down = (int(word.split(" %")[0]) for word in page.locator("#parts-told").inner_text().split(", ")[:2])
    steps = [(x - round(across * WIDTH / 100), "Right", "Left"), (y - round(down * HEIGHT / 100), "Down", "Up")]
    for by, forward, back in steps:
        page.keyboard.down("Shift")
        for _ in range(abs(by)):
            page.keyboard.press(f"Arrow{forward if by > 0 else back}")
        page.keyboard.up("Shift")


def step_to(page: "Page", name: str) -> bool:
    if page.locator("#parts-list [aria-selected=true] .name").inner_text() == name:
        return True
    press(page, "ArrowDown" if name not in names(page)[: row_of_selection(page)] else "ArrowUp")
    return False


def row_of_selection(page: "Page") -> int:
    rows = page.locator("#parts-list > li")
    return rows.evaluate_all("(all) => all.findIndex((each) => each.ariaSelected === 'true')")


def focus_on(page: "Page", region: str) -> bool:
    page.keyboard.press("F6")
    return page.locator(f"#{region}").evaluate("(each) => each.contains(document.activeElement)")


def tab_to(page: "Page", what: str) -> bool:
    page.keyboard.press("Tab")
    return page.locator(what).evaluate("(each) => each === document.activeElement")


def enter(page: "Page", what: str) -> None:
    until(lambda: tab_to(page, what), what)
    page.keyboard.press("Enter")
