"""The drawing at the pixels where the numbers put it: otherwise hand and force are seen elsewhere than they are."""

import io
from collections.abc import Iterator
from contextlib import ExitStack
from typing import Any, NamedTuple

import numpy as np
import pytest
from PIL import Image

from browser_tabs import Chromium, tabs
from lasting_server import LastingServer
from page_panels import open_panel

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
pytestmark = pytest.mark.usefixtures("browser")


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
