import numpy as np
import pytest

from stereo_scenes import texture
from tangible_depth.sparse.matches import inverse_lengths
from tangible_depth.sparse.sparse_ncc import match_rows
from two_cameras import Scene


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


def test_search_without_points_is_empty():
    grey = np.zeros((5, 5), np.float32)
    assert search(grey, grey, np.empty((0, 2), np.int64), 0, 3)[0].size == 0


@pytest.mark.parametrize("shift", [-4.3, -2.0, 0.25, 3.3, 5.7])
def test_fraction_of_a_disparity_has_its_sign(shift):
    """Of a wave that both views show; its peak is found to a tenth of a pixel."""
    rows, columns = np.indices((11, 60))
    left, right = (np.sin((columns + by) / 3 + rows / 5).astype(np.float32) for by in (0, shift))
    disparity, _ = search(left, right, np.array([[30, 5], [25, 4]]), -8, 8)
    assert disparity == pytest.approx([shift, shift], abs=0.1)


def test_match_whose_right_window_finds_the_next_pixel_is_kept():
    """Between two whole disparities either may be the best, so that a few windows lead back to the next pixel."""
    rows, columns = np.indices((40, 160), float)
    left, right = (texture(columns + by, rows) / np.float32(255) for by in (0, 2.5))
    disparity, _ = search(left, right, every((40, 160), 1, 12), 0, 8)
    assert np.isfinite(disparity).all()
    assert disparity == pytest.approx(np.full(disparity.shape, 2.5), abs=0.3)
