"""The page hands a picture on: otherwise files are broken, or nobody hears what fingers cannot read."""

import io
from collections.abc import Callable
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zipfile import ZipFile

import pytest

from browser_tabs import OpenPage
from page_panels import SPY, open_panel, wait_for_force
from sessions import small_scene, striped_scene
from waiting import until

if TYPE_CHECKING:
    from playwright.sync_api import Download, Page


@pytest.fixture
def show(opened: Callable[..., str], open_page: OpenPage, tmp_path: Path) -> Callable[..., "Page"]:
    """The page with the small scene felt; `before` runs in it first, what is `said` more stands in its file."""

    def show(said: str = "", before: str = "", scene: Callable[[Path], Path] = small_scene, **options: Any) -> "Page":
        file = scene(tmp_path)
        file.write_text(file.read_text() + said)
        page = open_page("about:blank", **options)
        page.add_init_script(SPY + before)
        page.goto(opened(file) + "&measure")
        wait_for_force(page)
        return page

    return show


def content_of(download: "Download") -> bytes:
    path = download.path()
    return Path(path).read_bytes()


def text_of(page: "Page") -> str:
    return page.evaluate("page.document.text")


class TestExport:
    def test_export_of_a_solid_and_a_zip_works_by_the_keyboard(self, show: Callable[..., "Page"]) -> None:
        import trimesh

        page = show()
        panel = open_panel(page, "export")
        panel.get_by_label("3D print (STL)").press(" ")
        panel.get_by_label("3D print (3MF)").press(" ")
        panel.get_by_label("Swell paper").press(" ")  # it is chosen at first
        panel.locator("summary", has_text="3D print (STL)").press("Enter")
        longer = panel.get_by_label("Longer side").first
        longer.fill("5 cm")
        longer.press("Enter")
        shown = panel.locator(".previews img")
        drawn = "(all) => all.map((each) => each.naturalWidth)"
        until(lambda: shown.count() == 2 and all(shown.evaluate_all(drawn)), "pictures before anything is made")
        caption = panel.locator("figcaption").first
        until(lambda: "3D print (STL): the picture is 5.0 cm wide" in caption.inner_text(), "of the last choice")
        panel.get_by_role("button", name="Export", exact=True).press("Enter")
        until(lambda: "2 files are ready." in panel.inner_text(), "files")
        until(lambda: page.evaluate("document.activeElement.id") == "export-status", "the focus is at the result")
        with page.expect_download() as waited:
            panel.get_by_role("link", name="mine.stl").press("Enter")
        assert waited.value.suggested_filename == "mine.stl"
        solid: Any = trimesh.load(io.BytesIO(content_of(waited.value)), file_type="stl")
        assert solid.is_volume
        rim_mm = 2 * 6.0
        assert solid.extents[0] == pytest.approx(50.0 + rim_mm, abs=1e-3)

        with page.expect_download() as waited:
            panel.get_by_role("button", name="Download all as ZIP").press("Enter")
        assert waited.value.suggested_filename == "mine.zip"
        with ZipFile(io.BytesIO(content_of(waited.value))) as packed:
            assert packed.namelist() == ["mine.3mf", "mine.stl"]
            assert packed.testzip() is None


class TestLegible:
    def test_legibility_fault_is_marked_announced_and_cured(self, show: Callable[..., "Page"]) -> None:
        page = show("simplify: {gap_m: 0, part_m: 0}\n", scene=striped_scene)
        panel = open_panel(page, "legible")
        panel.get_by_label("Read on").select_option("swell")
        panel.get_by_label("Width, mm").fill("80")
        panel.get_by_role("button", name="Check now").press("Enter")
        until(lambda: panel.locator(".sentence.illegible").count() == 1, "judged")
        assert "80 mm wide, its parts simplified as “Export” draws them" in panel.inner_text()
        until(lambda: page.evaluate("heard.some((each) => each.startsWith('Illegible'))"), "said")
        places = panel.locator(".places button")
        marks = page.locator(".overlay .fault")
        assert marks.all_inner_texts() == places.all_inner_texts() == [str(n + 1) for n in range(marks.count())]
        until(lambda: marks.first.is_visible(), "marked")
        at, surface = marks.first.bounding_box(), page.locator("#terrain").bounding_box()
        assert at and surface
        assert surface["x"] < at["x"] < surface["x"] + surface["width"]
        places.first.focus()
        until(lambda: "pointed" in (marks.first.get_attribute("class") or ""), "which one")
        places.first.press("Enter")
        until(lambda: page.evaluate("heard.some((each) => /^Place 1: [0-9]+ % from the left/.test(each))"), "where")
        assert places.first.get_attribute("aria-label").startswith("1: ")
        panel.evaluate("(each) => (each.open = false)")
        until(lambda: not marks.first.is_visible(), "the marks leave with their panel")
        panel.evaluate("(each) => (each.open = true)")
        until(lambda: marks.first.is_visible(), "and come with it")

        before = text_of(page)
        panel.get_by_role("button", name="Simplify the parts").press("Enter")
        until(lambda: panel.locator(".sentence.ok").count() == 1, "cured")
        assert page.evaluate("page.document.said.simplify.gap_m") == 0.0032
        assert marks.count() == places.count() == 0
        open_panel(page, "methods").locator("#undo").press("Enter")
        until(lambda: text_of(page) == before, "undone in one step")
        until(lambda: "changed since this check" in panel.inner_text(), "stale")


class TestBeacon:
    def test_touch_is_announced_with_part_and_material(self, show: Callable[..., "Page"]) -> None:
        page = show("parts: {1: {name: wall, material: ice}}\nmaterials: {by: {2: ice}, default: ice}\n")
        page.locator("#terrain").focus()
        page.keyboard.press("Home")
        page.keyboard.press(" ")
        until(lambda: page.evaluate("heard.some((each) => /^Touching .*ice/.test(each))"), "said")
