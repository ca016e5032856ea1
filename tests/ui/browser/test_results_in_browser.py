"""The page hands a picture on: whole files, what fingers cannot read and its cure, words, and a way to a part."""

import io
import os
import threading
from collections.abc import Callable
from contextlib import suppress
from pathlib import Path
from typing import TYPE_CHECKING, Any
from zipfile import ZipFile

import pytest

from browser_tabs import OpenPage
from lasting_server import LastingServer
from page_panels import bring, open_panel, wait_for_force
from sessions import small_scene, striped_scene
from tangible_core.errors import DeviceError
from tangible_devices.pointer import PointerClient
from waiting import until

if TYPE_CHECKING:
    from playwright.sync_api import Download, Page

SPY = """
window.heard = [];
new MutationObserver((seen) => {
  for (const each of seen) if (each.target.closest?.("#said, #alerted")) heard.push(each.target.textContent);
}).observe(document, { childList: true, subtree: true });
"""
VOICES = """
window.spoken = [];
const spy = {
  getVoices: () => [{ name: "Anne", lang: "fr-FR", localService: true }], addEventListener: () => {},
  cancel: () => spoken.push("cancel"), speak: ({ text, lang }) => spoken.push({ text, lang }),
};
Object.defineProperty(window, "speechSynthesis", { value: spy });
window.SpeechSynthesisUtterance = function (text) { this.text = text; };
"""


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
        assert panel.locator(".outcome h3").all_inner_texts() == ["3D print (STL)", "3D print (3MF)"]
        assert panel.locator(".outcome .sentence").count() == 2
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

    def test_picture_is_sent_as_a_page_by_its_button(self, show: Callable[..., "Page"]) -> None:
        """The other exporters that are chosen are not made."""
        page = show("export: [stl]\n")
        panel = open_panel(page, "export")
        panel.get_by_role("button", name="Send as a page").press("Enter")
        until(lambda: "One file is ready." in panel.inner_text(), "the file")
        until(lambda: page.evaluate("document.activeElement.id") == "export-status", "the focus is at the result")
        with page.expect_download() as waited:
            panel.get_by_role("link", name="mine-page.html").press("Enter")
        sent = content_of(waited.value).decode()
        assert sent.startswith("<!doctype html>") and "default-src 'none'" in sent
        assert len(sent) < 2_000_000
        assert panel.locator(".outcome").count() == 1

    def test_export_choices_are_written_to_the_file_and_read_from_it(self, show: Callable[..., "Page"]) -> None:
        page = show("export: [{use: stl, rim_m: 0.01}, 3mf]\n")
        panel = open_panel(page, "export")
        until(lambda: panel.get_by_label("3D print (STL)").is_checked(), "what the file says")
        assert panel.get_by_label("3D print (3MF)").is_checked()
        assert not panel.get_by_label("Heights (PNG, TIFF)").is_checked()
        assert "Options: 1" in panel.locator("summary", has_text="3D print (STL)").inner_text()
        write = panel.get_by_role("button", name="Write into the pipeline file")
        write.press("Enter")
        until(lambda: "lists these exports already" in panel.inner_text(), "nothing to say")
        panel.get_by_label("3D print (3MF)").press(" ")
        panel.get_by_label("Heights (PNG, TIFF)").press(" ")
        write.press("Enter")
        until(lambda: "heights" in text_of(page), "written")
        assert page.evaluate("page.document.said.export") == [{"use": "stl", "rim_m": 0.01}, "heights"]
        assert page.evaluate("page.document.complaints") == []
        open_panel(page, "methods").locator("#undo").press("Enter")
        until(lambda: panel.get_by_label("3D print (3MF)").is_checked(), "undone")

    def test_export_with_an_invalid_option_shows_the_reason(self, show: Callable[..., "Page"]) -> None:
        page = show()
        panel = open_panel(page, "export")
        panel.get_by_role("button", name="Export", exact=True).press("Enter")
        until(lambda: "Choose at least one." in panel.inner_text(), "nothing chosen")
        panel.locator("summary", has_text="3D print (STL)").press("Enter")
        base = panel.get_by_label("Base").first
        base.fill("-1")
        base.press("Enter")
        until(lambda: panel.get_by_label("3D print (STL)").is_checked(), "who sets an option wants it")
        panel.get_by_role("button", name="Export", exact=True).press("Enter")
        until(lambda: "base_m" in panel.locator("p.bad[role=status]").inner_text(), "why")
        assert panel.locator(".outcome").count() == 0

    def test_export_listed_twice_in_the_file_is_shown_twice(self, show: Callable[..., "Page"]) -> None:
        page = show("export: [stl, {use: stl, rim_m: 0.01}]\n")
        panel = open_panel(page, "export")
        lines = panel.locator(".exporters > li")
        until(lambda: lines.get_by_label("3D print (STL)", exact=True).count() == 2, "both")
        count = lines.count()
        panel.locator("summary", has_text="3D print (STL)").nth(1).press("Enter")
        panel.get_by_role("button", name="Remove 3D print (STL)").press("Enter")
        until(lambda: lines.count() == count - 1, "one")
        until(lambda: page.evaluate("document.activeElement.type") == "checkbox", "the focus")


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
        panel.get_by_label("Show the places").press(" ")
        until(lambda: not marks.first.is_visible(), "hidden")
        panel.get_by_label("Show the places").press(" ")
        until(lambda: marks.first.is_visible(), "shown again")
        panel.evaluate("(each) => (each.open = false)")
        until(lambda: not marks.first.is_visible(), "the marks leave with their panel")
        panel.evaluate("(each) => (each.open = true)")
        until(lambda: marks.first.is_visible(), "and come with it")
        assert panel.get_by_role("button", name="Print it on A3 paper").count() == 1, (
            "a part of 6.4 mm has no room on A4"
        )
        assert panel.get_by_role("button", name="Give places narrower than 3.2 mm to their neighbours").count() == 1
        assert "simplify" not in panel.inner_text(), "no key is read"

        before = text_of(page)
        panel.get_by_role("button", name="Simplify the parts").press("Enter")
        until(lambda: panel.locator(".sentence.ok").count() == 1, "cured")
        assert page.evaluate("page.document.said.simplify.gap_m") == 0.0032
        assert marks.count() == places.count() == 0
        open_panel(page, "methods").locator("#undo").press("Enter")
        until(lambda: text_of(page) == before, "undone in one step")
        until(lambda: "changed since this check" in panel.inner_text(), "stale")

    def test_legibility_is_judged_at_another_width(self, show: Callable[..., "Page"]) -> None:
        page = show()
        panel = open_panel(page, "legible")
        panel.get_by_label("Width, mm").fill("400")
        panel.get_by_label("Read on").select_option("print")
        panel.get_by_role("button", name="Check now").press("Enter")
        until(lambda: "Judged for a 3D print, 400 mm wide." in panel.inner_text(), "judged")
        panel.get_by_label("Width, mm").fill("5")
        panel.get_by_role("button", name="Check again").press("Enter")
        assert page.evaluate("document.activeElement.id") == "legible-width", "the browser says what is wrong"


