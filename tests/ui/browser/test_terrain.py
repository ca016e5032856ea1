"""The surface on the screen: colours are where the numbers say, edges are cut, a large relief is drawn."""

import io
import json
from pathlib import Path

import numpy as np
import pytest
from matplotlib import colormaps
from PIL import Image

from page_files import built_page
from page_panels import bring
from page_server import KEY, PageServer
from waiting import until

BEFORE, BEHIND = (0.016, 0.0), (-0.02, 0.0)
"""Places on the raised part and on the ground."""
PALETTE = {"ground": (230, 159, 0), "raised": (86, 180, 233)}
"""Colours of the first two kinds: the first without a pattern, the second with lines."""
PLAIN = {"raking": 0, "eyeDome": 0, "steep": "shown", "steepDeg": 60}


def settings(page, **changed) -> None:
    """Draw so from the next load on."""
    kept = json.dumps(json.dumps({**PLAIN, **changed}))
    page.evaluate("kept => localStorage.setItem('tangible.view', kept)", kept)


def from_above(page) -> None:
    page.wait_for_function("() => window.page?.scene && window.figures.firstMs > 0")
    page.focus("#terrain")
    page.keyboard.press("Control+End")
    wait_for_rest(page)


def wait_for_rest(page) -> None:
    page.wait_for_function("() => !window.page.view.dirty")
    page.evaluate("new Promise((done) => setTimeout(done, 400))")  # ends after the view's own, which draws it finely
    page.wait_for_function("() => !window.page.view.terrain?.moving")  # the first surface takes longer to come to rest
    page.wait_for_function("() => !window.page.view.dirty")


def pixels(page) -> np.ndarray:
    with Image.open(io.BytesIO(page.locator("#terrain").screenshot())) as picture:
        return np.asarray(picture.convert("RGB")).astype(float)


def around(page, picture: np.ndarray, place: tuple[float, float], reach: int = 6) -> np.ndarray:
    """Pixels about a place of the surface."""
    x, y = place
    at = page.evaluate("([x, y]) => window.page.view.toScreen([x, y, window.page.scene.height(x, y)])", [x, y])
    column, row = (round(each) for each in at)
    return picture[row - reach : row + reach + 1, column - reach : column + reach + 1].reshape(-1, 3)


