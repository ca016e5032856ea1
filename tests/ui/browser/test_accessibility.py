"""The page for everybody: without a mouse, without seeing, without hearing, in any size and colours, in German too."""

from collections.abc import Callable
from itertools import count, pairwise
from pathlib import Path
from typing import TYPE_CHECKING, Any

import pytest

from accessible_names import controls_of, faults_of
from browser_tabs import SETTLED
from needed import lacking
from page_files import WEB
from page_panels import bring, open_panel, show_everything, wait_for_force
from waiting import until

if TYPE_CHECKING:
    from playwright.sync_api import Page

AXE = WEB / "node_modules/axe-core/axe.min.js"
RULES = {"type": "tag", "values": ["wcag2a", "wcag2aa", "wcag21a", "wcag21aa", "wcag22aa", "best-practice"]}
"""Of axe, asked where other elements may be shown: in the first theme and on a phone."""
COLOURS = {"type": "rule", "values": ["color-contrast", "link-in-text-block"]}
"""All that a theme can break."""
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
VOICES = """
window.spoken = [];
const voice = (name, lang) => ({ name, lang, localService: true });
window.voices = [voice("Anna", "de-DE"), voice("Ann", "en-GB")];
const spy = {
  getVoices: () => voices, addEventListener: (_, act) => (window.changed = act), cancel: () => spoken.push("cancel"),
  speak: ({ text, lang, rate, voice }) => spoken.push({ text, lang, rate, voice: voice.name }),
};
Object.defineProperty(window, "speechSynthesis", { value: spy });
window.SpeechSynthesisUtterance = function (text) { this.text = text; };
"""
CONTEXTS = """
window.contexts = [];
window.AudioContext = class extends AudioContext { constructor(...all) { super(...all); contexts.push(this); } };
"""
SMALL = """
[...document.querySelectorAll("button, select, textarea, summary, label, input:not([type=checkbox], [type=radio])")]
  .filter((each) => each.checkVisibility() && !each.closest(".visually-hidden"))
  .map((each) => [each.outerHTML.slice(0, 90), each.getBoundingClientRect()])
  .filter(([, box]) => box.height < 24 || box.width < 24).map(([html]) => html)
"""
LOOK = """(each) => {
  const { backgroundColor, outlineStyle, outlineWidth } = getComputedStyle(each);
  return [backgroundColor, outlineStyle, outlineWidth];
}"""
LOUDEST = """() => {
  page.sound.let("height", true);
  window.loudest = 0;
  setInterval(() => (loudest = Math.max(loudest, page.sound.level)), 20);
}"""

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
    @pytest.mark.parametrize("locale", ["en-GB", "de-DE"])
    def test_page_with_results_has_no_violations_by_axe_and_fits_every_size(self, show: Show, locale: str):
        """Every panel is open, with verdicts, cures, files, decisions and a refusal.

        In English in all themes; in German, where colours are the same and words longer, from a phone to a wall.
        """
        if not AXE.is_file():
            lacking("axe-core is not installed: npm ci in plugins/ui/web")
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
        page.evaluate("document.querySelector('#left').scrollTo(0, 0)")  # a heading that sticks covers what is below it
        assert axe_finds(page, colours=locale == "en-GB") == []
        for name, (width, height) in SIZES.items() if locale == "de-DE" else ():
            page.set_viewport_size({"width": width, "height": height})
            page.evaluate(SETTLED)
            assert page.evaluate("document.documentElement.scrollWidth") <= width, name
            for region in ("#left", "#right", "#bottom"):
                sides = page.locator(region).evaluate("(each) => [each.scrollWidth, each.clientWidth]")
                assert sides[0] <= sides[1], (name, region)
            stop, surface = page.locator("#stop").bounding_box(), page.locator("#terrain").bounding_box()
            assert stop and surface
            assert stop["height"] >= 44 and stop["x"] >= 0 and stop["x"] + stop["width"] <= width, name
            assert stop["y"] >= 0 and stop["y"] + stop["height"] <= height, name
            assert surface["width"] >= 300 and surface["height"] >= 150, name
            assert page.evaluate(SMALL) == [], name

    def test_parts_editor_has_no_violations_by_axe_in_any_size(self, show: Show):
        """The language is German, whose words are longer; a proposal, a complaint and all folded controls are open."""
        if not AXE.is_file():
            lacking("axe-core is not installed: npm ci in plugins/ui/web")
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
        assert axe_finds(page, "#parts-editor") == []
        for name, (width, height) in SIZES.items():
            page.set_viewport_size({"width": width, "height": height})
            page.evaluate(SETTLED)
            assert page.evaluate("document.documentElement.scrollWidth") <= width, name
            side = page.locator("#parts-editor > .side").evaluate("(each) => [each.scrollWidth, each.clientWidth]")
            assert side[0] <= side[1], name
            picture, stop = page.locator("#parts-picture").bounding_box(), page.locator("#stop").bounding_box()
            assert picture and stop
            assert picture["width"] >= 300 and picture["height"] >= 150, name
            assert stop["x"] >= 0 and stop["x"] + stop["width"] <= width, name
            assert page.evaluate(SMALL) == [], name

    def test_colours_follow_the_system_or_the_choice_and_forced_colours_work(self, show: Show):
        page = show(color_scheme="dark")
        ground = "getComputedStyle(document.querySelector('#left')).backgroundColor"
        dark = page.evaluate(ground)
        page.emulate_media(color_scheme="light")
        page.wait_for_function("() => document.documentElement.dataset.scheme === 'light'")
        light = page.evaluate(ground)
        page.locator("#theme").select_option("contrast-dark")
        contrast = page.evaluate(ground)
        assert len({dark, light, contrast}) == 3
        assert contrast == "rgb(0, 0, 0)"
        page.reload()
        assert page.evaluate("document.documentElement.dataset.contrast") == "more"
        page.locator("#theme").select_option("system")
        assert page.evaluate(ground) == light

        page.emulate_media(forced_colors="active")
        show_everything(page)
        button = page.locator("#sound-on")
        button.focus()
        background, outline, width = button.evaluate(LOOK)
        assert outline == "solid" and float(width.removesuffix("px")) >= 2
        page.keyboard.press("Enter")
        page.wait_for_function("() => document.querySelector('#sound-on').ariaPressed === 'true'")
        assert button.evaluate(LOOK)[0] != background, "what is pressed looks so"
        assert page.locator("#stop").evaluate("(each) => getComputedStyle(each).borderStyle") == "double"


