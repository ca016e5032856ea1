"""Features, their matches, and dense maps of these: else `report` smears disparities over edges."""

import cv2
import numpy as np
import pytest

from tangible_depth.sparse.assembling import assemble, erase_speckles, fill_nearest
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
def test_most_matches_are_right_to_a_tenth_of_a_pixel(make):
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


def test_normalised_windows_ignore_gain_and_offset_and_are_zero_if_flat_and_their_inverse_lengths_known():
    grey = np.random.default_rng(0).random((20, 20)).astype(np.float32)
    points = np.array([[0, 0], [10, 7], [19, 19]])
    windows = normalised_windows(grey, points, 2)
    assert np.linalg.norm(windows, axis=1) == pytest.approx(1, abs=1e-6)
    assert normalised_windows(0.3 * grey + 0.2, points, 2) == pytest.approx(windows, abs=1e-5)
    flat = np.full((20, 20), 0.7, np.float32)
    assert not normalised_windows(flat, points, 2).any()
    window = np.pad(grey, 2, mode="edge").astype(np.float64)[3:8, 4:9]
    assert inverse_lengths(grey, 2)[3, 4] == pytest.approx(1 / np.linalg.norm(window - window.mean()), rel=1e-6)
    assert inverse_lengths(flat, 2).max() == 0


def test_dim_pictures_are_stretched_and_saddles_are_corners():
    assert stretch8(np.array([[0.1, 0.2, 0.15]], np.float32)).tolist() == [[0, 255, 128]]
    assert stretch8(np.array([[0.3, 0.3]], np.float32)).tolist() == [[0, 0]]
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


def test_corners_and_shifts_have_their_least_and_margin():
    """Left of a valley of two equal columns an equal one is allowed, right of it none."""
    response = np.array([[0, 3, 0, 0, 5, 0, 0, 4, 0]], np.float32)
    assert corners(response, 3.0, 9).tolist() == [[4, 0], [7, 0]]
    valley = np.array([[0, -4, -4, 0, -2, -5, -4, -4, -4]], np.float32)
    assert row_edges(valley, 3.0).tolist() == [[2, 0], [5, 0], [8, 0]]
    assert range_of_shifts(shifts(np.linspace(20, 60, 101)), 500) == (0, 64)
    assert range_of_shifts(shifts(np.linspace(-30, 70, 101)), 500) == (-39, 79)
    values = np.r_[np.linspace(20, 60, 500), [-300, 400]]
    assert range_of_shifts(shifts(values), 500) == (0, 64)
    off_row = np.vstack([shifts(np.linspace(20, 60, 100)), shifts(np.full(30, 400.0), vertical=9)])
    assert range_of_shifts(off_row, 500) == (0, 64)


def shifts(values, vertical=0.0):
    return np.column_stack([values, np.full(len(values), vertical)])


@pytest.mark.parametrize(("count", "range_px"), [(19, (0, 50)), (20, (0, 44))])
def test_twenty_matches_within_two_rows_make_a_range_and_fewer_a_quarter_of_the_width(count, range_px):
    assert range_of_shifts(np.empty((0, 2)), 200) == (0, 50)
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


def test_scores_are_correlations_and_unknown_where_flat_or_beyond():
    random = np.random.default_rng(0)
    left = random.random((11, 40)).astype(np.float32)
    right = np.roll(left, -3, axis=1) * 0.5 + 0.1
    disparity, score = search(left, right, np.array([[20, 5]]), 0, 10)
    assert score == pytest.approx([1], abs=1e-5)
    assert disparity == pytest.approx([3], abs=0.1)
    noisy = right + 0.1 * random.random(right.shape).astype(np.float32)
    a, b = left[1:10, 16:25].ravel(), noisy[1:10, 13:22].ravel()
    assert search(left, noisy, np.array([[20, 5]]), 3, 3)[1] == pytest.approx([np.corrcoef(a, b)[0, 1]], abs=1e-5)
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


SHAPE = (30, 40)


def scatter(values, every=4):
    found = np.full(SHAPE, np.nan, np.float32)
    found[::every, ::every] = values[::every, ::every]
    return found, np.where(np.isfinite(found), 0.9, 0).astype(np.float32)


