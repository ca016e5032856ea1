"""Features and their matches on scenes that are known: else raw pairs are rectified by wrong matches."""

import cv2
import numpy as np
import pytest

from tangible_depth.sparse.corner_range import range_of_shifts
from tangible_depth.sparse.harris import corners, gaussian_window, harris_response, row_edges
from tangible_depth.sparse.matches import (
    corner_matches,
    flow_matches,
    inverse_lengths,
    match_off_plane,
    normalised_windows,
    parabola,
    sift_matches,
    stretch8,
)
from tangible_depth.sparse.sparse_ncc import match_rows
from two_cameras import Scene

MAKERS = [
    sift_matches,
    flow_matches,
    lambda left, right: corner_matches(left, right, *(corners(harris_response(g), 1e-9, 500) for g in (left, right))),
]


@pytest.mark.parametrize("make", MAKERS, ids=["sift", "flow", "corners"])
class TestMatchers:
    def test_most_matches_are_right_to_a_tenth_of_a_pixel(self, make):
        scene = Scene(wall_px=6.4, box_px=13.7)
        left, right = make(scene.left(), scene.right())
        assert len(left) >= 20
        column, row = np.rint(left).astype(int).T
        error = np.hypot(left[:, 0] - right[:, 0] - scene.disparity_px()[row, column], left[:, 1] - right[:, 1])
        assert np.median(error) < 0.15


def test_large_pictures_are_matched_reduced_and_refined_in_full(monkeypatch):
    monkeypatch.setattr("tangible_depth.sparse.matches.MAX_PIXELS", 20_000)
    scene = Scene((240, 320), 6.4, 13.7)
    matches = sift_matches(scene.left(), scene.right())
    column, row = np.rint(matches.left_px).astype(int).T
    error = matches.left_px[:, 0] - matches.right_px[:, 0] - scene.disparity_px()[row, column]
    assert np.median(np.abs(error)) < 0.2


@pytest.mark.parametrize("peak", [-0.5, -0.2, 0.0, 0.4])
def test_parabola_gives_its_peak(peak):
    before, at, after = (3 - 2 * (np.array([x]) - peak) ** 2 for x in (-1, 0, 1))
    assert parabola(before, at, after) == pytest.approx([peak])


def test_normalised_windows_ignore_gain_and_offset_and_are_zero_if_flat():
    grey = np.random.default_rng(0).random((20, 20)).astype(np.float32)
    points = np.array([[0, 0], [10, 7], [19, 19]])
    windows = normalised_windows(grey, points, 2)
    assert np.linalg.norm(windows, axis=1) == pytest.approx(1, abs=1e-6)
    assert normalised_windows(0.3 * grey + 0.2, points, 2) == pytest.approx(windows, abs=1e-5)
    assert not normalised_windows(np.full((20, 20), 0.7, np.float32), points, 2).any()


def test_inverse_lengths_are_those_of_the_windows():
    grey = np.random.default_rng(0).random((9, 11)).astype(np.float32)
    padded = np.pad(grey, 2, mode="edge").astype(np.float64)
    window = padded[3:8, 4:9]
    assert inverse_lengths(grey, 2)[3, 4] == pytest.approx(1 / np.linalg.norm(window - window.mean()), rel=1e-6)
    assert inverse_lengths(np.full((9, 11), 0.7, np.float32), 2).max() == 0


def test_dim_picture_is_stretched_and_flat_one_is_not():
    assert stretch8(np.array([[0.1, 0.2, 0.15]], np.float32)).tolist() == [[0, 255, 128]]
    assert stretch8(np.array([[0.3, 0.3]], np.float32)).tolist() == [[0, 0]]


