"""The drawing at the pixels where the numbers put it: surface, cursor and arrow, in a browser, on a known surface.

The surface is a step: level ground on the left and in front, level and 6 mm higher on the far right. The view gives the
place of a point on the screen; that the view itself is the right way round is tested first.
"""

import io
import json
import math
from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any, NamedTuple

import numpy as np
import pytest
from PIL import Image

from browser_tabs import Chromium, tabs
from lasting_server import LastingServer
from page_panels import open_panel
from waiting import until

WIDTH_M, LENGTH_M, HIGH_M = 0.08, 0.06, 0.006
ROWS, COLUMNS = 90, 120
STIFFNESS_N_PER_M = 500.0
PIPELINE = f"""\
scene: {{height: step.png, relief_m: {HIGH_M}}}
workspace: {{width_m: {WIDTH_M}}}
want: touch
render: {{use: penalty, stiffness_n_per_m: {STIFFNESS_N_PER_M}}}
device: falcon-simulated  # only its reach is drawn here
"""
DEVICE = 0xFF, 0x5D, 0x8F
TOUCHING = 1
LEFT, RIGHT = -0.02, 0.02
"""Far from the step, and from the rim."""

Vec = tuple[float, float, float]


class Shown(NamedTuple):
    """The page, and what the tests ask of it."""

    page: Any

    def spot(self, *at: float) -> np.ndarray:
        """Return the pixel of a place of the workspace on the canvas."""
        return np.array(self.page.evaluate("at => page.view.toScreen(at)", list(at)))

    def state(self, hand: Vec, force: Vec = (0, 0, 0), proxy: Vec | None = None) -> None:
        """Draw this state, whatever the loop says."""
        found = {
            "status": 1, "flags": TOUCHING if any(force) else 0, "seq": 1, "tag": 0, "overruns": 0, "sampleMs": 1,
            "hand": hand, "proxy": proxy, "force": force, "velocity": [0, 0, 0], "other": [0, 0, 0], "lateUs": 0,
            "arrivedMs": 1,
        }  # fmt: skip
        self.page.evaluate("s => { s.proxy ??= [NaN, NaN, NaN]; page.replayed = s; }", found)

    def only(self, *names: str) -> None:
        """Show these pieces of the overlay, and no others."""
        self.page.evaluate(
            "names => { const { overlay } = page; overlay.changed = true;"
            "for (const each in overlay.settings.show) overlay.settings.show[each] = names.includes(each);"
            "overlay.layer.classList.toggle('visually-hidden', !names.includes('labels')); }",
            list(names),
        )

    def click(self, *at: float) -> None:
        """The mouse, on the surface there."""
        self.wait_until_at_rest()
        self.page.mouse.click(*self.on_page(*at))

    def wait_until_at_rest(self) -> None:
        """Wait until the view rests: it gives way to a box that grows over the canvas."""

        def rests() -> bool:
            before = self.on_page(RIGHT, 0.01, HIGH_M)
            self.wait_until_drawn()
            return before == self.on_page(RIGHT, 0.01, HIGH_M)

        until(rests)

    def on_page(self, *at: float) -> tuple[float, float]:
        """Return the pixel of a place of the workspace on the page."""
        box, (x, y) = self.page.locator("#terrain").bounding_box(), self.spot(*at)
        return box["x"] + x, box["y"] + y

    def handle(self, name: str) -> np.ndarray:
        """The middle of a handle, on the canvas."""
        box, around = self.page.get_by_label(name).bounding_box(), self.page.locator("#terrain").bounding_box()
        return np.array([box["x"] + box["width"] / 2 - around["x"], box["y"] + box["height"] / 2 - around["y"]])

    def mapping(self) -> dict[str, Any]:
        """Return the mapping of the document."""
        return self.page.evaluate("() => page.document.values.mapping ?? {}")

    def wait_until_drawn(self) -> None:
        """Wait until the newest state is drawn."""
        self.page.evaluate("() => new Promise(done => requestAnimationFrame(() => requestAnimationFrame(done)))")

    def pixels(self) -> np.ndarray:
        """The canvas as it is drawn now."""
        self.wait_until_drawn()
        box = self.page.locator("#terrain").bounding_box()
        with Image.open(io.BytesIO(self.page.screenshot(clip=box))) as picture:
            return np.asarray(picture.convert("RGB")).astype(int)


