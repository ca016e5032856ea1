"""The page in other languages: otherwise a pupil in a German or French class meets English."""

import re
from collections.abc import Callable
from pathlib import Path

from browser_tabs import OpenPage
from english import english_of
from page_panels import show_everything, wait_for_force
from sessions import striped_scene
from tangible_core.translation.catalogue import catalogue
from tangible_legibility.words.languages import TABLES
from waiting import until

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
