"""A page that was sent, opened from its file: otherwise its receiver feels another picture, or none, in Firefox too."""

import json
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np
import pytest

from accessible_names import COLOURS, axe_finds
from browser_tabs import OpenPage
from firefox import firefox
from page_files import built_page
from sent_pages import HOSTILE, MATERIALS, picture_to_send, touches
from tangible_legibility.words.languages import one_line
from tangible_send.packing import surface_to_send
from tangible_send.page import Page
from waiting import until

if TYPE_CHECKING:
    from playwright.sync_api import Page as Tab

pytestmark = pytest.mark.whole
PLACES = 1000
SHAKEN = """
window.pulses = [];
navigator.vibrate = (ms) => pulses.push(ms);
const pad = {
  connected: true, mapping: "standard", axes: [0, 0, 0, 0], buttons: Array(17).fill({ pressed: false, value: 0 }),
  vibrationActuator: { playEffect: () => (window.rumbled = true), reset: () => 0 },
};
navigator.getGamepads = () => [pad];
window.contexts = 0;
window.AudioContext = class extends AudioContext { constructor(...all) { super(...all); contexts++; } };
"""
FEEL = """(text) => {
  const { law } = tangible, positions = JSON.parse(text);
  let before = positions[0];
  return JSON.stringify(positions.map((at) => {
    const touched = law.tick(at, at.map((each, axis) => (each - before[axis]) / 0.001));
    before = at;
    return touched?.force ?? [0, 0, 0];
  }));
}"""
"""Numbers travel as text: thousands of them, one by one, take Playwright minutes."""
COEFFICIENTS = "JSON.stringify([...tangible.law.spline.coefficients])"


@pytest.fixture
def sent(tmp_path: Path) -> str:
    """The address of a page in a file."""
    built_page()
    (path,) = Page().write(picture_to_send(), tmp_path / "it")
    return path.as_uri()


def test_page_is_explored_by_keyboard_mouse_and_pad(sent: str, open_page: OpenPage):
    tab = open_page("about:blank", locale="de-DE", reduced_motion="reduce")
    tab.add_init_script(SHAKEN)
    tab.goto(sent)
    tab.wait_for_function("() => window.tangible")
    assert_words_of_the_language(tab)
    assert_forces_are_those_of_proxy(tab)
    assert axe_finds(tab) == []
    assert_colours_of_all_themes(tab)
    tab.set_viewport_size({"width": 320, "height": 568})
    assert tab.evaluate("document.documentElement.scrollWidth") <= 320
    assert axe_finds(tab) == []

    said = tab.locator("#said")
    tab.get_by_role("link", name="Zum Bild").focus()
    tab.keyboard.press("Enter")
    assert tab.evaluate("document.activeElement.id") == "terrain"
    tab.keyboard.press("n")
    tab.get_by_text("Teil 1 von 3").wait_for()
    tab.keyboard.press("Space")
    tab.get_by_text("Berührt:").wait_for()
    tab.keyboard.press("w")
    tab.get_by_text("mm hoch").first.wait_for()
    assert "felt" in said.inner_text()
    tab.keyboard.press("Escape")
    tab.get_by_text("Keine Hand ist auf der Oberfläche.").wait_for()
    assert tab.evaluate("contexts") == 0, "nothing sounds before somebody asks for it"
    tab.get_by_role("button", name="Ton", exact=True).click()
    tab.get_by_text("Der Ton ist an.").wait_for()
    assert tab.evaluate("contexts") == 1
    tab.locator("#parts button").nth(1).click()
    tab.get_by_text("Teil 3 von 3").wait_for()

    tab.evaluate("pulses.length = 0")
    stroke_over_a_border(tab)
    tab.wait_for_function("() => pulses.includes(22) && window.rumbled")
    assert tab.evaluate("window.broken") is None


def test_page_in_firefox_is_explored(sent: str):
    with firefox() as tab:
        tab.open(sent)
        until(lambda: tab.evaluate("window.tangible !== undefined"))
        assert tab.evaluate("getComputedStyle(document.querySelector('h1')).direction") == "rtl"
        tab.evaluate("document.querySelector('#parts button').click()")
        until(lambda: " of 3" in tab.evaluate("document.querySelector('#said').textContent"))
        assert tab.complaints == []
        assert {url.partition(":")[0] for url in tab.requests} <= {"file", "data"}