@pytest.fixture(scope="module")
def folder(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A pair whose right half is raised, of another material, and whose truth is half a pixel off there."""
    at = tmp_path_factory.mktemp("scene")
    picture = np.zeros((48, 64, 3), np.uint8)
    picture[:, :32], picture[:, 32:] = (200, 60, 40), (30, 90, 160)
    disparity = np.full((48, 64), 2.0, np.float32)
    disparity[:, 32:] = 6.0
    truth = disparity + np.where(np.arange(64) < 32, 0.0, 0.5).astype(np.float32)
    Image.fromarray(picture).save(at / "left.png")
    Image.fromarray(picture).save(at / "right.png")
    np.save(at / "disparity.npy", disparity)
    np.save(at / "truth.npy", truth)
    Image.fromarray((np.arange(64) >= 32).astype(np.uint8)[None].repeat(48, 0)).save(at / "segments.png")
    (at / "p.yaml").write_text(
        "scene: {left: left.png, right: right.png, disparity: disparity.npy, truth: truth.npy,"
        " segments: segments.png}\n"
        "materials: {by: {0: wood, 1: cloth}}\n"
        "workspace: {width_m: 0.08, relief_m: 0.004, smooth_m: 0}\n"
        "relief: {slope: 0, spread: 0, accent_m: 0, grain_m: 0}\n"
        "render: {use: penalty}\n"
    )
    return at


@pytest.fixture
def url(opened, folder: Path) -> str:
    return opened(folder / "p.yaml")


def viridis(share: float) -> np.ndarray:
    return np.round(255 * np.array(colormaps["viridis"](float(share))[:3]))


def test_layers_have_the_colours_of_their_values(url: str, open_page):
    page = open_page(f"{url}&measure", draws=True, reduced_motion="reduce")
    settings(page)
    page.reload()
    from_above(page)
    wanted = {
        "photo": ((200, 60, 40), (30, 90, 160)),
        "height": (viridis(0), viridis(1)),
        "disparity": (viridis(0), viridis(1)),
        "confidence": (viridis(1), viridis(1)),
        "error": (viridis(0), viridis(1)),
        "slope": (viridis(0), viridis(0)),
        "materials": (PALETTE["ground"], PALETTE["raised"]),
        "segments": (PALETTE["ground"], PALETTE["raised"]),
    }
    for look, colours in wanted.items():
        page.select_option("#look", look)
        wait_for_rest(page)
        picture = pixels(page)
        for place, colour in zip((BEHIND, BEFORE), colours, strict=True):
            found = np.median(around(page, picture, place), 0)
            assert np.abs(found - np.array(colour)).max() <= 6, (look, place, found)
    plain, lined = (around(page, picture, place, 15).std(0).max() for place in (BEHIND, BEFORE))
    assert lined > plain + 10
    assert page.inner_text("#strip .legend") == "part 1: wood\npart 2: cloth"


def test_steep_edge_is_shown_greyed_or_cut(url: str, open_page):
    page = open_page(f"{url}&measure", draws=True, reduced_motion="reduce")
    settings(page, look="photo")
    page.reload()
    from_above(page)
    edge = (0.0, 0.0)
    seen = {}
    bring(page, "view")
    for steep in ("shown", "grey", "cut"):
        page.locator(f"#view input[value={steep}]").check()
        wait_for_rest(page)
        picture = pixels(page)
        seen[steep] = np.median(around(page, picture, edge, 1), 0)
        assert np.abs(np.median(around(page, picture, BEFORE), 0) - (30, 90, 160)).max() <= 6
    ground = np.median(pixels(page)[:4, :4].reshape(-1, 3), 0)
    assert np.abs(seen["cut"] - ground).max() <= 2
    assert np.ptp(seen["grey"]) <= 2
    assert np.ptp(seen["shown"]) > 40


def test_large_relief_is_drawn_coarsely_and_finer_where_one_looks(opened, open_page, tmp_path: Path):
    """The relief has a grain of two cells: from afar it is even, from near it is seen, and the hand feels it."""
    rows, columns = np.indices((1400, 1500)) // 2
    heights = np.where((rows + columns) % 2, 1000, 0).astype(np.uint16)
    heights[0, 0] = 65535
    Image.fromarray(heights).save(tmp_path / "height.png")
    (tmp_path / "p.yaml").write_text(
        f"scene: {{height: {tmp_path}/height.png}}\nworkspace: {{width_m: 0.08, relief_m: 0.002, finest_m: 0}}\n"
        "render: {use: penalty}\n"
    )
    page = open_page(f"{opened(tmp_path / 'p.yaml')}&measure", draws=True, reduced_motion="reduce")
    settings(page, look="relief", raking=1)
    page.reload()
    from_above(page)
    place = (0.011, 0.007)
    afar = around(page, pixels(page), place, 20).std()
    drawn = page.evaluate("() => { const { view } = window.page; return [view.terrain.moving, view.takesMs]; }")
    assert drawn[0] is False  # all of its triangles, though the first picture had fewer
    assert drawn[1] is not None and drawn[1] > 0  # and that was timed; infinity is no number in JSON
    assert page.evaluate("() => window.page.scene.whole.grid.heights.length") <= 350_000
    page.evaluate("([x, y]) => window.page.view.focus([x, y, 0], 0.003)", place)
    page.wait_for_function("() => window.page.scene.detail !== null")
    wait_for_rest(page)
    assert around(page, pixels(page), place, 20).std() > afar + 5
    pitch = 0.08 / 1500
    for row, column in [(560, 960), (560, 962), (561, 963)]:
        x, y = (column + 0.5) * pitch - 0.04, 0.5 * 0.08 * 1400 / 1500 - (row + 0.5) * pitch
        wanted = 0.002 * heights[row, column] / 65535
        assert page.evaluate("([x, y]) => window.page.scene.height(x, y)", [x, y]) == pytest.approx(wanted, abs=1e-9)
    page.keyboard.press("Control+Home")
    page.wait_for_function("() => window.page.scene.detail === null")


LINKED = """(() => {
  const { linkProgram, drawElements } = WebGL2RenderingContext.prototype;
  window.linked = 0;
  window.drawn = [];
  WebGL2RenderingContext.prototype.linkProgram = function (...told) { linked++; return linkProgram.apply(this, told); };
  WebGL2RenderingContext.prototype.drawElements = function (...told) {
    drawn.push([told[1], performance.now()]);
    return drawElements.apply(this, told);
  };
})()"""
"""Counts programs that are linked, and notes how many indices are drawn when."""
PUT = """() => {
  const { view } = window.page;
  const put = view.put.bind(view);
  view.put = (...told) => { window.putMs = performance.now(); put(...told); };
}"""
"""Notes when the view gets a surface."""


def test_first_surface_compiles_no_program_and_is_drawn_coarsely_first(
    open_page, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """The processor that draws the first surface also computes its touch."""
    built_page()
    rows, columns = 300, 400
    with PageServer(tmp_path, monkeypatch) as server:
        page = open_page("about:blank", draws=True)
        page.add_init_script(LINKED)
        page.goto(f"http://{server.host}/?token={KEY}&measure")
        page.wait_for_function("() => window.page?.view.prepared")
        linked = page.evaluate("() => linked")
        page.evaluate(PUT)
        surface = server.folder / "surface"
        surface.mkdir()
        np.zeros((rows, columns), "<f4").tofile(surface / "height-0.f32")
        np.zeros(1, "<u2").tofile(surface / "materials.u16")
        levels = [{"step": 1, "rows": rows, "columns": columns}]
        meta = {
            "digest": "surface", "name": "level", "shows": "surface", "rows": rows, "columns": columns,
            "extent_m": [0.08, 0.06], "height_m": [0, 0], "levels": levels, "labels": 0, "label_bytes": 2,
            "materials": [], "parts": None, "photo": False, "fine_photo": None, "layers": {},
        }  # fmt: skip
        server.done(lambda: server.session.tell("scene", **meta))
        whole = 6 * (rows + 1) * (columns + 1)
        page.wait_for_function("whole => window.drawn.some(([count]) => count === whole)", arg=whole)
        assert page.evaluate("() => [linked, page.view.prepared]") == [linked, None]
        drawn, put_ms = page.evaluate("() => [drawn, putMs]")
        page.close()  # it would look for its server
    coarse_ms, fine_ms = (
        next(at_ms for count, at_ms in drawn if fewest <= count < most)
        for fewest, most in ((whole // 20, whole), (whole, whole + 1))
    )
    assert coarse_ms < fine_ms
    assert fine_ms - put_ms > 1000


def test_lost_graphics_context_is_reported_and_restored(url: str, open_page, complaints: list[str]):
    """The screen has fine pixels, which are drawn where that is not slow."""
    page = open_page(f"{url}&measure", draws=True, reduced_motion="reduce", device_scale_factor=2)
    page.wait_for_function("() => window.page?.scene && window.figures.firstMs > 0")
    wait_for_rest(page)
    before = pixels(page)
    assert before.std() > 10
    page.evaluate(
        "() => { const gl = document.querySelector('#terrain').getContext('webgl2');"
        " window.taken = gl.getExtension('WEBGL_lose_context'); window.taken.loseContext() }"
    )
    page.wait_for_selector("#no-terrain:visible")
    page.evaluate("() => window.taken.restoreContext()")
    page.wait_for_selector("#no-terrain", state="hidden")
    wait_for_rest(page)
    assert np.abs(pixels(page) - before).mean() < 2
    complaints[:] = [each for each in complaints if "ontext" not in each]


def test_page_without_webgl_says_so_and_works(url: str, open_page, complaints: list[str]):
    page = open_page(f"{url}&measure")
    page.wait_for_function("() => window.page?.scene")
    assert "no WebGL" in page.inner_text("#no-terrain")
    page.select_option("#look", "height")
    assert "mm" in page.inner_text("#strip .legend")
    assert page.evaluate("() => window.page.scene.pick([0.016, 0, 1], [0, 0, -1])[2]") == pytest.approx(0.004, abs=1e-6)
    assert complaints == []


POSE = "() => window.page.view.eye.pose"


def test_camera_takes_its_own_gestures_and_leaves_others_to_the_hand(url: str, open_page):
    page = open_page(f"{url}&measure", draws=True, reduced_motion="reduce", has_touch=True)
    page.wait_for_function("() => window.page?.scene && window.figures.firstMs > 0")
    page.evaluate(
        "() => { window.heard = []; for (const kind of ['pointerdown', 'pointercancel', 'wheel'])"
        " document.querySelector('#terrain').addEventListener(kind, () => window.heard.push(kind)) }"
    )
    box = page.locator("#terrain").bounding_box()
    x, y = box["x"] + box["width"] / 2, box["y"] + box["height"] / 2

    def drag(button: str = "left") -> None:
        page.mouse.move(x, y)
        page.mouse.down(button=button)
        page.mouse.move(x + 40, y + 30, steps=3)
        page.mouse.up(button=button)

    home = page.evaluate(POSE)
    for button, key, part in [
        ("middle", None, "azimuth"),
        ("left", "Alt", "azimuth"),
        ("right", None, "target"),
        ("left", "Shift", "target"),
    ]:
        if key:
            page.keyboard.down(key)
        drag(button)
        if key:
            page.keyboard.up(key)
        assert page.evaluate(POSE)[part] != home[part], (button, key)
        page.focus("#terrain")
        page.keyboard.press("Control+Home")
        assert page.evaluate(POSE) == home
    page.keyboard.down("Control")
    page.mouse.wheel(0, -50)
    page.keyboard.up("Control")
    page.wait_for_function(f"() => ({POSE})().distance < {home['distance']}")
    assert page.evaluate("() => window.heard") == []
    page.mouse.wheel(0, -50)
    page.wait_for_function("() => window.heard.includes('wheel')")
    drag()
    assert "pointerdown" in page.evaluate("() => window.heard")

    page.evaluate("() => { window.heard = [] }")
    page.keyboard.press("Control+Home")
    touch = page.context.new_cdp_session(page)

    def fingers(kind: str, *at: tuple[float, float]) -> None:
        points = [{"x": each[0], "y": each[1], "id": number} for number, each in enumerate(at)]
        touch.send("Input.dispatchTouchEvent", {"type": kind, "touchPoints": points})

    fingers("touchStart", (x - 50, y))
    fingers("touchStart", (x - 50, y), (x + 50, y))
    fingers("touchMove", (x - 90, y), (x + 90, y))
    fingers("touchEnd")
    page.wait_for_function(f"() => ({POSE})().distance < {0.8 * home['distance']}")
    assert page.evaluate("() => window.heard") == ["pointerdown", "pointercancel"]


def test_fine_texture_is_drawn_in_the_magnifier_and_from_near(url: str, open_page):
    """The scene is flat there: whatever is seen is the cloth's texture."""
    page = open_page(f"{url}&measure", draws=True, reduced_motion="reduce")
    settings(page, look="relief", raking=1, lensMm=10)
    page.reload()
    from_above(page)
    flat = around(page, pixels(page), BEFORE, 20).std()
    box = page.locator("#terrain").bounding_box()
    x, y = page.evaluate("([x, y]) => window.page.view.toScreen([x, y, window.page.scene.height(x, y)])", BEFORE)
    page.mouse.move(box["x"] + x - 1, box["y"] + y)
    page.mouse.move(box["x"] + x, box["y"] + y)
    page.wait_for_selector("#lens:visible")
    assert page.inner_text("#lens").startswith("10 mm across. cloth: grain of ")
    magnified = page.evaluate(
        "() => { const lens = document.querySelector('#lens canvas');"
        " return [...lens.getContext('2d').getImageData(0, 0, lens.width, lens.height).data] }"
    )
    assert np.std(magnified[::4]) > 5
    page.evaluate("([x, y]) => window.page.view.focus([x, y, 0.004], 0.008)", BEFORE)
    page.mouse.move(box["x"] + 2, box["y"] + 2)
    until(lambda: around(page, pixels(page), BEFORE, 20).std() >= flat + 5)
