"""Slopes of a picture and the noise in it."""

import numpy as np
import pytest

from tangible_texture.signal.slopes import slopes
from tangible_texture.signal.smoothing import gaussian


class TestSlopes:
    def test_plane_has_its_slope_everywhere_inside(self):
        rows, columns = np.indices((20, 30), np.float32)
        magnitude, across, down, _ = slopes((0.003 * columns - 0.004 * rows)[..., None])
        assert np.allclose(across[:, 1:-1], 0.003, atol=1e-6)
        assert np.allclose(down[1:-1], -0.004, atol=1e-6)
        assert np.allclose(magnitude[1:-1, 1:-1], 0.005, atol=1e-6)

    def test_slope_is_that_of_the_steepest_channel(self):
        columns = np.indices((5, 9), np.float32)[1]
        magnitude, across, _, _ = slopes(np.dstack([0.1 * columns, -0.3 * columns, 0.2 * columns]))
        assert np.allclose(magnitude[:, 1:-1], 0.3)
        assert np.allclose(across[:, 1:-1], -0.3)

    @pytest.mark.parametrize("shape", [(7, 9, 1), (5, 4, 3), (1, 6, 3), (6, 1, 3), (1, 1, 1), (2, 2, 2)])
    def test_slopes_are_central_differences_of_the_first_steepest_channel(self, shape: tuple[int, int, int]):
        """Whole numbers, so that several channels are as steep; the border is repeated."""
        picture = np.random.default_rng(1).integers(0, 3, shape).astype(np.float32)
        framed = np.pad(picture, ((1, 1), (1, 1), (0, 0)), mode="edge")
        across, down = (framed[1:-1, 2:] - framed[1:-1, :-2]) / 2, (framed[2:, 1:-1] - framed[:-2, 1:-1]) / 2
        magnitude = np.hypot(across, down)
        best = magnitude.argmax(axis=2)[..., None]
        expected = [np.take_along_axis(each, best, axis=2)[..., 0] for each in (magnitude, across, down)]
        for one, other in zip(slopes(picture)[:3], expected, strict=True):
            np.testing.assert_allclose(one, other, rtol=1e-6)

    @pytest.mark.parametrize("shape", [(7, 160, 2), (160, 7, 2), (90, 40, 3)])
    def test_noise_of_one_tile_is_a_quantile_of_all_its_slopes(self, shape: tuple[int, int, int]):
        """Of the noisiest channel, over the quantile of a Rayleigh distribution."""
        picture = np.random.default_rng(2).normal(0, [1.0, 4.0, 2.0][: shape[2]], shape).astype(np.float32)
        levels = []
        for channel in range(shape[2]):
            magnitude = np.sort(slopes(picture[..., channel : channel + 1])[0].ravel())
            levels.append(magnitude[magnitude.size // 4] / np.sqrt(-2 * np.log(0.75)))
        np.testing.assert_allclose(slopes(picture)[3], max(levels), rtol=1e-5)

    @pytest.mark.parametrize("channel_count", [1, 3])
    def test_noise_of_white_noise_matches_theory(self, channel_count: int):
        sigma_px = 2.0
        noise = np.random.default_rng(0).normal(0, 1, (512, 512, channel_count)).astype(np.float32)
        found = slopes(gaussian(noise, sigma_px))[3]
        expected = 1 / (np.sqrt(8 * np.pi) * sigma_px**2)  # of a derivative of a Gaussian, under white noise
        assert found.mean() == pytest.approx(expected, rel=0.1)

    def test_noise_is_measured_locally(self):
        noise = np.random.default_rng(0).normal(0, 1, (256, 512, 1)).astype(np.float32)
        noise[:, 256:] *= 10
        found = slopes(gaussian(noise, 2.0))[3]
        assert found[:, -1].mean() == pytest.approx(10 * found[:, 0].mean(), rel=0.1)
