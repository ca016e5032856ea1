"""The cheap look before rectification, from outside of the methods that use it."""

from collections.abc import Callable

import numpy as np
import pytest

from tangible_core.data import Calibration, Views
from tangible_core.plugins.notes import collected
from tangible_core.synthetic.stereo_scenes import SCENES, synthetic_pair
from tangible_depth.dense.span import Span
from tangible_depth.search.bands import match_bands
from tangible_depth.search.corner_look import corners_correspond
from tangible_depth.search.pairs import Pair, grey_pair
from tangible_depth.search.raw_pairs import common_row_offset
from tangible_depth.search.search_range import find_range
from tangible_depth.zncc import Zncc
from two_cameras import Scene, roll_and_tilt


def rolled(degrees: float, scene: Scene | None = None) -> Views:
    scene = scene or Scene((240, 320), 8.0, 20.0)
    return Views(scene.left(), scene.right(roll_and_tilt(scene.shape, degrees)))


def shifted(views: Views, rows: int) -> Views:
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
    pair = grey_pair(synthetic_pair(scene, width, width * 3 // 4).views, "")
    assert correspond(pair)


@look
@pytest.mark.parametrize("damage", [lambda z: 0.5 * z + 0.2, lambda z: z**1.6])
def test_another_exposure_is_no_other_geometry(damage, correspond: Look):
    scene = Scene((240, 320), 8.0, 20.0)
    assert correspond(grey_pair(Views(scene.left(), damage(scene.right())), ""))


@look
@pytest.mark.parametrize("degrees", [-2, 1, 2, 5, 30])
def test_a_turned_camera_is_noticed(degrees: float, correspond: Look):
    assert not correspond(grey_pair(rolled(degrees), ""))


@look
@pytest.mark.slow
def test_a_large_pair_is_looked_at_to_a_pixel(correspond: Look):
    scene = Scene((720, 1280), 20.0, 40.0)
    assert not correspond(grey_pair(rolled(0.5, scene), ""))
    assert correspond(grey_pair(synthetic_pair("planes", 960, 720).views, ""))


def test_a_common_offset_is_left_to_who_puts_it_right():
    views = synthetic_pair("planes", 320, 240).views
    assert not corners_correspond(grey_pair(shifted(views, 1), ""))
    assert corners_correspond(grey_pair(shifted(views, 1), ""), most_row_offset_px=1)
    assert not corners_correspond(grey_pair(shifted(views, 3), ""), most_row_offset_px=1)


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("rows", [-1, 0, 1])
def test_a_common_offset_is_measured(scene: str, rows: int):
    views = synthetic_pair(scene, 320, 240, seed=3).views
    assert offset(grey_pair(shifted(views, rows), "")) == pytest.approx(rows, abs=0.1)


def test_a_common_offset_is_put_right_and_not_rectified():
    views = synthetic_pair("planes", 320, 240).views
    with collected() as notes:
        found = Zncc().estimate(shifted(views, 1)).disparity_px
    assert any(each.startswith("rows realigned by") for each in notes)
    assert not any(each.startswith("rectified") for each in notes)
    straight = Zncc().estimate(views).disparity_px
    assert np.mean(np.abs(found - straight)[2:-2] <= 1) >= 0.98


@look
@pytest.mark.parametrize("shape", [(1, 1), (1, 80), (80, 1), (20, 40), (100, 160)])
def test_without_corners_a_pair_is_taken_as_it_is(shape: tuple[int, int], correspond: Look):
    flat = np.full(shape, 100, np.uint8)
    assert correspond(grey_pair(Views(flat, flat), ""))


def share_right(found: np.ndarray, scene: Scene) -> float:
    return float(np.mean(np.abs(found - scene.disparity_px())[scene.visible()] <= 2))


@pytest.mark.slow
def test_a_raw_pair_is_matched_nearly_as_well_as_a_rectified_one():
    scene = Scene((240, 320), 8.0, 20.0)
    straight = Zncc().estimate(Views(scene.left(), scene.right())).disparity_px
    with collected() as notes:
        raw = Zncc().estimate(rolled(2, scene)).disparity_px
    assert any(each.startswith("rectified: ") for each in notes)
    assert share_right(raw, scene) >= share_right(straight, scene) - 0.03
    never = Zncc(rectify="never").estimate(rolled(2, scene)).disparity_px
    assert share_right(never, scene) < 0.8


def test_a_rectified_pair_gives_the_methods_own_map():
    views = synthetic_pair("planes", 320, 240).views
    assert Zncc().estimate(views).digest() == Zncc(rectify="never").estimate(views).digest()


def test_a_calibrated_pair_is_not_looked_at():
    views = rolled(2)
    calibrated = Views(views.left, views.right, Calibration(300.0, 0.1))
    with collected() as notes:
        found = Zncc(max_disparity_px=16).estimate(calibrated)
    assert not any("rows" in each or "rectified" in each for each in notes)
    assert found.digest() == Zncc(max_disparity_px=16, rectify="never").estimate(views).digest()
