"""The main tasks of the page that no other test does, by the keyboard alone, and its panel of networks."""

import hashlib
import os
import shlex
from pathlib import Path
from typing import TYPE_CHECKING

import pytest

from browser_tabs import OpenPage
from page_files import built_page
from page_panels import list_folder, open_panel, wait_for_force
from sessions import small_scene
from tangible_study.study_file import load_study
from waiting import until

if TYPE_CHECKING:
    from playwright.sync_api import Page


@pytest.fixture
def page(opened, open_page: OpenPage, tmp_path: Path) -> "Page":
    page = open_page(opened(small_scene(tmp_path)))
    wait_for_force(page)
    until(lambda: "mine" in (page.locator("#terrain").get_attribute("aria-label") or ""))  # keys find the surface
    return page


def press(page: "Page", panel: str, name: str) -> None:
    """Open a panel and press one of its buttons."""
    open_panel(page, panel).get_by_role("button", name=name, exact=True).first.press("Enter")


def says(page: "Page", panel: str, text: str) -> None:
    until(lambda: text in page.locator(f"#{panel}").inner_text())


def test_depth_and_texture_are_run_separately(page: "Page") -> None:
    for name in ("Run depth", "Run texture"):
        press(page, "methods", name)
        until(lambda: page.locator("#status").get_attribute("data-state") in ("idle", "felt"))
    until(lambda: page.locator("#look option[value=segments]").count() == 1)
    press(page, "methods", "Make and feel")
    wait_for_force(page)


def test_preflight_cure_corrects_the_document(page: "Page") -> None:
    open_panel(page, "yaml")
    before = page.locator("#yaml-text").input_value()
    page.locator("#yaml-text").fill(
        before.replace("texture: {use: gabor, segments: 3}\n", "").replace("_m: 400}", "_m: 40000}")
    )
    until(lambda: "Not applied yet" in page.locator("#yaml-state").inner_text())
    until(lambda: "No errors" in page.locator("#yaml-state").inner_text())
    press(page, "preflight", "Check now")
    softer = page.locator("#preflight button", has_text="Make the surface softer: ")
    until(lambda: softer.count() > 0)
    softer.first.press("Enter")
    until(lambda: "40000" not in page.locator("#yaml-text").input_value())


def test_stroke_is_recorded_played_and_replayed_with_another_law(page: "Page") -> None:
    press(page, "records", "Record touch")
    until(lambda: "Recording: " in page.locator("#records").inner_text())
    wait_for_force(page)
    surface = page.locator("#terrain")
    surface.focus()
    surface.press("Home")
    surface.press(" ")
    page.locator("#data-cursor").evaluate("(each) => (each.open = true)")
    until(lambda: "Collision" in page.locator("#data-cursor").inner_text())
    until(lambda: "yes" in page.locator("#data-cursor").inner_text())
    page.wait_for_timeout(500)
    surface.press(" ")
    press(page, "records", "Stop recording")
    says(page, "records", "Recorded: ")
    until(lambda: page.locator("#records-list option").count() == 1)
    page.locator("#records-list").press("ArrowDown")
    press(page, "records", "Show")
    place = page.locator("#records-place")
    until(place.is_visible)
    place.press("End")
    until(lambda: float(place.input_value()) > 0.4)
    press(page, "records", "Play")
    press(page, "records", "Back to the live surface")
    until(lambda: not place.is_visible())
    page.locator("#records-list").press("ArrowDown")
    press(page, "records", "Replay with the current force law")
    until(lambda: page.locator("#records-list option").count() == 2)
    says(page, "records", "worst error n")


def test_two_laws_are_compared_and_a_blind_study_of_them_is_written(page: "Page") -> None:
    open_panel(page, "laws")
    until(lambda: page.locator("#laws-other option").count() > 3)
    page.locator("#laws-options").fill("{stiffness_n_per_m: 200}")
    page.locator("#laws-other").press("p")
    press(page, "laws", "Compare")
    says(page, "laws", "You feel a: ")
    page.locator("#laws button", has_text="b: ").press("Enter")
    says(page, "laws", "You feel b: ")
    page.locator("#laws-question").press("ArrowDown")
    press(page, "laws", "Write a blind study of both laws")
    says(page, "laws", "The study is written: ")
    run, _ = page.locator("#laws pre").all_inner_texts()
    _, _, _, file, *_ = shlex.split(run)
    study = load_study(Path(file)).study
    assert (study.comparisons[0].question, len(study.conditions)) == ("rougher", 2)
    press(page, "laws", "End the comparison")
    until(page.locator("#laws-other").is_visible)


def test_enlarged_region_is_saved_and_opens_the_same(page: "Page", tmp_path: Path) -> None:
    page.locator("#terrain").focus()
    page.keyboard.press("z")
    open_panel(page, "yaml")
    text = page.locator("#yaml-text")
    until(lambda: "region_m" in text.input_value())
    zoomed = text.input_value()
    open_panel(page, "save").locator("#save-path").fill(str(tmp_path / "zoomed.yaml"))
    press(page, "save", "Save")
    until((tmp_path / "zoomed.yaml").is_file)
    page.locator("#terrain").focus()
    page.keyboard.press("Shift+Z")
    until(lambda: "region_m" not in text.input_value())
    entries = list_folder(page, tmp_path, "zoomed.yaml")
    entries.select_option("zoomed.yaml")
    entries.press("Enter")
    until(lambda: text.input_value() == zoomed)


CONTENT = b"a network of mine"
DIGEST = hashlib.sha256(CONTENT).hexdigest()
CARD = f"title: Mine\ntask: figure\nsha256: {DIGEST}\nlicence: ours\noutput: {{means: figure}}\n"


@pytest.mark.whole
def test_network_is_added_from_a_file_checked_and_removed(serve, open_page, tmp_path: Path) -> None:
    built_page()
    models = tmp_path / "models"
    models.mkdir()
    (models / "mine.yaml").write_text(CARD)
    page = open_page(serve(small_scene(tmp_path), TANGIBLE_MODELS_DIR=str(models)).url)
    box = open_panel(page, "networks")
    item = box.locator("li", has_text="Licence: ours")
    status, kept = page.locator("#networks-status"), models / "mine.onnx"

    def give(content: bytes) -> None:
        item.get_by_label("From a file: Mine").set_input_files({"name": "m.onnx", "mimeType": "", "buffer": content})

    give(b"another network")
    until(lambda: "Mine: the file is not the one that its card describes" in status.inner_text())
    assert not kept.exists() and "not here" in item.inner_text()
    give(CONTENT)
    until(lambda: "Done." in status.inner_text())
    until(lambda: item.get_by_role("button", name="Remove Mine").count() == 1)
    when_ns = kept.stat().st_mtime_ns
    kept.write_bytes(CONTENT[::-1])
    os.utime(kept, ns=(when_ns, when_ns))
    box.get_by_role("button", name="Check all").press("Enter")
    until(lambda: "Damaged: Mine" in status.inner_text())
    give(CONTENT)
    until(lambda: item.get_by_role("button", name="Remove Mine").count() == 1)
    item.get_by_role("button", name="Remove Mine").press("Enter")
    until(lambda: "Mine was removed." in status.inner_text())
    assert not kept.exists() and list(models.iterdir()) == [models / "mine.yaml"]
    assert "mine.onnx" not in box.inner_text() and box.locator("#networks-add").is_visible()
