"""The page until a force is felt; and its panels, brought to the screen from the task or the settings."""

from pathlib import Path
from typing import TYPE_CHECKING

from browser_tabs import SETTLED
from waiting import until

if TYPE_CHECKING:
    from playwright.sync_api import Locator, Page

PLACE = "(each) => each.closest('[role=tabpanel], #right, #bottom, #always').id"
FILLED = "() => [...document.querySelectorAll('.panel > .inside')].every((each) => each.childElementCount)"
EVERYTHING = """() => {
  document.body.classList.add("advanced");
  for (const each of document.querySelectorAll("[role=tabpanel]")) each.hidden = false;
  for (const each of document.querySelectorAll("details")) each.open = true;
}"""
SPY = """
window.heard = [];
new MutationObserver((seen) => {
  for (const each of seen) if (each.target.closest?.("#said, #alerted")) heard.push(each.target.textContent);
}).observe(document, { childList: true, subtree: true });
"""
"""Keeps in `heard` what a screen reader is told."""


def wait_for_force(page: "Page") -> None:
    """Wait until forces are given; if they never are, tell what the page says."""
    from playwright.sync_api import TimeoutError as Late

    try:
        page.wait_for_function("() => document.querySelector('#status').dataset.state === 'felt'")
    except Late:
        raise AssertionError(page.locator("body").inner_text()) from None


def bring(page: "Page", panel: str) -> "Locator":
    """Choose the task in which a panel stands, or Advanced, by the keyboard; return the panel."""
    box = page.locator(f"#{panel}")
    place = box.evaluate(PLACE)
    if place.startswith("task-"):
        page.locator(f"#tab-{place.removeprefix('task-')}").press("Enter")
    elif place != "always" and page.locator("#advanced").get_attribute("aria-pressed") == "false":
        page.locator("#advanced").press("Enter")
    return box


def open_panel(page: "Page", panel: str) -> "Locator":
    """Bring a panel to the screen and open it by the keyboard; what is loaded then is there."""
    box = bring(page, panel)
    if box.get_attribute("open") is None:
        box.locator("> summary").press("Enter")
    until(lambda: box.locator("> .inside > *").count() > 0, panel)
    return box


def list_folder(page: "Page", folder: Path, name: str) -> "Locator":
    """List a folder of this computer by the keyboard; return its entries, one of which has this name."""
    box = open_panel(page, "open").locator("details", has_text="Folder of this computer")
    box.locator("summary").press("Enter")
    page.locator("#open-folder").fill(str(folder))
    page.locator("#open-folder").press("Enter")
    entries = page.locator("#open-entries")
    until(lambda: entries.locator(f"option[value='{name}']").count() == 1)
    return entries


def show_everything(page: "Page") -> None:
    """Show the panels of all tasks and all settings at once, open, as no person sees them."""
    page.locator("#tab-hand-on").press("Enter")  # what is loaded when it is seen
    page.evaluate(EVERYTHING)
    page.wait_for_function(FILLED)
    page.evaluate(EVERYTHING)  # what came meanwhile
    page.evaluate(SETTLED)