def test_saddle_is_a_corner_of_known_response():
    y, x = np.mgrid[-20:21, -20:21].astype(float)
    window = gaussian_window(1.5)
    second = window @ (np.arange(len(window)) - len(window) // 2) ** 2  # of x y: A = B = 4 <y^2>, C = 4 <x y> = 0
    response = harris_response(x * y, window, k=0.04)
    assert response[20, 20] == pytest.approx((4 * second) ** 2 - 0.04 * (8 * second) ** 2)


@pytest.mark.parametrize("dtype", [np.float32, np.float64])
def test_harris_response_equals_opencvs(dtype):
    grey = np.random.default_rng(0).random((33, 47)).astype(dtype)
    ours = harris_response(grey, np.full(5, 0.2), k=0.06)
    assert ours.dtype == dtype
    assert ours == pytest.approx(cv2.cornerHarris(grey.astype(np.float32), 5, 1, 0.06), abs=1e-5)


def test_corner_is_over_the_least_and_an_edge_of_equal_columns_is_their_last():
    """Left of a valley of two equal columns an equal one is allowed, right of it none."""
    response = np.array([[0, 3, 0, 0, 5, 0, 0, 4, 0]], np.float32)
    assert corners(response, 3.0, 9).tolist() == [[4, 0], [7, 0]]
    valley = np.array([[0, -4, -4, 0, -2, -5, -4, -4, -4]], np.float32)
    assert row_edges(valley, 3.0).tolist() == [[2, 0], [5, 0], [8, 0]]


def shifts(values, vertical=0.0):
    return np.column_stack([values, np.full(len(values), vertical)])


def test_range_of_shifts_has_a_margin_and_zero():
    assert range_of_shifts(shifts(np.linspace(20, 60, 101)), 500) == (0, 64)
    assert range_of_shifts(shifts(np.linspace(-30, 70, 101)), 500) == (-39, 79)


def test_stray_matches_do_not_widen_the_range():
    values = np.r_[np.linspace(20, 60, 500), [-300, 400]]
    assert range_of_shifts(shifts(values), 500) == (0, 64)
    off_row = np.vstack([shifts(np.linspace(20, 60, 100)), shifts(np.full(30, 400.0), vertical=9)])
    assert range_of_shifts(off_row, 500) == (0, 64)


def test_range_of_few_matches_is_a_quarter_of_the_width():
    assert range_of_shifts(np.empty((0, 2)), 200) == (0, 50)


@pytest.mark.parametrize(("count", "range_px"), [(19, (0, 50)), (20, (0, 44))])
def test_twenty_matches_within_two_rows_make_a_range(count, range_px):
    assert range_of_shifts(shifts(np.full(count, 40.0), vertical=2.0), 200) == range_px
    assert range_of_shifts(shifts(np.full(count, 40.0), vertical=-2.0), 200) == range_px
    assert range_of_shifts(shifts(np.full(count, 40.0), vertical=2.1), 200) == (0, 50)


WALL_PX = np.array([[1, 0, 6], [0, 1, 0], [0, 0, 1.0]])
"""Lays the wall of a scene upon itself."""


def test_small_object_before_a_wall_is_matched_in_place():
    scene = Scene((240, 320), 6.0, 20.0, box=(0.06, 0.08))
    found = match_off_plane(scene.left(), scene.right(), WALL_PX)
    parallax = found.left_px - found.right_px
    right = np.abs(parallax - [14, 0]).max(axis=1) < 0.5
    assert np.count_nonzero(right) >= 10
    column, row = found.left_px[right].astype(int).T
    assert scene.in_box()[row, column].mean() > 0.9


@pytest.mark.parametrize("exposure", [1.0, 0.6])
def test_wall_has_no_off_plane_matches(exposure):
    scene = Scene((240, 320), 6.0, box=(0, 0))
    assert not len(match_off_plane(scene.left(), exposure * scene.right(), WALL_PX).left_px)


def search(left, right, points, low, high, half=4):
    padded = [np.pad(grey, half, mode="edge") for grey in (left, right)]
    inverse = [inverse_lengths(grey, half) for grey in (left, right)]
    disparity, score = np.empty(len(points), np.float32), np.empty(len(points), np.float32)
    match_rows(*padded, *inverse, points, low, high, half, disparity, score)
    return disparity, score


def every(shape, step, margin):
    rows, columns = np.mgrid[margin : shape[0] - margin : step, margin : shape[1] - margin : step]
    return np.column_stack([columns.ravel(), rows.ravel()])


@pytest.mark.parametrize(("wall", "box"), [(6.0, 14.0), (6.3, 13.6), (-9.0, 4.5)])
def test_known_scene_gives_its_disparities(wall, box):
    scene = Scene(wall_px=wall, box_px=box)
    points = every(scene.shape, 5, 20)
    disparity, score = search(scene.left(), scene.right(), points, -15, 20)
    error = np.abs(disparity - scene.disparity_px()[points[:, 1], points[:, 0]])
    found = np.isfinite(disparity)
    assert found.mean() > 0.7
    assert np.median(error[found]) < 0.1
    assert np.mean(error[found] < 1) > 0.93
    assert ((score >= 0) & (score <= 1 + 1e-5)).all()


def test_score_is_the_correlation_for_any_exposure():
    random = np.random.default_rng(0)
    left = random.random((11, 40)).astype(np.float32)
    right = np.roll(left, -3, axis=1) * 0.5 + 0.1
    disparity, score = search(left, right, np.array([[20, 5]]), 0, 10)
    assert score == pytest.approx([1], abs=1e-5)
    assert disparity == pytest.approx([3], abs=0.1)
    noisy = right + 0.1 * random.random(right.shape).astype(np.float32)
    a, b = left[1:10, 16:25].ravel(), noisy[1:10, 13:22].ravel()
    assert search(left, noisy, np.array([[20, 5]]), 3, 3)[1] == pytest.approx([np.corrcoef(a, b)[0, 1]], abs=1e-5)


def test_flat_windows_and_ranges_beyond_the_picture_are_unknown():
    flat = np.full((20, 20), 0.4, np.float32)
    disparity, score = search(flat, flat, np.array([[10, 10], [0, 0]]), 0, 5)
    assert np.isnan(disparity).all()
    assert not score.any()
    random = np.random.default_rng(0).random((20, 20)).astype(np.float32)
    assert np.isnan(search(random, random, np.array([[3, 3]]), 10, 15)[0]).all()


@pytest.mark.parametrize("shift", [-4.3, -2.0, 0.25, 3.3, 5.7])
def test_fraction_of_a_disparity_has_its_sign(shift):
    rows, columns = np.indices((11, 60))
    left, right = (np.sin((columns + by) / 3 + rows / 5).astype(np.float32) for by in (0, shift))
    disparity, _ = search(left, right, np.array([[30, 5], [25, 4]]), -8, 8)
    assert disparity == pytest.approx([shift, shift], abs=0.1)
