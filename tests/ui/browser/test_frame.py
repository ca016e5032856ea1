"""The frame of the page: the head, the start, notices, the command palette, and how all of it fits the screen."""

from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image

from browser_tabs import SETTLED, OpenPage
from needed import lacking
from page_files import WEB
from page_panels import bring, list_folder, open_panel, wait_for_force
from sessions import small_scene
from waiting import until

if TYPE_CHECKING:
    from playwright.sync_api import Page

AXE = WEB / "node_modules/axe-core/axe.min.js"
HEAD = """
window.head = [];
new MutationObserver(() => {
  const text = document.getElementById("status")?.textContent;
  if (text && text !== head.at(-1)) head.push(text);
}).observe(document, { childList: true, subtree: true, characterData: true });
"""
"""Lists what the head has said."""
CORNERS = """() => {
  const { extent_m: [w, l], height_m } = page.scene.meta;
  const { left, top } = document.getElementById("terrain").getBoundingClientRect();
  return [-w / 2, w / 2].flatMap((x) => [-l / 2, l / 2].flatMap((y) => height_m.map((z) => {
    const [u, v] = page.view.toScreen([x, y, z]);
    return [left + u, top + v];
  })));
}"""
"""Corners of the surface in the window."""
COVERED = """() => {
  const stop = document.getElementById("stop").getBoundingClientRect();
  const controls = [...document.querySelectorAll("button, select, input, textarea, summary, canvas")];
  return controls.filter((each) => {
    const box = each.getBoundingClientRect();
    const over = box.left < stop.right && box.right > stop.left && box.top < stop.bottom && box.bottom > stop.top;
    return over && each.id !== "stop" && each.checkVisibility() && !each.closest(".region, .visually-hidden, #strip *");
  }).map((each) => each.outerHTML.slice(0, 80));
}"""
"""Controls in sight that the stop button covers; those of the panels scroll under the head."""
SMALL = {"phone": (390, 844), "zoomed to 200 %": (640, 400), "zoomed to 200 % of a notebook": (683, 384)}


@pytest.fixture
def page(opened: Callable[..., str], open_page: OpenPage, tmp_path: Path) -> "Page":
    page = open_page("about:blank")
    page.add_init_script(HEAD)
    page.goto(opened(small_scene(tmp_path)) + "&measure")
    wait_for_force(page)
    until(lambda: page.evaluate("page.scene !== null"))
    return page


def box_of(page: "Page", what: str) -> dict[str, float]:
    box = page.locator(what).bounding_box()
    assert box, what
    return {**box, "right": box["x"] + box["width"], "bottom": box["y"] + box["height"]}


def test_lost_connection_is_said_until_it_is_back_and_then_what_is_felt(page: "Page"):
    page.evaluate("page.net.socket.close()")
    lost = "No answer; trying again."
    until(lambda: page.evaluate("(lost) => head.includes(lost)", lost), "lost")
    until(lambda: page.evaluate("head.at(-1)") == "Feeling: penalty", "what is felt is said again")
    head = page.evaluate("head")
    back, felt = head[head.index(lost) + 1 :]
    assert back == "Connected again. Feeling: penalty"
    assert felt == "Feeling: penalty"
    assert page.locator("#status").get_attribute("data-state") == "felt"