THEMES: dict[str, dict[str, Any]] = {
    "light": {"color_scheme": "light", "contrast": "no-preference"},
    "dark": {"color_scheme": "dark", "contrast": "no-preference"},
    "dark more": {"color_scheme": "dark", "contrast": "more"},
    "light more": {"color_scheme": "light", "contrast": "more"},
}


def assert_controls_have_names(page: "Page", least: int) -> None:
    """Check the accessibility tree, in which a slider whose value takes its label has no name; axe does not see it."""
    controls = controls_of(page)
    assert len(controls) > least
    assert faults_of(controls) == []


def axe_finds(page: "Page", *within: str, colours: bool = True) -> list[str]:
    """Return axe's violations in the light theme and on a phone; with colours, in all themes and in forced colours.

    within: Elements by selector; without, all of the page.
    """
    page.evaluate(AXE.read_text(encoding="utf-8"))
    found: list[str] = []
    for name, media in THEMES.items() if colours else [("light", THEMES["light"])]:
        page.emulate_media(**media)
        page.wait_for_function("(name) => name.startsWith(document.documentElement.dataset.scheme)", arg=name)
        more = name.endswith("more")
        page.wait_for_function("(more) => (document.documentElement.dataset.contrast === 'more') === more", arg=more)
        found += violations(page, name, RULES if name == "light" else COLOURS, within)
    if colours:
        page.emulate_media(contrast="no-preference", forced_colors="active")
        found += violations(page, "forced colours", COLOURS, within)
        page.emulate_media(forced_colors="none")
    for size, rules in (("phone", RULES), ("zoomed to 400 %", SIZES_OF_TARGETS)):
        width, height = SIZES[size]
        page.set_viewport_size({"width": width, "height": height})
        found += violations(page, size, rules, within)
    return found


