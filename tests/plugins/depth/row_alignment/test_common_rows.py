"""The cheap look before rectification, from outside of the methods that use it."""

from collections.abc import Callable

import numpy as np
import pytest

from stereo_scenes import known_pair
from tangible_core.data import Calibration, Views
from tangible_core.plugins.notes import collected
from tangible_core.testing.synthetic.stereo_scenes import SCENES
from tangible_depth.dense.span import Span
from tangible_depth.matching import chain
from tangible_depth.row_alignment.common_rows import common_row_offset, rows_correspond
from tangible_depth.row_alignment.corner_check import corners_correspond
from tangible_depth.row_alignment.profile_check import rows_match_elsewhere
from tangible_depth.search import disparity_range
from tangible_depth.search.bands import Bands, match_bands
from tangible_depth.search.disparity_range import find_disparity_range
from tangible_depth.search.pairs import Pair, grey_pair
from tangible_depth.search.range_in_bands import RangeEstimate, find_range
from tangible_depth.semi_global import SemiGlobal
from tangible_depth.zncc import Zncc
from two_cameras import Scene, roll_and_tilt

SCENE = Scene((240, 320), 8.0, 20.0)
LARGE = Scene((720, 1280), 20.0, 40.0)


def roll_camera(degrees: float, scene: Scene = SCENE) -> Views:
    return Views(scene.left(), scene.right(roll_and_tilt(scene.shape, degrees)))


def shift_right_view(views: Views, rows: int) -> Views:
    return Views(views.left, np.roll(views.right, rows, axis=0))


Look = Callable[..., bool]


def offset(pair: Pair) -> float | None:
    found = find_range(pair)
    return common_row_offset(pair, found.bands if found else match_bands(pair, Span(0, 15)))


def bands_correspond(pair: Pair) -> bool:
    return offset(pair) is not None or corners_correspond(pair)


look = pytest.mark.parametrize("correspond", [corners_correspond, bands_correspond])