def test_palette_reaches_commands_panels_views_and_keys_in_both_languages(page: "Page"):
    box, options = page.locator("#palette-input"), page.locator("#palette-list > [role=option]")

    def find(text: str) -> str:
        page.keyboard.press("Control+k")
        box.wait_for()
        box.fill(text)
        chosen = options.first
        assert box.get_attribute("aria-activedescendant") == chosen.get_attribute("id")
        assert chosen.get_attribute("aria-selected") == "true"
        return chosen.inner_text()

    page.locator("#terrain").focus()
    assert page.locator("#legible .inside").inner_html() == "", "panels of a task that nobody has seen are not built"
    find("Jetzt prüfen")
    until(lambda: "Check now" in options.first.inner_text(), "controls of panels are found before they were ever open")
    box.fill("3D-Druck (STL)")
    until(lambda: "3D print (STL)" in options.first.inner_text(), "also what the server knows")
    box.fill("Jetzt prüfen")
    page.keyboard.press("Enter")
    until(lambda: page.evaluate("document.activeElement.id") == "legible-check", "and used")
    page.locator("#terrain").focus()
    assert "Data" not in find("Hören der Höhen") and "H" in options.first.locator("kbd").all_inner_texts()
    page.keyboard.press("ArrowDown")
    assert box.get_attribute("aria-activedescendant") == options.nth(1).get_attribute("id")
    page.keyboard.press("Control+k")
    assert not box.is_visible(), "its key closes it too"
    assert page.evaluate("document.activeElement.id") == "terrain"

    assert "Mapping" not in find("force laws panel")
    page.keyboard.press("Enter")
    assert page.evaluate("document.activeElement.closest('.panel').id") == "laws"
    assert page.locator("#task-feel").is_visible()
    find("zeigen Steigungen")
    page.keyboard.press("Enter")
    until(lambda: page.locator("#look").input_value() == "slope", "a view")
    find("Streiflicht")
    page.keyboard.press("Enter")
    assert page.evaluate("document.activeElement.type") == "range", "a setting behind Advanced"
    assert page.locator("#right").is_visible()
    find("Aufgabe Weitergeben")
    page.keyboard.press("Enter")
    assert page.locator("#tab-hand-on").get_attribute("aria-selected") == "true"
    find("in die Mitte bringen")
    page.keyboard.press("Enter")
    until(lambda: page.evaluate("page.hand.at !== null"), "a key of the surface")

    find("Undo")
    if not AXE.is_file():
        lacking("axe-core is not installed: npm ci in plugins/ui/web")
    page.evaluate(AXE.read_text(encoding="utf-8"))
    found = page.evaluate("axe.run(document.getElementById('palette'), { resultTypes: ['violations'] })")
    assert [each["id"] for each in found["violations"]] == []
    box.fill("xqzj")
    assert page.get_by_text("Nothing has this name.").first.is_visible()
    page.keyboard.press("Escape")
    assert page.locator("#palette").count() == 0
    until(lambda: page.locator("#status").get_attribute("data-state") == "stopped", "Escape stops, as everywhere")
    assert page.locator("#again").is_visible()


def test_surface_keeps_half_of_a_small_screen_and_the_stop_button_covers_nothing(page: "Page"):
    for name, (width, height) in SMALL.items():
        page.set_viewport_size({"width": width, "height": height})
        page.evaluate(SETTLED)
        for scrolled in (0, 10_000):
            page.evaluate("(y) => scrollTo(0, y)", scrolled)
            page.evaluate(SETTLED)
            stop, head, surface = (box_of(page, each) for each in ("#stop", "#head", "#scenery"))
            assert head["y"] == 0 and head["height"] <= 64, (name, "the head is one line")
            assert stop["y"] >= 0 and stop["bottom"] <= head["bottom"] and stop["right"] <= width, name
            seen = min(surface["bottom"], height) - max(surface["y"], head["bottom"])
            assert seen >= height / 2, (name, scrolled, seen)
            assert page.evaluate(COVERED) == [], name
    page.set_viewport_size({"width": 390, "height": 844})
    page.locator("#help > summary").focus()
    page.evaluate(SETTLED)
    focused, strip = box_of(page, "#help > summary"), box_of(page, "#strip")
    assert focused["y"] >= strip["bottom"], "what has the focus is not under the surface"


def test_surface_is_shown_whole_beside_what_lies_on_the_canvas(page: "Page"):
    """The line that says how to feel, which goes once somebody has felt; the scale; and all values."""
    page.set_viewport_size({"width": 1100, "height": 700})  # the canvas is 640 pixels wide where it is measured
    names = page.locator("#strip .short th").all_inner_texts()
    assert names == ["Force", "Material", "Height"] and page.locator("#data-cursor > .all").is_hidden()
    page.locator("#data-cursor > summary").press("Enter")
    hint = page.locator("#how-to-feel")
    assert "hold its button down" in hint.inner_text()

    def clear() -> bool:
        corners = np.array(page.evaluate(CORNERS))
        canvas, bar, values = (box_of(page, each) for each in ("#terrain", ".scale-bar", "#data-cursor > .all"))
        top = box_of(page, "#how-to-feel")["bottom"] if hint.is_visible() else canvas["y"]
        return bool(
            corners[:, 0].min() > canvas["x"]
            and corners[:, 0].max() < values["x"]
            and corners[:, 1].min() > top
            and corners[:, 1].max() < bar["y"]
        )

    until(clear, "nothing covers it")
    page.locator("#terrain").focus()
    page.keyboard.press("Home")
    page.keyboard.press(" ")
    until(lambda: not hint.is_visible(), "somebody has felt")
    until(clear, "nor then")