def assert_words_of_the_language(tab: "Tab"):
    assert tab.evaluate("document.documentElement.lang") == "de"
    assert tab.locator("h1").inner_text() == HOSTILE[2]
    assert tab.locator("h1").evaluate("(each) => getComputedStyle(each).direction") == "rtl"
    assert tab.locator("#description").get_attribute("lang") == "de"
    assert "Eine Fläche" in tab.locator("#description").inner_text()
    from_near = [HOSTILE[1], HOSTILE[2], HOSTILE[0]]
    assert tab.locator("#parts button").all_inner_texts() == [one_line(each) for each in from_near]


def assert_forces_are_those_of_proxy(tab: "Tab"):
    """At the same places, on the surface as it is in the file."""
    from tangible_core.compiled.touch import CompiledTouch
    from tangible_render.contact.approach import REMEMBERED
    from tangible_render.kernels.proxy import tick
    from tangible_render.surface.coefficients import tile_bounds

    sent = next(surface_to_send(picture_to_send()))
    coefficients, labels = sent.coefficients, sent.labels
    assert labels is not None
    rows, columns = labels.shape
    width_m, length_m = sent.extent_m
    shape = coefficients, width_m, length_m, columns / width_m, rows / length_m
    assert json.loads(tab.evaluate(COEFFICIENTS)) == coefficients.ravel().tolist()

    positions_m = touches(PLACES)
    ends = np.arange(PLACES) * (len(positions_m) // PLACES) + len(positions_m) // PLACES - 1
    table = np.array(
        [
            (each.stiffness_n_per_m, each.damping_n_s_per_m, each.static_friction, each.dynamic_friction)
            for each in MATERIALS
        ]
    )
    memory = np.zeros(REMEMBERED)
    touch = CompiledTouch(tick, (*shape, tile_bounds(coefficients), labels, table, memory), memory)
    wanted_n = touch.path(positions_m)
    found_n = np.array(json.loads(tab.evaluate(FEEL, json.dumps(positions_m.tolist()))))
    size_n = np.linalg.norm(wanted_n, axis=1)
    assert (size_n[ends] > 0.1).sum() > PLACES / 2, "most of these places are in the surface"
    wrong_n = np.linalg.norm(found_n - wanted_n, axis=1)
    assert (wrong_n <= 0.02 * size_n + 1e-3).all(), np.flatnonzero(wrong_n > 0.02 * size_n + 1e-3)


def assert_colours_of_all_themes(tab: "Tab"):
    """In the dark, in high contrast, and where the system forces its colours."""
    grounds = set[str]()
    for scheme in ("dark", "light"):
        for contrast in ("no-preference", "more"):
            tab.emulate_media(color_scheme=scheme, contrast=contrast)
            tab.wait_for_function("(name) => document.documentElement.dataset.scheme === name", arg=scheme)
            assert axe_finds(tab, COLOURS) == [], (scheme, contrast)
            grounds.add(tab.evaluate("getComputedStyle(document.documentElement).backgroundColor"))
    assert len(grounds) >= 3, "the themes differ"
    tab.emulate_media(contrast="no-preference", forced_colors="active")
    assert tab.evaluate("matchMedia('(forced-colors: active)').matches")
    assert axe_finds(tab, COLOURS) == []
    tab.emulate_media(forced_colors="none")


def stroke_over_a_border(tab: "Tab"):
    """Hold the mouse button and cross the picture, which lies flat: without WebGL it is seen from above."""
    tab.set_viewport_size({"width": 1180, "height": 900})
    tab.locator("#terrain").scroll_into_view_if_needed()
    box: Any = tab.locator("#terrain").bounding_box()
    y = box["y"] + 0.45 * box["height"]
    tab.mouse.move(box["x"] + 0.4 * box["width"], y)
    tab.mouse.down()
    for share in np.linspace(0.4, 0.65, 40):
        tab.mouse.move(box["x"] + share * box["width"], y)
        tab.evaluate("new Promise((done) => setTimeout(done, 20))")
    tab.mouse.up()
