"""The surface on the screen: otherwise its colours are others than the numbers say, or a large one is not drawn."""

import io
import json
from pathlib import Path

import numpy as np
import pytest
from matplotlib import colormaps
from PIL import Image

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
        "materials: {by: {1: wood, 2: cloth}}\n"
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


def test_ground_is_dark_where_the_system_forces_its_own_dark_colours(url: str, open_page):
    page = open_page(f"{url}&measure", draws=True, color_scheme="dark", forced_colors="active")
    from_above(page)
    assert pixels(page)[4, 4].max() < 60


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


def test_large_relief_is_drawn_coarsely_and_finer_where_one_looks(opened, open_page, tmp_path: Path):
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