class TestDescription:
    def test_description_is_read_spoken_copied_and_saved(self, show: Callable[..., "Page"]) -> None:
        page = show("language: de\n", VOICES, permissions=["clipboard-read", "clipboard-write"])
        panel = open_panel(page, "description")
        region = panel.get_by_role("region", name="Description")
        until(lambda: "Eine Fläche" in region.inner_text(), "in the language of the document")
        assert region.get_attribute("lang") == "de"
        assert region.locator("li").count() > 0
        panel.get_by_role("button", name="Read aloud").press("Enter")
        until(lambda: "no voice for this language" in panel.inner_text(), "no voice")
        panel.get_by_label("Language").select_option("fr")
        until(lambda: region.get_attribute("lang") == "fr", "French")
        panel.get_by_role("button", name="Read aloud").press("Enter")
        lines = [each for each in page.evaluate("spoken") if each != "cancel"]
        assert {each["lang"] for each in lines} == {"fr-FR"}
        said = region.inner_text()
        assert all(each["text"].removesuffix(".").split(". ")[-1] in said for each in lines)
        panel.get_by_role("button", name="Stop reading").press("Enter")
        assert page.evaluate("spoken.at(-1)") == "cancel"
        panel.get_by_role("button", name="Copy").press("Enter")
        until(lambda: page.evaluate("heard.includes('The description is in the clipboard.')"), "copied")
        copied = page.evaluate("navigator.clipboard.readText()")
        assert all(each["text"] in copied for each in lines)
        with page.expect_download() as waited:
            panel.get_by_role("button", name="Save as HTML").press("Enter")
        assert waited.value.suggested_filename == "mine.html"
        assert '<html lang="fr">' in content_of(waited.value).decode()
        assert not [each for each in page.evaluate("heard") if said[:40] in each], "it is not read out unasked"