@look
@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("width", [160, 320, 480])
def test_rows_of_a_rectified_pair_correspond(scene: str, width: int, correspond: Look):
    pair = grey_pair(known_pair(scene, width, width * 3 // 4).views, "")
    assert correspond(pair)


@look
@pytest.mark.parametrize("damage", [lambda z: 0.5 * z + 0.2, lambda z: z**1.6])
def test_rows_correspond_with_another_exposure(damage, correspond: Look):
    assert correspond(grey_pair(Views(SCENE.left(), damage(SCENE.right())), ""))


@look
@pytest.mark.parametrize("degrees", [-2, 1, 2, 5, 30])
def test_rotated_camera_is_detected(degrees: float, correspond: Look):
    assert not correspond(grey_pair(roll_camera(degrees), ""))


@look
def test_large_pair_has_a_tolerance_of_a_pixel(correspond: Look):
    assert not correspond(grey_pair(roll_camera(0.5, LARGE), ""))
    assert correspond(grey_pair(known_pair("planes", 960, 720).views, ""))


def test_common_offset_within_the_matchers_limit_is_accepted():
    views = known_pair("planes", 320, 240).views
    assert not corners_correspond(grey_pair(shift_right_view(views, 1), ""))
    assert corners_correspond(grey_pair(shift_right_view(views, 1), ""), most_row_offset_px=1)
    assert not corners_correspond(grey_pair(shift_right_view(views, 3), ""), most_row_offset_px=1)


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("rows", [-1, 0, 1])
def test_common_offset_is_measured(scene: str, rows: int):
    views = known_pair(scene, 320, 240, seed=3).views
    assert offset(grey_pair(shift_right_view(views, rows), "")) == pytest.approx(rows, abs=0.1)


def test_common_offset_is_corrected_without_rectification():
    views = known_pair("planes", 320, 240).views
    with collected() as notes:
        found = Zncc().estimate(shift_right_view(views, 1)).disparity_px
    assert any(each.startswith("rows realigned by") for each in notes)
    assert not any(each.startswith("rectified") for each in notes)
    straight = Zncc().estimate(views).disparity_px
    assert np.mean(np.abs(found - straight)[2:-2] <= 1) >= 0.98


@look
@pytest.mark.parametrize("shape", [(1, 1), (1, 80), (80, 1), (20, 40), (100, 160)])
def test_pair_without_corners_is_taken_as_rectified(shape: tuple[int, int], correspond: Look):
    flat = np.full(shape, 100, np.uint8)
    assert correspond(grey_pair(Views(flat, flat), ""))


def share_right(found: np.ndarray) -> float:
    return float(np.mean(np.abs(found - SCENE.disparity_px())[SCENE.visible()] <= 2))


def test_raw_pair_is_matched_nearly_as_well_as_a_rectified_one():
    straight = Zncc().estimate(Views(SCENE.left(), SCENE.right())).disparity_px
    with collected() as notes:
        raw = Zncc().estimate(roll_camera(2)).disparity_px
    assert any(each.startswith("rectified: ") for each in notes)
    assert share_right(raw) >= share_right(straight) - 0.03
    never = Zncc(rectify="never").estimate(roll_camera(2)).disparity_px
    assert share_right(never) < 0.8


def test_rectified_pair_gives_the_same_map_with_rectify_never():
    views = known_pair("planes", 320, 240).views
    assert Zncc().estimate(views).digest() == Zncc(rectify="never").estimate(views).digest()


def test_calibrated_pair_is_not_tested():
    views = roll_camera(2)
    calibrated = Views(views.left, views.right, Calibration(300.0, 0.1))
    with collected() as notes:
        found = Zncc(max_disparity_px=16).estimate(calibrated)
    assert not any("rows" in each or "rectified" in each for each in notes)
    assert found.digest() == Zncc(max_disparity_px=16, rectify="never").estimate(views).digest()


def bricks(rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
    """A wall at places (y, x): courses of 12 rows, bricks of 24 columns, each of a tone of its own."""
    course, column = rows // 12, columns + rows // 12 % 2 * 12
    tones = np.random.default_rng(0).integers(80, 150, (100, 100))
    grain = np.random.default_rng(1).integers(-8, 9, (700, 900))
    mortar = (rows % 12 < 2) | (column % 24 < 2)
    return (np.where(mortar, 200, tones[course, column // 24]) + grain[rows, columns]).astype(np.uint8)


WALL_PX, PILLAR_PX = 20, 34


def is_pillar(rows: np.ndarray, columns: np.ndarray) -> np.ndarray:
    return (abs(columns - 260) < 60) & (abs(rows - 150) < 80)


def walls(rows_lower: int) -> tuple[Views, np.ndarray]:
    """A wall and a pillar of bricks before it, the right view some rows lower, and the disparity of the left one."""
    y, x = np.indices((300, 400))
    left = np.where(is_pillar(y, x), bricks(y + 300, x + 300), bricks(y + 100, x + 100))
    v = y - rows_lower
    pillar = bricks(v + 300, x + 300 + PILLAR_PX)
    right = np.where(is_pillar(v, x + PILLAR_PX), pillar, bricks(v + 100, x + 100 + WALL_PX))
    return Views(left, right), np.where(is_pillar(y, x), PILLAR_PX, WALL_PX)


@pytest.mark.parametrize("rows_lower", [-24, 12, 36])
def test_repeating_courses_do_not_pass_as_aligned(rows_lower: int):
    """The next course fits as well to a look along the rows; the wall as a whole lies elsewhere."""
    views, truth = walls(rows_lower)
    assert not rows_match_elsewhere(grey_pair(walls(0)[0], ""))
    assert rows_match_elsewhere(grey_pair(views, ""))
    error = (SemiGlobal().estimate(views).disparity_px - truth)[40:-40, 60:-40]
    assert np.mean(np.abs(error - np.nanmedian(error)) <= 2) >= 0.93


@pytest.mark.parametrize("scene", SCENES)
def test_rows_of_a_rectified_pair_match_at_their_own_height(scene: str):
    views = known_pair(scene, 320, 240).views
    assert not rows_match_elsewhere(grey_pair(views, ""))
    assert rows_match_elsewhere(grey_pair(shift_right_view(views, 10), ""))


def test_map_of_low_confidence_is_retried_with_rectification(monkeypatch: pytest.MonkeyPatch):
    """The rows do not correspond, but the tests are patched to accept them."""
    monkeypatch.setattr(chain, "align_rows", lambda pair, *_: pair)
    with collected() as notes:
        found = Zncc().estimate(roll_camera(6)).disparity_px
    assert any(each.startswith("retried with rectification") for each in notes)
    assert any(each.startswith("rectified: ") for each in notes)
    assert share_right(found) >= 0.9


@pytest.mark.parametrize("noise_sd", [12, 50])
def test_noisy_pair_is_not_retried_with_rectification(noise_sd: int):
    """Noise leaves most pixels unmatched, but the matched ones lie in their own rows; otherwise the pair is retried."""
    pair = [roll_camera(degrees) for degrees in (0, 1)]
    for views, correspond in zip(pair, (True, False), strict=True):
        rng = np.random.default_rng(3)
        noise = rng.normal(0, noise_sd, (2, *SCENE.shape))
        noisy = Views(
            *(np.clip(a + b, 0, 255).astype(np.uint8) for a, b in zip(grey_pair(views, ""), noise, strict=True))
        )
        found = SemiGlobal(rectify="never", max_disparity_px=48).estimate(noisy)
        assert rows_correspond(grey_pair(noisy, ""), found.disparity_px, found.confidence >= 0.2) == correspond


def test_chance_matches_do_not_widen_the_verified_range(monkeypatch: pytest.MonkeyPatch):
    """A tenth of the matches is random, as beyond the border of a rectified picture; the others are in 0..60 px."""
    random = np.random.default_rng(0)
    found_px = np.concatenate([random.uniform(0, 60, 21600), random.uniform(-270, 200, 2400)]).reshape(24, 1000)
    bands = Bands(np.arange(24), np.rint(16 * found_px).astype(np.int16), 1, found_px.size, 0.3)
    monkeypatch.setattr(disparity_range, "find_range", lambda pair: RangeEstimate(Span(-273, 200), bands, False))
    pair = Pair.of(*[np.zeros((24, 1000), np.uint8)] * 2)
    assert find_disparity_range(pair, "auto", "auto").span.low == -273
    found = find_disparity_range(pair, "auto", "auto", (3, 40)).span
    assert -16 <= found.low <= 0
    assert 60 <= found.high <= 128


def test_band_matches_widen_the_verified_range():
    scene = known_pair("planes", 480, 360)
    found = find_disparity_range(grey_pair(scene.views, ""), "auto", "auto", (20, 24)).span
    assert found.low <= scene.truth_px.min()
    assert found.high >= scene.truth_px.max()


def test_pair_that_is_rectified_logs_no_range_before():
    with collected() as notes:
        Zncc().estimate(roll_camera(2))
    assert sum("disparities outside" in each for each in notes) == 1
