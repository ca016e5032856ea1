import cv2
import numpy as np
import pytest

from tangible_depth.sparse.harris import corners, gaussian_window, harris_response, least_response, row_edges


def test_gaussian_window_sums_to_one_and_has_its_sigma():
    window = gaussian_window(2.0)
    offsets = np.arange(len(window)) - len(window) // 2
    assert window.sum() == pytest.approx(1)
    assert window @ offsets**2 == pytest.approx(4, rel=0.05)
    assert window[len(window) // 2 + 2] / window.max() == pytest.approx(np.exp(-0.5))


def test_gaussian_window_without_a_width_is_refused():
    with pytest.raises(ValueError, match="sigma_px > 0"):
        gaussian_window(0)


def test_ramp_is_an_edge_of_known_response():
    ramp = np.tile(0.03 * np.arange(40.0), (30, 1))
    response = harris_response(ramp, k=0.05)
    assert response[10:20, 10:30] == pytest.approx(-0.05 * (2 * 0.03) ** 4)
    assert least_response(0.03, k=0.05) == pytest.approx(0.05 * (2 * 0.03) ** 4)


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


def test_square_has_four_corners_and_two_upright_edges():
    square = np.zeros((40, 40))
    square[10:30, 12:28] = 1
    response = harris_response(square)
    found = corners(response, 0.01 * response.max(), most=100)
    assert len(found) >= 4
    truth = np.array([(12, 10), (27, 10), (12, 29), (27, 29)])
    assert np.abs(found[:, None] - truth).max(axis=2).min(axis=1).max() <= 1
    assert np.abs(found[:, None] - truth).max(axis=2).min(axis=0).max() <= 1
    upright = row_edges(response, 0.01 * -response.min())
    middle = upright[(upright[:, 1] > 15) & (upright[:, 1] < 25)]
    assert np.abs(middle[:, :1] - [12, 27]).min(axis=1).max() <= 1


def test_corners_are_sorted_by_strength_and_limited_in_number():
    response = harris_response(np.random.default_rng(1).random((50, 50)))
    found = corners(response, 0.0, most=7)
    values = response[found[:, 1], found[:, 0]]
    assert len(found) == 7
    assert (np.diff(values) <= 0).all()
    assert values[0] == response.max()


@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (9, 1), (20, 20)])
def test_flat_picture_has_no_features(shape):
    response = harris_response(np.full(shape, 0.3, np.float32))
    assert response.shape == shape
    assert len(corners(response, least_response(0.001), 10)) == 0
    assert len(row_edges(response, least_response(0.001))) == 0


def test_corner_is_over_the_least_and_an_edge_of_equal_columns_is_their_last():
    """Left of a valley of two equal columns an equal one is allowed, right of it none."""
    response = np.array([[0, 3, 0, 0, 5, 0, 0, 4, 0]], np.float32)
    assert corners(response, 3.0, 9).tolist() == [[4, 0], [7, 0]]
    valley = np.array([[0, -4, -4, 0, -2, -5, -4, -4, -4]], np.float32)
    assert row_edges(valley, 3.0).tolist() == [[2, 0], [5, 0], [8, 0]]