class TestBeacon:
    def test_beacon_guides_to_a_part_until_a_button_or_escape(
        self, show: Callable[..., "Page"], lasting: LastingServer, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        """The page's own hand has no motor: it is asked for a device. Another program moves a pointer in its place."""
        monkeypatch.setenv("TANGIBLE_RUNTIME_DIR", str(lasting.runtime))
        channel = f"guided-{os.getpid()}"
        page = show(f"parts: {{0: {{name: wall}}}}\ndevice: {{use: pointer, channel: {channel}}}\n")
        panel = bring(page, "parts")
        panel.get_by_text("choose one under “Devices”").wait_for()
        assert panel.get_by_role("button", name="guide me there").count() == 0
        open_panel(page, "devices").locator("#use-document").press("Enter")
        bring(page, "parts")
        guide = panel.get_by_role("button", name="wall: guide me there")
        until(guide.is_visible, "a device is felt")

        def over(what: str) -> None:
            until(lambda: page.evaluate("(what) => heard.some((each) => each.startsWith(what))", what), what)
            until(guide.is_visible, what)
            assert guide.get_attribute("aria-pressed") == "false"
            page.evaluate("heard.length = 0")

        with PointerClient(channel, 5.0) as hand:
            moving = threading.Event()

            def move() -> None:
                with suppress(DeviceError):  # the stop closes it
                    while not moving.wait(0.005):
                        hand.send((0.0, 0.0, 0.02), buttons[0])

            buttons = [0]
            mover = threading.Thread(target=move)
            mover.start()
            try:
                guide.press("Enter")
                until(lambda: page.evaluate("heard.includes('You are guided to: wall.')"), "said")
                let_go = panel.get_by_role("button", name="wall: let me go")
                assert let_go.get_attribute("aria-pressed") == "true"
                assert page.evaluate("document.activeElement.textContent") == "Let me go", "the focus stays"
                let_go.press("Enter")
                over("You are not guided any more.")
                guide.press("Enter")
                until(let_go.is_visible, "again")
                buttons[0] = 1
                over("A button of the device let you go.")
                buttons[0] = 0
                guide.press("Enter")
                until(let_go.is_visible, "once more")
                page.keyboard.press("Escape")
                until(lambda: page.locator("#status").get_attribute("data-state") == "stopped", "no force")
                until(lambda: not let_go.is_visible(), "stopped")
            finally:
                moving.set()
                mover.join()

    def test_touch_is_announced_with_part_and_material(self, show: Callable[..., "Page"]) -> None:
        page = show("parts: {0: {name: wall, material: ice}}\nmaterials: {by: {1: ice}, default: ice}\n")
        page.locator("#terrain").focus()
        page.keyboard.press("Home")
        page.keyboard.press(" ")
        until(lambda: page.evaluate("heard.some((each) => /^Touching .*ice/.test(each))"), "said")