@pytest.fixture(scope="module")
def shown(chromium: Chromium, lasting: LastingServer, tmp_path_factory: pytest.TempPathFactory) -> Iterator[Shown]:
    """The step, felt; what lies over the canvas is out of the way."""
    folder = tmp_path_factory.mktemp("step")
    step = np.zeros((ROWS, COLUMNS), np.uint16)
    step[: ROWS * 3 // 4, COLUMNS // 2 :] = 50_000
    Image.fromarray(step).save(folder / "step.png")
    (folder / "p.yaml").write_text(PIPELINE)
    url = lasting.open(folder / "p.yaml")
    with ExitStack() as pages:
        with chromium.used() as browser:
            open_page = pages.enter_context(tabs(browser, []))
            page = open_page(f"{url}&measure", draws=True, viewport={"width": 1400, "height": 800})
            page.wait_for_function("() => window.page?.scene && figures.firstMs > 0")
            page.context.grant_permissions(["clipboard-read", "clipboard-write"])
            for panel in ("ruler-panel", "mapping-panel"):
                open_panel(page, panel)
        yield Shown(page)
        with chromium.used():
            pages.close()


@pytest.fixture(autouse=True)
def live_again(shown: Shown, browser: Any) -> Iterator[None]:
    yield
    shown.page.evaluate("() => { page.replayed = null; clearInterval(window.held); page.net.release(); }")


def near(picture: np.ndarray, spot: np.ndarray) -> np.ndarray:
    """The colour there."""
    x, y = np.round(spot).astype(int)
    return picture[y - 1 : y + 2, x - 1 : x + 2].reshape(-1, 3).mean(axis=0)


def centroid(mask: np.ndarray) -> np.ndarray:
    """Return the centroid of a mask: x, y from the upper left corner, at pixels' middles."""
    rows, columns = np.nonzero(mask)
    assert len(rows), "nothing is drawn"
    return np.array([columns.mean() + 0.5, rows.mean() + 0.5])


def colour_mask(picture: np.ndarray, colour: tuple[int, int, int]) -> np.ndarray:
    return np.abs(picture - colour).max(axis=2) < 24


def test_surface_is_drawn_the_right_way_round_and_in_place(shown: Shown):
    """Right is right, away is up, high is up; its far edge, low on the left and high on the right, ends it."""
    middle, right, away, high = (shown.spot(*at) for at in ((0, 0, 0), (0.01, 0, 0), (0, 0.01, 0), (0, 0, 0.01)))
    assert right[0] > middle[0] + 10
    assert away[1] < middle[1] - 5
    assert high[1] < middle[1] - 5
    shown.only()
    shown.page.evaluate("() => { page.view.eyeDome = 0; page.view.dirty = true; }")  # which darkens around an edge
    picture = shown.pixels()
    ground = picture[3:8, 3:8].reshape(-1, 3).mean(axis=0)
    for x, z in ((LEFT, 0.0), (RIGHT, HIGH_M)):
        edge = LENGTH_M / 2
        assert np.abs(near(picture, shown.spot(x, edge + 0.0015, z)) - ground).max() < 3
        assert np.abs(near(picture, shown.spot(x, edge - 0.0015, z)) - ground).max() > 6
        assert shown.page.evaluate("([x, y]) => page.scene.height(x, y)", [x, 0.01]) == pytest.approx(z, abs=1e-5)


@pytest.mark.parametrize("hand", [(LEFT, 0.015, 0.004), (RIGHT, -0.002, HIGH_M - 0.001), (LEFT, -0.02, -0.002)])
def test_cursor_is_drawn_at_the_hand(shown: Shown, hand: Vec):
    """The cursor is drawn under the surface too, through which it is seen."""
    shown.only("device")
    shown.state(hand)
    found = centroid(colour_mask(shown.pixels(), DEVICE))
    assert np.hypot(*(found - shown.spot(*hand))) < 2


@pytest.mark.parametrize("force", [(0.0, 0.0, 3.0), (1.5, 0.0, 2.0), (-1.0, 1.5, 2.5)])
@pytest.mark.parametrize("proxy", [None, (LEFT + 0.004, 0.003, 0.0)])
def test_arrow_is_drawn_as_long_as_the_force(shown: Shown, force: Vec, proxy: Vec | None):
    """The arrow begins at the contact, and ends where the scale of metres to a newton puts its tip."""
    hand = LEFT, 0.0, -0.001
    contact = np.array(proxy or (LEFT, 0.0, 0.0))
    shown.state(hand, force, proxy)
    shown.only()
    without = shown.pixels()
    shown.only("arrow")
    arrow = np.abs(shown.pixels() - without).max(axis=2) > 40
    scale = shown.page.evaluate("() => page.overlay.settings.metresPerNewton")
    begin, end = shown.spot(*contact), shown.spot(*(contact + scale * np.array(force)))
    rows, columns = np.nonzero(arrow)
    along = (np.stack([columns + 0.5, rows + 0.5], axis=1) - begin) @ (end - begin) / np.hypot(*(end - begin))
    assert np.hypot(*(end - begin)) > 30
    assert along.max() == pytest.approx(np.hypot(*(end - begin)), abs=3.5)
    assert along.min() == pytest.approx(0, abs=4)
    tip = np.array([columns[along.argmax()], rows[along.argmax()]]) + 0.5
    assert np.hypot(*(tip - end)) < 4


def test_trace_is_drawn_where_the_contact_was(shown: Shown):
    """The trace runs between the places of two states, and not over a place where the hand was released."""
    shown.only()
    before = shown.pixels()
    shown.only("trace")
    shown.page.evaluate("() => { page.overlay.settings.seconds = 30; }")
    for hand in ((LEFT - 0.008, 0.0, -0.001), (LEFT, 0.0, -0.001), (LEFT, 0.0, 0.9), (LEFT, 0.012, -0.001)):
        shown.state(hand, (0, 0, 4))
        shown.wait_until_drawn()
    changed = np.abs(shown.pixels() - before)
    assert near(changed, shown.spot(LEFT - 0.004, 0, 0)).max() > 20
    assert near(changed, shown.spot(LEFT, 0.006, 0)).max() < 5


def test_pressed_mouse_gives_the_force_that_is_shown(shown: Shown):
    """The force runs from the mouse to the loop and back: F = k d, drawn and in figures."""
    shown.only("device", "labels", "arrow")
    mouse = shown.page.mouse
    until(lambda: shown.page.evaluate("() => page.net.latest !== null"))
    until(lambda: "penalty" in shown.page.inner_text("#log"))
    mouse.move(*shown.on_page(RIGHT - 0.001, 0.01, HIGH_M))
    mouse.down()

    def press() -> Any:
        mouse.move(*shown.on_page(RIGHT, 0.01, HIGH_M))
        state = shown.page.evaluate(
            "alone => { const s = page.net.latest; if (!s || (s.flags & 255) !== alone) return null;"
            "page.replayed = s; return { hand: s.hand, force: s.force }; }",
            TOUCHING,
        )
        if state and math.dist(state["hand"][:2], (RIGHT, 0.01)) < 5e-4 and abs(state["force"][2]) > 0.2:
            return state
        shown.page.evaluate("() => { page.replayed = null; }")
        return None

    state = until(press)
    mouse.up()
    shown.wait_until_at_rest()
    hand, force = np.array(state["hand"]), np.array(state["force"])
    assert hand[:2] == pytest.approx([RIGHT, 0.01], abs=5e-4)
    assert force[2] == pytest.approx(STIFFNESS_N_PER_M * (HIGH_M - hand[2]), rel=0.05)
    assert np.abs(force[:2]).max() < 1e-6
    found = centroid(colour_mask(shown.pixels(), DEVICE))
    assert np.hypot(*(found - shown.spot(*hand))) < 2
    until(lambda: f"{force[2]:.2f} N" in shown.page.inner_text(".live-label .force"))
    shown.page.evaluate("() => { document.getElementById('data-cursor').open = true; }")
    until(lambda: f"{force[2]:.3f} N" in shown.page.inner_text("#data-cursor"))
    shown.page.evaluate("() => { document.getElementById('data-cursor').open = false; }")


def test_view_rests_under_a_pressed_hand(shown: Shown):
    """What covers the canvas meanwhile moves the surface when the hand is let go, not under it."""

    def show_all_values(shows: bool) -> None:
        """Values that cover less than half of the canvas: wider ones are not given way to."""
        shown.page.evaluate(
            "shows => { const box = document.getElementById('data-cursor'); box.open = shows;"
            "box.querySelector('.all').style.maxInlineSize = shows ? '30%' : ''; }",
            shows,
        )

    def place() -> list[float]:
        shown.wait_until_drawn()
        return shown.spot(RIGHT, 0.01, HIGH_M).tolist()

    shown.wait_until_at_rest()
    shown.page.mouse.move(*shown.on_page(RIGHT, 0.01, HIGH_M))
    shown.page.mouse.down()
    before = place()
    show_all_values(True)
    until(lambda: shown.page.locator("#data-cursor > .all").bounding_box())
    assert [place() for _ in range(3)] == [before] * 3
    shown.page.mouse.up()
    until(lambda: place()[0] < before[0] - 10)
    shown.wait_until_at_rest()
    beside = place()
    show_all_values(False)
    until(lambda: place()[0] > beside[0] + 10)


def test_values_are_copied_as_they_are(shown: Shown):
    hand, force = (LEFT, 0.005, -0.0015), (0.25, 0.0, 0.75)
    shown.state(hand, force)
    shown.pixels()
    shown.page.focus("#terrain")
    shown.page.keyboard.press("Shift+C")
    copied = until(lambda: shown.page.evaluate("() => navigator.clipboard.readText()"))
    device = json.loads(copied)["device"]
    assert device["position_m"] == pytest.approx(hand)
    assert device["contact_m"] == pytest.approx([LEFT, 0.005, 0.0], abs=1e-6)
    assert device["force_n"] == pytest.approx(force)
    assert device["magnitude_n"] == pytest.approx(math.hypot(*force))
    assert device["depth_m"] == pytest.approx(0.0015, abs=1e-6)


def test_ruler_measures_the_step(shown: Shown):
    """The ruler is set by the mouse, then by the keyboard; its figures are those of the drawn ends."""
    shown.only("labels")
    shown.page.get_by_role("button", name="Measure with the mouse").click()
    shown.click(LEFT, 0.01, 0.0)
    shown.click(RIGHT, 0.01, HIGH_M)
    shown.page.get_by_role("button", name="Measure with the mouse").click()

    def figures() -> list[float]:
        says = shown.page.locator("#ruler-panel dd").all_inner_texts()
        return [float(each.split()[0].rstrip("°").replace("\N{MINUS SIGN}", "-")) for each in says]

    across, rise = 1e3 * (RIGHT - LEFT), 1e3 * HIGH_M
    cell = 1e3 * WIDTH_M / COLUMNS  # over which the step rises
    along = across - cell + np.hypot(cell, rise)
    wanted = [np.hypot(across, rise), across, along, rise, np.degrees(np.arctan2(rise, across))]
    assert figures() == pytest.approx(wanted, abs=0.15)
    shown.wait_until_at_rest()
    for name, at in (("Start of the ruler", (LEFT, 0.01, 0.0)), ("End of the ruler", (RIGHT, 0.01, HIGH_M))):
        assert np.hypot(*(shown.handle(name) - shown.spot(*at))) < 2
    before = figures()[1]
    shown.page.get_by_label("End of the ruler").focus()
    shown.page.keyboard.press("Shift+ArrowRight")
    assert figures()[1] - before == pytest.approx(5, abs=0.02)
    shown.page.focus("#terrain")
    shown.page.keyboard.press("Shift+M")
    assert not shown.page.locator("#ruler-panel dl").count()


def test_frame_is_the_device_s_reach_and_can_be_dragged(shown: Shown):
    """A Falcon reaches 80 mm: at twice the scale 40 mm of the picture. What is dragged is written to the document."""
    side = 0.04
    shown.only("labels")
    shown.page.get_by_label("Show what the device reaches").check()
    shown.page.evaluate("() => page.net.ask('set', { changes: { 'mapping.scale': 2 } })")
    until(lambda: shown.mapping().get("scale") == 2)
    until(lambda: "40.0 \N{MULTIPLICATION SIGN} 40.0" in shown.page.inner_text("#mapping-panel"))
    shown.pixels()
    assert np.hypot(*(shown.handle("Move the frame") - shown.spot(0, 0, HIGH_M / 2))) < 15  # on the step itself
    corner = shown.page.locator(".handle.square").first.bounding_box()
    around = shown.page.locator("#terrain").bounding_box()
    at = np.array([corner["x"] + corner["width"] / 2 - around["x"], corner["y"] + corner["height"] / 2 - around["y"]])
    assert np.hypot(*(at - shown.spot(-side / 2, -side / 2, 0))) < 2
    mouse = shown.page.mouse
    x, y = shown.handle("Move the frame")
    mouse.move(x + around["x"], y + around["y"])
    mouse.down()
    mouse.move(*shown.on_page(-0.015, 0.005, 0.0), steps=3)
    mouse.up()
    offset = until(lambda: any(found := shown.mapping().get("offset_m", [])) and found)
    assert offset == pytest.approx([0.03, -0.01, 0], abs=1e-3)
    shown.page.get_by_label("Turn the frame").focus()
    shown.page.keyboard.press("ArrowUp")
    until(lambda: shown.mapping().get("rotation_deg") == -1)
    shown.page.focus("#terrain")
    shown.page.keyboard.press("z")
    region = until(lambda: shown.mapping().get("region_m"))
    assert region[2:] == pytest.approx([side / 2, side / 2], rel=1e-3)
    shown.page.keyboard.press("Shift+Z")
    until(lambda: "region_m" not in shown.mapping())
    assert shown.page.evaluate("() => page.document.text") == PIPELINE + "mapping: {rotation_deg: -1}\n"


def test_reach_of_the_newest_document_stays_when_an_older_answer_comes_last(shown: Shown):
    shown.page.get_by_label("Show what the device reaches").check()
    shown.page.evaluate(
        """() => {
          const { net } = page;
          const ask = net.ask;
          const late = new Promise((done) => (window.let_go = done));
          net.ask = async function (name, args) {
            if (name !== "reach") return ask.call(net, name, args);
            net.ask = ask;
            await late;
            return { device: "older", workspace_m: [0.02, 0.02, 0.02] };
          };
        }"""
    )
    for scale in (2, 4):
        shown.page.evaluate("(to) => page.net.ask('set', { changes: { 'mapping.scale': to } })", scale)
        until(lambda scale=scale: shown.mapping().get("scale") == scale)
    panel = shown.page.locator("#mapping-panel")
    until(lambda: "20.0 \N{MULTIPLICATION SIGN} 20.0" in panel.inner_text())
    shown.page.evaluate("let_go(), new Promise((done) => setTimeout(done))")
    assert "20.0 \N{MULTIPLICATION SIGN} 20.0" in panel.inner_text()
    shown.page.evaluate("() => page.net.ask('set', { changes: {}, removed: ['mapping.scale'] })")