def test_start_without_a_file_offers_three_tiles_until_a_file_is_opened(page: "Page"):
    """The server tells so with its first message; here the page is told by hand."""
    page.evaluate("page.hub.tell('hello', { ...page.hub.last('hello'), history: [], scene: null, empty: true })")
    start = page.get_by_role("region", name="What do you want to feel?")
    start.wait_for()
    assert start.locator("h3").all_inner_texts() == ["A picture of mine", "An example", "A pipeline file"]
    with page.expect_file_chooser() as chooser:
        start.get_by_role("button", name="Choose a picture").click()
    assert chooser.value.is_multiple()
    start.get_by_role("button", name="Choose from a folder").press("Enter")
    assert page.evaluate("document.activeElement.id") == "open-folder"
    until(lambda: page.locator("#open-folder").input_value() != "", "the folder is listed")
    start.get_by_role("button", name="coins").press("Enter")
    until(lambda: start.count() == 0, "it makes room for the surface")
    assert page.evaluate("document.activeElement.id") == "terrain"


def test_newest_folder_that_was_asked_for_stays_listed_when_an_older_answer_comes_last(page: "Page", tmp_path: Path):
    (tmp_path / "newest.npy").touch()
    page.evaluate(
        """() => {
          const { net } = page;
          const ask = net.ask.bind(net);
          window.late = new Promise((done) => (window.let_go = done));
          net.ask = async (name, args) => {
            const answer = await ask(name, args);
            if (name === "folder" && !args.path) await late;
            return answer;
          };
        }"""
    )
    entries = list_folder(page, tmp_path, "newest.npy")
    page.evaluate("let_go(), new Promise((done) => setTimeout(done))")
    assert entries.locator("option[value='newest.npy']").count() == 1
    assert page.locator("#open-folder").input_value() == str(tmp_path)


def test_folder_that_was_typed_is_listed_if_its_box_only_then_says_that_it_is_open(page: "Page", tmp_path: Path):
    """A browser queues the event: on a slow machine it comes after the keys."""
    (tmp_path / "typed.npy").touch()
    folder = open_panel(page, "open").locator("details", has_text="Folder of this computer")
    folder.evaluate(
        "(box) => box.addEventListener('toggle', (event) => event.isTrusted && event.stopImmediatePropagation(), true)"
    )
    folder.locator("summary").press("Enter")
    page.locator("#open-folder").fill(str(tmp_path))
    folder.evaluate("(box) => box.dispatchEvent(new Event('toggle'))")
    until(lambda: page.locator("#open-entries option").count())
    assert page.locator("#open-entries option[value='typed.npy']").count() == 1
    assert page.locator("#open-folder").input_value() == str(tmp_path)


def test_photograph_without_depth_has_a_notice_that_leads_on(
    opened: Callable[..., str], open_page: OpenPage, tmp_path: Path
):
    picture = np.full((60, 80, 3), 40, np.uint8)
    picture[15:45, 20:60] = 220
    Image.fromarray(picture).save(tmp_path / "square.png")
    page: Any = open_page(opened(tmp_path / "square.png") + "&measure")
    notice = page.locator("#no-depth")
    until(notice.is_visible, "over the surface")
    assert "from edges, not from depth" in notice.inner_text()
    assert notice.bounding_box()["y"] < page.locator("#terrain").bounding_box()["y"]
    notice.get_by_role("button", name="How to get depth").press("Enter")
    assert "second photograph" in page.locator("#how-to-get-depth").inner_text()
    assert "edges" in bring(page, "found").inner_text()
    notice.get_by_role("button", name="Draw its parts").press("Enter")
    page.wait_for_selector("#parts-list [role=option]")
    assert not notice.is_visible(), "it would cover the editor's small surface"
    page.locator("#parts-editor").get_by_role("button", name="Close").click()
    until(lambda: page.locator("#parts-editor").count() == 0 or page.locator("dialog").count() > 0)
    if page.locator("dialog").count():
        page.locator("dialog button").last.click()
    until(lambda: page.locator("#parts-editor").count() == 0)
    notice.get_by_role("button", name="Close this note").press("Enter")
    assert notice.is_hidden()
    open_panel(page, "open").get_by_role("button", name="coins").press("Enter")
    until(lambda: "coins" in (page.locator("#terrain").get_attribute("aria-label") or ""), "another picture")