@pytest.mark.parametrize(("off_px", "agrees"), [(-2.1, False), (-1.9, True), (1.9, True), (2.1, False)])
def test_match_over_two_pixels_off_is_stray(off_px, agrees):
    """A match of hardly any weight, so that the mean is that of the others; one that counts keeps its score."""
    found, score = scatter(np.full(SHAPE, 7.0))
    found[16, 20], score[16, 20] = 7 + off_px, 1e-4
    confidence = assemble(found, score, np.zeros(SHAPE, np.uint8)).confidence
    assert (confidence[16, 20] == np.float32(1e-4)) == agrees


def test_matches_are_weighted_by_their_scores():
    """Both sums do, of disparities and of weights: of each match by itself the confidence says how much it counts."""

    def one(column, disparity, score):
        found = np.full(SHAPE, np.nan, np.float32), np.zeros(SHAPE, np.float32)
        found[0][15, column], found[1][15, column] = disparity, score
        return found

    blank, elsewhere = np.zeros(SHAPE, np.uint8), np.abs(np.arange(40) - 20) < 8
    (near, good), (far, poor) = one(8, 5.0, 0.9), one(32, 6.0, 0.3)
    counts, less = (assemble(*each, blank).confidence for each in ((near, good), (far, poor)))
    np.testing.assert_allclose(
        assemble(near, good / 2, blank).confidence[:, elsewhere], counts[:, elsewhere] / 2, rtol=1e-5
    )
    both = assemble(np.fmax(near, far), good + poor, blank)
    expected = (5 * counts + 6 * less) / (counts + less)
    np.testing.assert_allclose(both.disparity_px[:, elsewhere], expected[:, elsewhere], atol=0.01)
    np.testing.assert_allclose(both.confidence[:, elsewhere], (counts + less)[:, elsewhere], rtol=1e-4)
    assert np.ptp(expected[15, elsewhere]) > 0.05


@pytest.mark.parametrize(("grey", "least", "most"), [(1, 0.6, 0.95), (20, 0.005, 0.3), (200, 0.0, 1e-12)])
def test_colour_change_counts_as_distance(grey, least, most):
    """A change of 8 % of white counts as the reach: the remaining share of a match's weight behind it."""
    found, score = np.full(SHAPE, np.nan, np.float32), np.zeros(SHAPE, np.float32)
    found[15, 10], score[15, 10] = 5, 0.9
    edged = np.where(np.arange(40) < 20, 0, grey).astype(np.uint8) * np.ones((30, 1), np.uint8)
    behind, plain = (assemble(found, score, each).confidence[15, 30] for each in (edged, 0 * edged))
    assert least <= behind / plain <= most


def test_gaps_take_the_nearest_value_that_is_known_or_reached():
    """Behind an edge from black to white sums of weights are rounding, and their ratio is no disparity."""
    picture = np.where(np.arange(40) < 20, 0, 255).astype(np.uint8) * np.ones((30, 1), np.uint8)
    found, score = np.full(SHAPE, np.nan, np.float32), np.zeros(SHAPE, np.float32)
    found[15, [2, 18]], score[15, [2, 18]] = (5, 6), 0.9
    filled = assemble(found, score, picture)
    beside = filled.disparity_px[:, 17:18]
    assert np.ptp(filled.disparity_px[15, :20]) > 0.01
    np.testing.assert_allclose(filled.disparity_px[:, 20:], np.broadcast_to(beside, (30, 20)), atol=0.02)
    assert filled.confidence[:, 20:].max() < 1e-12
    values = np.array([[np.nan, 1, np.nan, np.nan, 5]], np.float32)
    assert fill_nearest(values).tolist() == [[1, 1, 1, 5, 5]]
    assert fill_nearest(np.ones((2, 2), np.float32)).tolist() == [[1, 1], [1, 1]]
    disparity = np.full(SHAPE, np.nan, np.float32)
    disparity[5:10, 5:10] = disparity[20:25, 20:25] = 3
    disparity[25, 20] = 3.5
    left = erase_speckles(disparity, 25)
    assert (np.isfinite(left).sum(), np.isfinite(left[20:26, 20:25]).sum()) == (26, 26)