def violations(page: "Page", where: str, rules: dict[str, Any], within: tuple[str, ...]) -> list[str]:
    page.evaluate(SETTLED)
    found = page.evaluate(
        """([within, runOnly]) => axe.run(within.length ? { include: within } : document,
          { runOnly, resultTypes: ["violations"], elementRef: false })""",
        [list(within), rules],
    )
    return [
        f"{where}: {each['id']} {node['target']} {node['failureSummary']}"
        for each in found["violations"]
        for node in each["nodes"]
    ]


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

    def test_page_works_without_local_storage(self, show: Show):
        page = show("Object.defineProperty(window, 'localStorage', { get() { throw new Error('forbidden') } })")
        page.locator("#theme").select_option("dark")
        page.locator("#settings > summary").click()
        assert page.evaluate("document.querySelector('main').checkVisibility()")


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

    def test_speech_in_german_needs_a_german_voice(self, show: Show):
        page = show(SPY + VOICES, locale="de-DE")
        show_everything(page)
        page.wait_for_function("() => document.querySelector('#described').textContent.includes('Materialien: ')")
        page.keyboard.press("d")
        assert "Materialien: " in last(page)
        assert page.evaluate("spoken") == []
        page.keyboard.press("a")
        assert page.locator("#speech-on").get_attribute("aria-pressed") == "true"
        page.locator("#sound input[type=range]").nth(1).fill("1.5")
        page.evaluate("spoken.length = 0")
        page.keyboard.press("d")
        [cancelled, spoken] = page.evaluate("spoken")
        assert cancelled == "cancel", "what was being said is stale"
        assert spoken["text"] == page.locator("#said").inner_text().strip()
        assert (spoken["lang"], spoken["voice"], spoken["rate"]) == ("de-DE", "Anna", 1.5)
        page.evaluate("voices.shift(); changed()")
        assert page.locator("#speech-on").is_hidden()
        assert "keine deutsche Stimme" in page.locator("#sound").inner_text()
        page.evaluate("spoken.length = 0")
        page.keyboard.press("d")
        assert page.evaluate("spoken") == []
        page.locator("#language").click()
        page.wait_for_function("() => document.documentElement.lang === 'en'")
        page.wait_for_selector("#open", state="attached")
        assert page.locator("#language").inner_text() == "Deutsch"
        assert page.locator("#open > summary").inner_text() == "Open"
        assert page.locator("#speech-on").get_attribute("aria-pressed") == "true", (
            "it is remembered, and there is a voice"
        )


OFFLINE = """async ([material, force, velocity]) => {
  const context = new OfflineAudioContext(2, 48000, 48000);
  new Instrument(context).stroke(stroke(material, force, velocity));
  const made = await context.startRendering();
  const data = made.getChannelData(0).subarray(9600);
  let [sum, most] = [0, 0];
  for (const each of data) { sum += each * each; most = Math.max(most, Math.abs(each)); }
  return [Math.sqrt(sum / data.length), most];
}"""
CLOTH = {
    **dict.fromkeys(["damping_n_s_per_m", "direction_deg", "anisotropy", "irregularity", "drag_n_s_per_m"], 0),
    **{"name": "cloth", "stiffness_n_per_m": 300, "static_friction": 0.6, "dynamic_friction": 0.4, "roughness_m": 5e-5},
    **{"grain_m": 4e-4, "texture": "stochastic"},
}


