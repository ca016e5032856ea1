"""The cheap look before rectification: else raw pairs are matched as they are, or good ones are bent."""

from collections.abc import Callable

import numpy as np
import pytest

from stereo_scenes import known_pair, texture
from tangible_core.data import Calibration, Views
from tangible_core.plugins.notes import collected
from tangible_core.testing.synthetic.stereo_scenes import SCENES
from tangible_depth.dense.span import UNKNOWN, Span
from tangible_depth.row_alignment import common_rows
from tangible_depth.row_alignment.common_rows import (
    common_row_offset,
    corners_correspond,
    rows_correspond,
    rows_match_elsewhere,
    shift_rows,
)
from tangible_depth.row_alignment.row_offset import row_votes
from tangible_depth.search.bands import match_bands
from tangible_depth.search.disparity_range import find_range
from tangible_depth.search.pairs import Pair, grey_pair
from tangible_depth.semi_global import SemiGlobal
from tangible_depth.zncc import Zncc
from two_cameras import Scene, roll_and_tilt

SCENE = Scene((240, 320), 8.0, 20.0)


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
def test_rows_of_a_rectified_pair_correspond(scene: str, correspond: Look):
    pair = grey_pair(known_pair(scene, 320, 240).views, "")
    assert correspond(pair)


@look
@pytest.mark.parametrize("degrees", [-2, 1, 30])
def test_rotated_camera_is_detected(degrees: float, correspond: Look):
    assert not correspond(grey_pair(roll_camera(degrees), ""))


@pytest.mark.parametrize("scene", SCENES)
@pytest.mark.parametrize("rows", [-1, 0, 1])
def test_common_offset_is_measured(scene: str, rows: int):
    views = known_pair(scene, 320, 240, seed=3).views
    assert offset(grey_pair(shift_right_view(views, rows), "")) == pytest.approx(rows, abs=0.1)


def test_common_offset_within_the_matchers_limit_is_accepted_and_corrected_without_rectification():
    views = known_pair("planes", 320, 240).views
    assert not corners_correspond(grey_pair(shift_right_view(views, 1), ""))
    assert corners_correspond(grey_pair(shift_right_view(views, 1), ""), most_row_offset_px=1)
    assert not corners_correspond(grey_pair(shift_right_view(views, 3), ""), most_row_offset_px=1)
    with collected() as notes:
        found = Zncc().estimate(shift_right_view(views, 1)).disparity_px
    assert any(note.startswith("rows realigned by") for note in notes)
    assert not any(note.startswith("rectified") for note in notes)
    straight = Zncc().estimate(views).disparity_px
    assert np.mean(np.abs(found - straight)[2:-2] <= 1) >= 0.98


def share_right(found: np.ndarray) -> float:
    return float(np.mean(np.abs(found - SCENE.disparity_px())[SCENE.visible()] <= 2))


def test_raw_pair_is_matched_as_a_rectified_one_and_a_calibrated_one_not_tested():
    straight = Zncc().estimate(Views(SCENE.left(), SCENE.right())).disparity_px
    with collected() as notes:
        raw = Zncc().estimate(roll_camera(2)).disparity_px
    assert any(note.startswith("rectified: ") for note in notes)
    assert share_right(raw) >= share_right(straight) - 0.03
    never = Zncc(rectify="never").estimate(roll_camera(2)).disparity_px
    assert share_right(never) < 0.8
    views = roll_camera(2)
    calibrated = Views(views.left, views.right, Calibration(300.0, 0.1))
    with collected() as notes:
        found = Zncc(max_disparity_px=16).estimate(calibrated)
    assert not any("rows" in note or "rectified" in note for note in notes)
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


@pytest.mark.parametrize("rows_lower", [-24, 36])
def test_repeating_courses_do_not_pass_as_aligned(rows_lower: int):
    """The next course fits as well to a look along the rows; the wall as a whole lies elsewhere."""
    views, truth = walls(rows_lower)
    assert not rows_match_elsewhere(grey_pair(walls(0)[0], ""))
    assert rows_match_elsewhere(grey_pair(views, ""))
    error = (SemiGlobal().estimate(views).disparity_px - truth)[40:-40, 60:-40]
    assert np.mean(np.abs(error - np.nanmedian(error)) <= 2) >= 0.93


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


Y, X = np.indices((160, 240), float)


@pytest.mark.parametrize(
    ("agreed", "lost", "offset"), [(20, 20, 0.4), (19, 0, None), (45, 55, 0.4), (44, 56, None), (100, 0, 0.4)]
)
def test_offset_is_common_if_twenty_edges_and_45_of_100_have_one(agreed: int, lost: int, offset: float | None):
    votes = np.r_[np.full(agreed, 0.4), np.full(lost, np.nan)].astype(np.float32)
    assert common_rows._agreed_offset_px(votes, 0.45, 0.3) == (offset and pytest.approx(offset))
    for apart, common in ((0.29, True), (0.31, False)):
        varying = np.repeat([0.4 - apart, 0.4, 0.4 + apart], [33, 34, 33]).astype(np.float32)
        assert (common_rows._agreed_offset_px(varying, 0.45, 0.3) is not None) == common


@pytest.mark.parametrize("rows", [-1.0, 1.0])
@pytest.mark.parametrize("most_px", [0.0, 0.9, 1.1])
def test_corners_of_a_higher_or_lower_view_are_corrected_up_to_the_most(rows: float, most_px: float, monkeypatch):
    pair = Pair.of(*np.zeros((2, 160, 240), np.uint8))
    monkeypatch.setattr(common_rows, "_row_offsets", lambda *_: np.full(20, 1.4 * rows))
    assert corners_correspond(pair, most_px) == (most_px >= 0.9)


@pytest.mark.parametrize("reach", [1, 7])
def test_profiles_correlate_over_the_rows_that_both_have(reach: int):
    left, right = np.random.default_rng(0).normal(size=(2, 30))
    expected = []
    for shift in range(-reach, reach + 1):
        ours, theirs = left[max(-shift, 0) : 30 - max(shift, 0)], right[max(shift, 0) : 30 - max(-shift, 0)]
        expected.append(ours @ theirs / np.sqrt((ours @ ours) * (theirs @ theirs)))
    assert common_rows._correlations(left, right, reach) == pytest.approx(expected)


@pytest.mark.parametrize("factor", [1, 2, 4])
def test_edges_are_sought_at_disparities_of_a_smaller_picture(factor: int):
    """The surface is 20 px before the right view's place, which is 5 px of a picture of a quarter of the size."""
    pair = Pair.of(texture(X, Y), texture(X + 20, Y - 0.5))
    rows = np.arange(6, 160, 12)
    disparity = np.full((len(rows), 240 // factor), np.int16(16 * 20 // factor))
    votes = row_votes(pair, rows, disparity, factor)
    assert np.isfinite(votes).mean() > 0.6
    assert np.nanmedian(votes) == pytest.approx(0.5, abs=0.1)
    assert not len(row_votes(pair, rows, np.full_like(disparity, UNKNOWN), factor))


@pytest.mark.parametrize(("offset_px", "whole"), [(1.14, True), (-0.9, True), (0.14, True), (1.16, False)])
def test_offset_near_a_whole_number_moves_whole_rows(offset_px: float, whole: bool):
    right = np.random.default_rng(0).integers(0, 256, (30, 40), np.uint8)
    moved = shift_rows(Pair.of(right, right), offset_px).right
    expected = right[np.clip(np.arange(30) + round(offset_px), 0, 29)]
    assert np.array_equal(moved, expected) == whole
