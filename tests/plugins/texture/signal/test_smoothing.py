"""Smoothing before slopes removes specks and keeps structure."""

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_texture.signal.smoothing import WIDER, gaussian, remove_specks, smooth_at_two_scales


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

    @pytest.mark.parametrize(("shape", "step"), [((512, 512), 2), ((511, 301), 2), ((30, 40), 1), ((1, 1), 1)])
    def test_two_scales_have_their_shapes_and_deviations(self, shape: tuple[int, int], step: int):
        noise = np.random.default_rng(0).normal(0, 1, (*shape, 2)).astype(np.float32)
        near, wide, found = smooth_at_two_scales(noise, 2.0)
        assert found == step
        assert near.shape == noise.shape
        assert wide.shape == (-(-shape[0] // step), -(-shape[1] // step), 2)
        if min(shape) > 300:  # what a Gaussian leaves of white noise
            assert near.std() == pytest.approx(1 / (np.sqrt(4 * np.pi) * 2), rel=0.05)
            assert wide.std() == pytest.approx(1 / (np.sqrt(4 * np.pi) * 2 * WIDER), rel=0.05)

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
