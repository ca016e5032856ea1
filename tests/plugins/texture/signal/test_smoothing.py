"""Smoothing and slopes against plain formulas: else noise is taken for edges."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_texture.signal.smoothing import WIDER, gaussian, remove_specks, slopes, smooth_at_two_scales


class TestSmoothing:
    @given(st.integers(2, 6), st.integers(2, 6), st.data())
    def test_single_pixel_vanishes(self, rows: int, columns: int, data: st.DataObject):
        picture = np.full((rows, columns, 1), 0.5, np.float32)
        row, column = data.draw(st.integers(0, rows - 1)), data.draw(st.integers(0, columns - 1))
        picture[row, column] = data.draw(st.sampled_from([0.0, 0.499, 0.501, 1.0]))
        assert np.all(remove_specks(picture) == 0.5)

    @pytest.mark.parametrize("thing", [np.eye(9), np.tri(9), np.indices((9, 9))[1] == 4, np.indices((9, 9))[0]])
    def test_lines_corners_steps_and_slopes_stay(self, thing: np.ndarray):
        values = np.asarray(thing, np.float32)[..., None]
        assert np.array_equal(remove_specks(values), values)

    @pytest.mark.parametrize(("value", "calm"), [(5, 5), (5.01, 3), (-1, -1), (-1.01, 1), (2, 2)])
    def test_speck_is_further_off_than_its_neighbours_are_apart(self, value: float, calm: float):
        values = np.float32([[1, 2, 3], [2, value, 2], [3, 2, 1]])[..., None]
        assert remove_specks(values)[1, 1, 0] == np.float32(calm)

    def test_gaussian_mirrors_at_the_border_and_does_not_wrap(self):
        values = np.zeros((1, 40, 1), np.float32)
        values[0, 0] = 1
        found = gaussian(values, 2.0)[0, :, 0]
        assert found[:3].sum() > 0.6
        assert np.all(found[20:] == 0)
        assert found.sum() == pytest.approx(1, abs=1e-5)

    @pytest.mark.parametrize(("shape", "near_px"), [((4, 400), 2.5), ((400, 4), 2.5), ((300, 301), 9.0)])
    def test_two_scales_are_gaussians_of_a_16th_of_the_root_of_the_area_at_most(
        self, shape: tuple[int, int], near_px: float
    ):
        noise = np.random.default_rng(0).normal(0, 1, (*shape, 1)).astype(np.float32)
        near, wide, step = smooth_at_two_scales(noise, 9.0)
        assert np.array_equal(near, gaussian(noise, near_px))
        wide_px = min(WIDER * 9.0, (shape[0] * shape[1]) ** 0.5 / 16)
        assert step == max(1, int(wide_px / 1.5))
        if step > 1:
            framed = np.pad(near[..., 0], [(0, -side % step) for side in shape], mode="edge")
            cells = framed.reshape(len(framed) // step, step, -1, step).mean(axis=(1, 3))[..., None]
            rest = wide_px**2 - near_px**2 - (step**2 - 1) / 12
            cells = gaussian(cells.astype(np.float32), rest**0.5 / step) if rest > 0 else cells
            np.testing.assert_allclose(wide, cells, atol=1e-5)


class TestSlopes:
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
