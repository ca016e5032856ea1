"""The frame of the page, and its languages: otherwise a start leads nowhere, or a text stays English."""

import re
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest
from PIL import Image

from browser_tabs import SETTLED, OpenPage
from english import english_of
from page_panels import bring, show_everything, wait_for_force
from sessions import small_scene, striped_scene
from tangible_core.translation.catalogue import catalogue
from tangible_legibility.words.languages import TABLES
from waiting import until

if TYPE_CHECKING:
    from playwright.sync_api import Page

HEAD = """
window.head = [];
new MutationObserver(() => {
  const text = document.getElementById("status")?.textContent;
  if (text && text !== head.at(-1)) head.push(text);
}).observe(document, { childList: true, subtree: true, characterData: true });
"""
"""Lists what the head has said."""
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
    assert (back, felt) == ("Connected again. Feeling: penalty", "Feeling: penalty")
    assert page.locator("#status").get_attribute("data-state") == "felt"


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


def test_start_without_a_file_offers_three_tiles_until_a_file_is_opened(page: "Page"):
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


def test_photograph_without_depth_has_a_notice_that_leads_on(
    opened: Callable[..., str], open_page: OpenPage, tmp_path: Path
):
    picture = np.random.default_rng(0).integers(0, 90, (60, 80, 3), np.uint8)  # noise: no drawing
    picture[15:45, 20:60] += 150
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


GERMAN_MATERIALS = set(TABLES["de"].materials.values())
TEXTS = """(roots) => {
  const hidden = "script, style, textarea, code, kbd, [lang]:not(html), .path, option";
  const texts = new Set();
  const attributes = ["aria-label", "title", "placeholder", "alt", "aria-description"];
  for (const root of document.querySelectorAll(roots)) {
    const walker = document.createTreeWalker(root, NodeFilter.SHOW_TEXT);
    while (walker.nextNode()) {
      const { data, parentElement } = walker.currentNode;
      if (!parentElement.closest(hidden)) texts.add(data.trim());
    }
    for (const each of root.querySelectorAll(attributes.map((name) => `[${name}]`).join())) {
      if (!each.closest(hidden)) for (const name of attributes) texts.add(each.getAttribute(name) ?? "");
    }
  }
  return [...texts].filter(Boolean);
}"""


FIELDS = "[...document.querySelectorAll('input:not([type=number], [type=range])')].map(({ value }) => value)"


def untranslated(text: str, language: str) -> bool:
    """Whether a text is one of the catalogue's, or a number, and not in the language."""
    own = catalogue(language).find(text)
    return own is not None and own != text and " " in text and ": " not in text


def test_the_page_in_german_has_no_english(opened: Callable[..., str], open_page: OpenPage, tmp_path: Path) -> None:
    page = open_page("about:blank", locale="de-DE")
    page.goto(opened(striped_scene(tmp_path)) + "&measure")
    wait_for_force(page)
    show_everything(page)
    library = page.locator("#materials .wide tbody th")
    until(lambda: set(library.all_inner_texts()) == GERMAN_MATERIALS, "the library of materials")
    for each in ("3D-Druck (STL)", "Schwellpapier (SVG, PDF)", "Beschreibung (Text, HTML)"):
        page.get_by_label(each).first.check()
    page.locator("#export-run").click()
    page.wait_for_selector("#export .outcome", state="attached")
    page.locator("#legible-check").click()
    page.wait_for_selector("#legible .sentence")
    page.locator("#preflight-check").evaluate("(each) => each.click()")
    page.wait_for_selector("#preflight .sentence", state="attached")
    show_everything(page)
    texts = page.evaluate(TEXTS, "body")
    assert len(texts) > 500
    assert [text for text in texts if english_of(text) or untranslated(text, "de")] == []
    assert [text for text in texts + page.evaluate(FIELDS) if re.fullmatch(r"-?\d+\.\d+( [^.]*)?\.?", text)] == []


def test_the_main_tasks_in_french_have_no_english(
    opened: Callable[..., str], open_page: OpenPage, tmp_path: Path
) -> None:
    """The head, the four tasks with verdicts and cures, help and log; not options, and not what drivers lack."""
    page = open_page("about:blank", locale="fr-FR")
    page.goto(opened(striped_scene(tmp_path)) + "&measure")
    wait_for_force(page)
    assert page.locator("#status").inner_text().startswith("Au toucher")
    show_everything(page)
    page.locator("#legible-check").click()
    page.wait_for_selector("#legible .sentence")
    page.locator("#preflight-check").evaluate("(each) => each.click()")
    page.wait_for_selector("#preflight .sentence", state="attached")
    page.evaluate("document.querySelectorAll('.exporters .more, ul.devices').forEach((each) => each.remove())")
    texts = page.evaluate(TEXTS, "#head, #left, #strip, #bottom, #preflight, #stages, #view, #overlay-panel")
    assert len(texts) > 300
    english = [text for text in texts if english_of(text) or untranslated(text, "fr")]
    assert not english, "\n".join(english)
    assert "partie 1" in page.locator("#description").inner_text()
