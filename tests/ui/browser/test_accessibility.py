"""The page for everybody: otherwise somebody without mouse, sight or hearing, or on a phone, cannot use it."""

from collections.abc import Callable
from itertools import count, pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from accessible_names import COLOURS, RULES, axe_finds, controls_of, faults_of
from browser_tabs import SETTLED
from page_panels import bring, show_everything, wait_for_force
from waiting import until

if TYPE_CHECKING:
    from playwright.sync_api import Page

SIZES_OF_TARGETS = {"type": "rule", "values": ["target-size", "scrollable-region-focusable"]}
"""All that a zoomed phone can break."""
SIZES = {"phone": (390, 844), "zoomed to 400 %": (320, 256), "zoomed to 200 %": (683, 384), "tablet": (820, 1180)}
SIZES |= {"low": (1280, 500), "notebook": (1366, 768), "wall": (3840, 1200)}
SPY = """
window.heard = [];
const { get, set } = Object.getOwnPropertyDescriptor(Node.prototype, "textContent");
Object.defineProperty(Node.prototype, "textContent", {
  get,
  set(text) {
    if (this.id === "said" || this.id === "alerted") heard.push({ ms: performance.now(), text, region: this.id });
    set.call(this, text);
  },
});
"""
"""Lists announcements, each with the moment at which it was made."""
SMALL = """
[...document.querySelectorAll("button, select, textarea, summary, label, input:not([type=checkbox], [type=radio])")]
  .filter((each) => each.checkVisibility() && !each.closest(".visually-hidden"))
  .map((each) => [each.outerHTML.slice(0, 90), each.getBoundingClientRect()])
  .filter(([, box]) => box.height < 24 || box.width < 24).map(([html]) => html)
"""

Show = Callable[..., "Page"]


@pytest.fixture
def show(open_page: Callable[..., Any], opened: Callable[..., str]) -> Show:
    """The page with its surface; `before` runs in it first, `?measure` lets tests look into it."""

    url = opened("builtin/motorcycle")

    def show(before: str = "", measure: bool = False, **options: Any) -> "Page":
        page = open_page("about:blank", **options)
        if before:
            page.add_init_script(before)
        page.goto(url + "&measure" * measure)
        page.wait_for_function("() => document.querySelector('#terrain').ariaLabel?.includes('motorcycle')")
        return page

    return show


def focus(page: "Page") -> str:
    return page.evaluate("document.activeElement.id || document.activeElement.closest('[id]')?.id || ''")


class TestSeen:
    @pytest.mark.parametrize("locale", [pytest.param("en-GB", marks=pytest.mark.whole), "de-DE"])
    def test_page_with_results_has_no_violations_by_axe_and_fits_every_size(self, show: Show, locale: str):
        """Every panel is open, with verdicts, cures, files, decisions and a refusal."""
        page = show(locale=locale)
        assert page.evaluate("document.documentElement.lang") == locale[:2]
        wait_for_force(page)
        show_everything(page)
        page.wait_for_function("() => document.querySelector('#materials datalist').childElementCount")
        assert_controls_have_names(page, 150)
        for form in ("STL", "3MF"):
            page.get_by_label(f"({form})").check()
        page.locator("#export-run").click()
        page.wait_for_selector("#export .outcome")
        page.locator("#legible select").select_option("print")
        page.locator("#legible-check").click()
        page.wait_for_selector("#legible .sentence")
        show_everything(page)
        assert page.locator("#legible .places button").count() > 0
        page.keyboard.press("Control+k")
        page.locator("#palette-input").wait_for()
        assert axe_finds(page, within=("#palette",)) == []
        page.keyboard.press("Control+k")
        page.evaluate("document.querySelector('#left').scrollTo(0, 0)")  # a heading that sticks covers what is below it
        assert violations(page, colours=locale == "de-DE") == []
        if locale == "de-DE":
            assert_fits_every_size(page, "#terrain", "#left", "#right", "#bottom")

    def test_parts_editor_has_no_violations_by_axe_in_any_size(self, show: Show):
        page = show(locale="de-DE")
        bring(page, "parts").locator("#parts-edit").click()
        page.wait_for_selector("#parts-list [role=option]")
        page.keyboard.press("p")
        for _ in range(2):
            page.keyboard.press(" ")
        page.get_by_role("button", name="Annehmen").wait_for()
        page.locator("#parts-height-mm").fill("99")
        assert "von 0 bis" in page.locator("#parts-height-mm-complaint").inner_text()
        page.evaluate("document.querySelectorAll('#parts-editor details').forEach((each) => (each.open = true))")
        assert_controls_have_names(page, 20)
        assert violations(page, "#parts-editor") == []
        assert_fits_every_size(page, "#parts-picture", "#parts-editor > .side")


