"""Slopes in units of their noise, and the edges in them."""

import numpy as np
import pytest

from tangible_texture.regions.landscape import Landscape, canny_edges, landscape
from tangible_texture.signal.slopes import slopes


@pytest.mark.parametrize("share", [0.1, 0.5, 3.0])
def test_slopes_are_divided_by_noise_bounded_by_twice_that_of_less_smoothing(share: float):
    picture = np.random.default_rng(0).random((20, 31, 1), np.float32)
    magnitude, across, down, own = slopes(picture)
    found = landscape(picture, 1e9, own[:4, :5] * np.float32(share))
    noise = np.minimum(own, 2 * share * own[0, 0])
    for one, other in zip(found, (magnitude, across, down), strict=True):
        np.testing.assert_allclose(one, other / noise, rtol=1e-4)


def test_no_slope_is_above_the_most():
    picture = np.zeros((12, 40, 1), np.float32)
    picture[:, 20:] = 1
    found = landscape(picture, 25.0, np.zeros((3, 3), np.float32))
    assert found.steep.max() == pytest.approx(25)
    assert np.abs(found.across).max() == pytest.approx(25)


@pytest.mark.parametrize("turned", [False, True])
def test_edges_lie_within_a_pixel_of_the_crest_above_the_upper_threshold(turned: bool):
    """A crest that is high in its upper half, and between both thresholds below it; beside it a lower one."""
    across = np.zeros((30, 40), np.float32)
    across[:, 10], across[:15, 9:12:2], across[:15, 10] = 6, 8, 12
    across[:, 30], across[:, 29], across[:, 31] = 9, 5, 5
    flat = np.zeros_like(across)
    land = Landscape(across.T, flat.T, across.T) if turned else Landscape(across, across, flat)
    found = canny_edges(land, 5.0, 10.0, 20.0)
    expected = np.zeros((30, 40), np.uint8)
    expected[:, 9:12] = 255
    found = found.T if turned else found
    assert np.array_equal(found[2:-2], expected[2:-2])
