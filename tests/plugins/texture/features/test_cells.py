"""Planes of features, averaged in windows and standardised."""

import numpy as np
import pytest

from tangible_texture.features.cells import standardise_roots, window_means


@pytest.mark.parametrize("shape", [(1, 1), (1, 9), (7, 5), (40, 33)])
@pytest.mark.parametrize("sigma_cells", [0.75, 4.0])
def test_means_in_place_match_means_elsewhere(shape: tuple[int, int], sigma_cells: float):
    planes = np.random.default_rng(3).random((5, *shape), np.float32)
    elsewhere = window_means(planes.copy(), sigma_cells)
    assert window_means(planes, sigma_cells, out=planes) is planes
    assert np.array_equal(planes, elsewhere)


def test_means_of_several_cells_are_means_of_their_means():
    planes = np.random.default_rng(4).random((3, 12, 18), np.float32)
    small = window_means(planes, 2.0, 2)
    np.testing.assert_allclose(small, window_means(planes, 2.0).reshape(3, 6, 2, 9, 2).mean(axis=(2, 4)), rtol=1e-5)


def test_roots_are_standardised_and_a_constant_plane_is_zero():
    planes = np.stack([np.random.default_rng(5).random(1000, np.float32), np.full(1000, 3, np.float32)])
    roots = np.sqrt(planes[0] + 1e-6)
    standardise_roots(planes)
    np.testing.assert_allclose(planes[0], (roots - roots.mean()) / roots.std(), atol=1e-4)
    assert (planes[1] == 0).all()


@pytest.mark.parametrize(("apart", "zero"), [(3e-7, True), (1e-5, False)])
def test_plane_that_differs_by_rounding_is_zero(apart: float, zero: bool):
    planes = np.float32([[1, 1 + apart] * 500])
    assert np.ptp(planes) > 0
    standardise_roots(planes)
    assert (planes == 0).all() == zero