THEMES: dict[str, dict[str, Any]] = {
    "light": {"color_scheme": "light", "contrast": "no-preference"},
    "dark": {"color_scheme": "dark", "contrast": "no-preference"},
    "light more": {"color_scheme": "light", "contrast": "more"},
}


def assert_fits_every_size(page: "Page", picture: str, *regions: str) -> None:
    """Check that nothing is cut off, the picture is large enough, and the stop button is in sight."""
    for name, (width, height) in SIZES.items():
        page.set_viewport_size({"width": width, "height": height})
        page.evaluate(SETTLED)
        assert page.evaluate("document.documentElement.scrollWidth") <= width, name
        for region in regions:
            sides = page.locator(region).evaluate("(each) => [each.scrollWidth, each.clientWidth]")
            assert sides[0] <= sides[1], (name, region)
        stop, drawn = page.locator("#stop").bounding_box(), page.locator(picture).bounding_box()
        assert stop and drawn
        assert stop["height"] >= 44 and stop["x"] >= 0 and stop["x"] + stop["width"] <= width, name
        assert stop["y"] >= 0 and stop["y"] + stop["height"] <= height, name
        assert drawn["width"] >= 300 and drawn["height"] >= 150, name
        assert page.evaluate(SMALL) == [], name


def assert_controls_have_names(page: "Page", least: int) -> None:
    """Check the accessibility tree, in which a slider whose value takes its label has no name; axe does not see it."""
    controls = controls_of(page)
    assert len(controls) > least
    assert faults_of(controls) == []


def violations(page: "Page", *within: str, colours: bool = True) -> list[str]:
    """Return axe's violations in the light theme and on a phone; with colours, in all themes and in forced colours."""
    found: list[str] = []

    def look(where: str, rules: dict[str, Any]) -> None:
        found.extend(f"{where}: {axe_find}" for axe_find in axe_finds(page, rules, within))

    for name, media in THEMES.items() if colours else [("light", THEMES["light"])]:
        page.emulate_media(**media)
        page.wait_for_function("(name) => name.startsWith(document.documentElement.dataset.scheme)", arg=name)
        more = name.endswith("more")
        page.wait_for_function("(more) => (document.documentElement.dataset.contrast === 'more') === more", arg=more)
        look(name, RULES if name == "light" else COLOURS)
    if colours:
        page.emulate_media(contrast="no-preference", forced_colors="active")
        look("forced colours", COLOURS)
        page.emulate_media(forced_colors="none")
    for size, rules in (("phone", RULES), ("zoomed to 400 %", SIZES_OF_TARGETS)):
        width, height = SIZES[size]
        page.set_viewport_size({"width": width, "height": height})
        look(size, rules)
    return found


