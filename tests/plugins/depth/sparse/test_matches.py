import numpy as np
import pytest

from tangible_core.data import digest_of
from tangible_depth.sparse import matches
from tangible_depth.sparse.harris import corners, harris_response
from tangible_depth.sparse.matches import (
    Matches,
    corner_matches,
    flow_matches,
    inverse_lengths,
    normalised_windows,
    parabola,
    sift_matches,
    stretch8,
)
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

    @pytest.mark.parametrize("shape", [(1, 1), (1, 50), (50, 1), (10, 10), (64, 64)])
    def test_flat_picture_has_no_matches(self, make, shape):
        flat = np.full(shape, 0.5, np.float32)
        assert len(make(flat, flat).left_px) == 0


def test_large_pictures_are_matched_reduced_and_refined_in_full(monkeypatch):
    monkeypatch.setattr("tangible_depth.sparse.matches.MOST_PIXELS", 20_000)
    scene = Scene((240, 320), 6.4, 13.7)
    matches = sift_matches(scene.left(), scene.right())
    column, row = np.rint(matches.left_px).astype(int).T
    error = matches.left_px[:, 0] - matches.right_px[:, 0] - scene.disparity_px()[row, column]
    assert np.median(np.abs(error)) < 0.2


def test_row_offset_is_positive_downwards():
    assert Matches(np.array([[1.0, 2]]), np.array([[5.0, 6]])).row_offset_px == [4]


@pytest.mark.parametrize("peak", [-0.5, -0.2, 0.0, 0.4])
def test_parabola_gives_its_peak(peak):
    before, at, after = (3 - 2 * (np.array([x]) - peak) ** 2 for x in (-1, 0, 1))
    assert parabola(before, at, after) == pytest.approx([peak])


def test_valley_or_line_has_no_peak():
    assert parabola(np.array([2.0, 1.0]), np.array([1.0, 2.0]), np.array([2.0, 3.0])) == pytest.approx([0, 0])


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


def test_score_is_independent_of_the_order_of_its_sum():
    random = np.random.default_rng(0)
    grey = random.random((60, 80), np.float32)
    points = np.column_stack([random.integers(0, 80, 300), random.integers(0, 60, 300)])
    windows = normalised_windows(grey, points, 5)
    score = matches.correlations(windows, windows)
    for _ in range(5):
        order = random.permutation(windows.shape[1])
        assert digest_of(matches.correlations(windows[:, order], windows[:, order])) == digest_of(score)
    np.testing.assert_allclose(score, np.einsum("nk,mk->nm", windows, windows), atol=1e-6)