class TestHeard:
    def test_sound_of_a_stroke_is_bounded_off_at_first_and_has_one_context(self, show: Show):
        page = show(CONTEXTS, measure=True)

        def play(force_n: float, speed: float, **changed: Any) -> tuple[float, float]:
            return page.evaluate(OFFLINE, [{**CLOTH, **changed}, [0, 0, force_n], [speed, 0, 0]])

        assert play(1, 0)[0] < 1e-5, "at rest"
        assert play(0, 0.1)[0] < 1e-5, "in the air"
        assert play(1, 0.1, texture="smooth", roughness_m=0)[0] < 1e-5, "on ice"
        soft, loud, loudest = play(0.3, 0.05), play(1, 0.1), play(1e6, 1e6, roughness_m=1)
        assert 0.01 < soft[0] < loud[0] < loudest[0] < 0.5
        assert loudest[1] < 1, "it is never cut off"
        for texture in ("periodic", "stick-slip"):
            assert 0.01 < play(1, 0.1, texture=texture)[0] < 0.5, texture

        wait_for_force(page)
        drag(page, lambda: page.evaluate("(page.net.latest?.flags & 1) === 1"))
        assert page.evaluate("contexts.length") == 0
        for _ in range(3):
            page.keyboard.press("s")  # on, off, on, before the first has begun
        page.wait_for_function("() => window.contexts[0]?.state === 'running'")
        assert page.evaluate("contexts.length") == 1
        assert page.evaluate("page.sound.on")
        page.evaluate(LOUDEST)
        drag(page, lambda: page.evaluate("loudest") > 0.01)
        page.mouse.move(2, 2)
        page.wait_for_function("() => page.sound.level < 1e-4")
        page.evaluate("loudest = 0")
        page.keyboard.press("h")
        page.wait_for_function("() => loudest > 0.03")
        page.keyboard.press("s")
        page.wait_for_function("() => !page.sound.on && page.sound.level < 1e-4")
        assert page.evaluate("contexts.length") == 1


class TestLog:
    def test_log_lines_are_filtered_searched_counted_copied_and_saved(self, show: Show):
        page = show(measure=True, permissions=["clipboard-read", "clipboard-write"])
        tell = "(all) => { for (const each of all) page.hub.tell(...each) }"
        lines: list[list[Any]] = [
            ["log", {"at_s": 1, "level": "warning", "logger": "somebody", "text": "it is dark"}]
        ] * 3
        lines += [["error", {"at_s": 2, "text": "the disk is full"}]]
        open_panel(page, "log-panel")
        page.get_by_role("button", name="Clear").click()
        page.evaluate(tell, lines)
        log = page.locator("#log")
        page.wait_for_function("() => document.querySelectorAll('#log li').length === 2")
        assert "warning somebody: it is dark (3 times)" in log.inner_text()
        assert log.get_attribute("role") == "log"
        page.get_by_label("Warnings").uncheck()
        assert "dark" not in log.inner_text() and "disk" in log.inner_text()
        assert page.locator("#log-panel output").inner_text() == "1 of 2 lines"
        page.get_by_label("Warnings").check()
        page.get_by_label("Search the log").fill("DARK some")
        assert "disk" not in log.inner_text() and "dark" in log.inner_text()
        page.locator("#log-panel").get_by_role("button", name="Copy").click()
        page.wait_for_function("() => document.querySelector('#said').textContent.startsWith('Lines copied: 1')")
        assert (
            page.evaluate("navigator.clipboard.readText()")
            == "1970-01-01T00:00:01.000Z warning somebody: it is dark (x 3)\n"
        )
        with page.expect_download() as download:
            page.locator("#log-panel").get_by_role("button", name="Save").click()
        assert Path(download.value.path()).read_text(encoding="utf-8").endswith("it is dark (x 3)\n")
        # a flood leaves the newest lines, and a page that answers
        page.get_by_label("Search the log").fill("")
        page.evaluate("for (let i = 0; i < 6000; i++) page.hub.tell('error', { at_s: i, text: `fault ${i}` })")
        page.wait_for_function("() => document.querySelector('#log li:last-child')?.textContent.includes('fault 5999')")
        assert page.evaluate("document.querySelectorAll('#log li').length") == 2000


class TestTasks:
    def test_first_visit_works_with_the_keyboard_alone(self, show: Show, tmp_path: Path):
        """Open, look, feel, ask, hear, record, stop, feel again, save, and find the keys."""
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
    """Press the hand onto the surface and move it over the parts until it is enough, then let go.

    It moves two dozen times a second: the page tells once a second, and more moves only take the processor.
    """
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