class TestKeys:
    def test_keyboard_reaches_regions_panels_and_splitters(self, show: Show):
        page = show()
        page.keyboard.press("Tab")
        assert page.locator("#skip").is_visible()
        page.keyboard.press("Enter")
        assert focus(page) == "terrain"
        for region in ("left", "head", "terrain"):
            page.keyboard.press("F6")
            assert focus(page) == region
        page.keyboard.press("Shift+F6")
        assert focus(page) == "head"
        page.locator("#advanced").press("Enter")
        page.locator("#terrain").focus()
        for region in ("left", "right", "bottom", "head", "terrain", "left"):
            page.keyboard.press("F6")
            assert focus(page) == region
        page.keyboard.press("Tab")
        assert focus(page) == "tab-picture"
        for key, task in (
            ("ArrowRight", "parts"),
            ("End", "hand-on"),
            ("ArrowRight", "picture"),
            ("ArrowLeft", "hand-on"),
        ):
            page.keyboard.press(key)
            assert focus(page) == f"tab-{task}"
            assert page.locator(f"#tab-{task}").get_attribute("aria-selected") == "true"
            assert page.locator("[role=tabpanel]:visible").get_attribute("id") == f"task-{task}"
        page.keyboard.press("Tab")
        assert focus(page) == "legible"
        page.keyboard.press("ArrowDown")
        assert focus(page) == "description"
        page.locator("#methods > summary").press("Enter")
        assert not page.evaluate("document.querySelector('#methods').open")
        page.locator("#split-left").focus()
        width = page.evaluate("document.querySelector('#left').offsetWidth")
        for _ in range(3):
            page.keyboard.press("ArrowRight")
        wider = page.evaluate("document.querySelector('#left').offsetWidth")
        assert wider >= width + 40
        page.reload()
        page.wait_for_selector("#methods")
        assert page.locator("#methods").is_visible(), "all settings are shown again"
        assert not page.evaluate("document.querySelector('#methods').open")
        assert page.locator("#tab-hand-on").get_attribute("aria-selected") == "true"
        assert page.evaluate("document.querySelector('#left').offsetWidth") == wider

    def test_tab_key_reaches_every_control(self, show: Show):
        page = show()
        show_everything(page)
        page.evaluate("document.activeElement.blur()")
        reachable = page.evaluate(
            """(() => {
              const all = [...document.querySelectorAll("a, button, select, textarea, summary, input, [tabindex='0']")];
              const radios = new Set();
              return all.filter((each) => {
                if (!each.checkVisibility() || each.disabled || each.tabIndex < 0) return false;
                if (each.type !== "radio") return true;
                return !radios.has(each.name) && radios.add(each.name);
              }).length;
            })()"""
        )
        page.evaluate("window.met = new Set(); document.addEventListener('focusin', (event) => met.add(event.target))")
        for _ in range(reachable + 12):
            page.keyboard.press("Tab")
        assert page.evaluate("[...met].filter((each) => each !== document.body).length") >= reachable

    def test_letter_keys_act_unless_text_is_typed_and_can_be_switched_off(self, show: Show):
        page = show(SPY)
        asked = "heard.filter(({ text }) => text.includes('motorcycle is felt as')).length"
        page.wait_for_function("() => document.querySelector('#described').textContent.includes('is felt as')")
        page.locator("#left").focus()
        page.keyboard.press("d")
        assert page.evaluate(asked) == 1
        bring(page, "log-panel").locator("input[type=search]").focus()
        page.keyboard.type("ddd")
        assert page.evaluate(asked) == 1
        show_everything(page)
        page.get_by_label("Single letters are keys everywhere").uncheck()
        page.locator("#left").focus()
        page.keyboard.press("d")
        assert page.evaluate(asked) == 1
        page.locator("#terrain").focus()
        page.keyboard.press("d")
        assert page.evaluate(asked) == 2
        page.keyboard.press("?")
        assert focus(page) == "help"


class TestSaid:
    def test_announcements_come_once_a_second_and_answers_at_once(self, show: Show):
        page = show(SPY)
        wait_for_force(page)
        page.evaluate("heard.length = 0")
        touching = (
            "new Set(heard.map((each) => each.text).filter((each) => /\\b(Touching|Up|Down|Level)\\b/.test(each))).size"
        )
        drag(page, lambda: page.evaluate(touching) > 1)
        until(
            lambda: last(page).endswith(("In the air.", "No hand is on the surface.")),
            "the end of the touch is announced",
        )
        heard = page.evaluate("heard")
        texts = [each["text"] for each in heard]
        assert all(before != after for before, after in pairwise(texts)), texts
        assert min(b["ms"] - a["ms"] for a, b in pairwise(heard)) >= 990
        assert {each["region"] for each in heard} == {"said"}

        # asked by a key, and the stop
        assert page.locator("#said").get_attribute("aria-live") == "polite"
        assert page.locator("#alerted").get_attribute("aria-live") == "assertive"
        canvas = page.locator("#terrain")
        assert "motorcycle" in (canvas.get_attribute("aria-label") or "")
        assert "materials: " in page.locator(f"#{canvas.get_attribute('aria-describedby')}").inner_text()
        canvas.focus()
        for key in ("ArrowRight", "ArrowUp", " "):
            page.keyboard.press(key)
        where = answer_to(page, "w", "newtons")
        assert all(part in where for part in ("right of the middle", "away from you", "high", "newtons")), where
        page.keyboard.press("d")
        assert "materials: " in last(page)

        # zoom and depth say what they did, moves are described in the air, and a tour ends with Escape
        assert answer_to(page, "+", "The view shows ").endswith(" mm.")
        assert answer_to(page, "PageDown", "Presses ").endswith(" mm deep.")
        page.keyboard.press(" ")
        answer_to(page, "Shift+D", "What the hand moves over is described")
        page.keyboard.down("ArrowLeft")
        until(
            lambda: page.evaluate("heard.some(({ text }) => / mm: |^Level: |Left rim/.test(text))"), "it is described"
        )
        page.keyboard.up("ArrowLeft")
        answer_to(page, "Shift+D", "no longer described")
        answer_to(page, "g", "A tour of ")
        until(lambda: page.evaluate("heard.some(({ text }) => / mm high; /.test(text))"), "the first part")
        page.keyboard.press("Escape")
        page.wait_for_function("() => heard.some(({ text }) => text.includes('no force'))")
        assert page.locator("#alerted").inner_text() == "", "what somebody asked for is no alarm"
        assert page.locator("#sound button[aria-keyshortcuts=G]").get_attribute("aria-pressed") == "false"
        assert page.locator("#status").get_attribute("data-state") == "stopped"
        page.locator("#again").click()
        wait_for_force(page)


