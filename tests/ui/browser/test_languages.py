"""The page in other languages: in German nothing of it is English, what the program writes included."""

from collections.abc import Callable
from pathlib import Path

from browser_tabs import OpenPage
from english import english_of
from page_panels import show_everything
from sessions import striped_scene
from tangible_core.translation.catalogue import catalogue
from waiting import until

TEXTS = """() => {
  const hidden = "script, style, textarea, code, kbd, [lang]:not(html), .path, option";
  const walker = document.createTreeWalker(document.body, NodeFilter.SHOW_TEXT);
  const texts = new Set();
  while (walker.nextNode()) {
    const { data, parentElement } = walker.currentNode;
    if (!parentElement.closest(hidden)) texts.add(data.trim());
  }
  const attributes = ["aria-label", "title", "placeholder", "alt", "aria-description"];
  for (const each of document.querySelectorAll(attributes.map((name) => `[${name}]`).join())) {
    if (!each.closest(hidden)) for (const name of attributes) texts.add(each.getAttribute(name) ?? "");
  }
  return [...texts].filter(Boolean);
}"""


def untranslated(text: str) -> bool:
    """Whether a text is one of the catalogue's, or a number, and not in German."""
    own = catalogue("de").find(text)
    return own is not None and own != text and " " in text and ": " not in text


def test_the_page_in_german_has_no_english(opened: Callable[..., str], open_page: OpenPage, tmp_path: Path) -> None:
    """All panels are open; verdicts, places, cures, files with decisions, warnings and a mistake are on the page."""
    page = open_page("about:blank", locale="de-DE")
    page.goto(opened(striped_scene(tmp_path)) + "&measure")
    until(lambda: page.locator("#status").get_attribute("data-state") == "felt", "felt")
    show_everything(page)
    for each in ("3D-Druck (STL)", "Schwellpapier (SVG, PDF)", "Beschreibung (Text, HTML)"):
        page.get_by_label(each).first.check()
    page.locator("#export-run").click()
    page.wait_for_selector("#export .outcome", state="attached")
    page.locator("#legible-check").click()
    page.wait_for_selector("#legible .sentence")
    page.locator("#preflight-check").evaluate("(each) => each.click()")
    page.wait_for_selector("#preflight .sentence", state="attached")
    show_everything(page)
    texts = page.evaluate(TEXTS)
    assert len(texts) > 500
    assert [each for each in texts if english_of(each) or untranslated(each)] == []