class TestTasks:
    def test_first_visit_works_with_the_keyboard_alone(self, show: Show, tmp_path: Path):
        page = show(SPY)
        wait_for_force(page)
        enter(page, "left", "#open .examples button:nth-child(2)")
        page.wait_for_function("() => document.querySelector('#terrain').ariaLabel.includes('brick')")
        wait_for_force(page)

        reach(page, "main", "#look")
        page.keyboard.press("ArrowDown")
        assert page.evaluate("document.activeElement.value") == "relief", "another look"

        reach(page, "main", "#terrain")
        for key in ("ArrowLeft", " "):
            page.keyboard.press(key)
        assert "newtons" in answer_to(page, "w", "newtons")
        page.keyboard.press(" ")
        for key, answer in (
            ("w", "in the air"),
            ("d", "brick"),
            ("s", "Sound is on"),
            ("h", ""),
            ("s", "Sound is off"),
        ):
            answer_to(page, key, answer)

        page.keyboard.press("Escape")
        page.wait_for_function("() => document.querySelector('#status').dataset.state === 'stopped'")
        enter(page, "head", "#again")
        wait_for_force(page)

        reach(page, "left", "#tab-picture")
        page.keyboard.press("End")
        reach(page, "left", "#save-path")
        page.keyboard.press("Control+a")
        page.keyboard.type(str(tmp_path / "mine.yaml"))
        enter(page, "left", "#save button:text-is('Save')")
        page.wait_for_function("() => document.querySelector('#save').textContent.includes('Saved: ')")
        assert "brick" in (tmp_path / "mine.yaml").read_text(encoding="utf-8")

        page.keyboard.press("F1")
        assert focus(page) == "help"


def reach(page: "Page", region: str, what: str) -> None:
    """Go to a region with F6, and there to a control with Tab."""
    wanted = page.locator(what)
    for _ in range(6):
        page.keyboard.press("F6")
        if page.locator(f"#{region}").evaluate("(each) => each.contains(document.activeElement)"):
            break
    for _ in range(80):
        if wanted.evaluate("(each) => each === document.activeElement"):
            return
        page.keyboard.press("Tab")
    raise AssertionError(f"Tab does not come to {what}")


def enter(page: "Page", region: str, what: str) -> None:
    reach(page, region, what)
    page.keyboard.press("Enter")


def drag(page: "Page", enough: Callable[[], bool]) -> None:
    """Press the hand onto the surface and move it over the parts until it is enough, then let go."""
    box = page.locator("#terrain").bounding_box()
    assert box
    x, y, width = box["x"] + box["width"] / 2, box["y"] + box["height"] * 0.6, box["width"]
    page.mouse.move(x, y)
    page.mouse.down()
    steps = count()

    def move() -> bool:
        page.mouse.move(x + 0.25 * width * (next(steps) % 20 / 10 - 1), y)
        page.wait_for_timeout(30)
        return enough()

    until(move, "the stroke has no end")
    page.mouse.up()
    page.mouse.move(2, 2)


def last(page: "Page") -> str:
    return page.evaluate("heard.at(-1)?.text ?? ''")


def answer_to(page: "Page", key: str, answer: str) -> str:
    """Press a key, and return the announcement that contains the answer; W is pressed until the hand has arrived."""
    page.evaluate("heard.length = 0")
    page.keyboard.press(key)
    if not answer:
        return ""

    def answer_now() -> str:
        if key == "w":
            page.keyboard.press(key)
        return next((each["text"] for each in page.evaluate("heard") if answer in each["text"]), "")

    return until(answer_now, f"{answer!r} is announced")
