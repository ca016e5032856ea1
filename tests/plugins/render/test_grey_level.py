"""The force law `grey-level` would give a wrong force: steps known exactly."""

import numpy as np
import pytest

from planes import UP_M, at, tilted
from tangible_core.data import NO_FORCE, HapticSurface
from tangible_render.grey_level import GreyLevel


class TestGreyLevel:
    def test_force_is_the_grey_of_the_cell_under_the_tip(self):
        heights = np.array([[0, 51, 102], [153, 204, 255]]) / 255 * 0.01
        touch = GreyLevel(force_at_white_n=5.0).touch(HapticSurface.from_heights(heights, 0.03))
        for row, y in enumerate((0.009, -0.001)):
            for column, x in enumerate((-0.0149, -0.0049, 0.0051)):
                assert at(touch, x, y, -1e-4) == pytest.approx((0, 0, 5.0 * (3 * row + column) / 5))

    def test_force_steps_at_the_surface_and_ignores_depth(self):
        touch = GreyLevel(force_at_white_n=3.0).touch(tilted(0, 0))
        assert at(touch, 0, 0, UP_M) == NO_FORCE
        assert at(touch, 0, 0, np.nextafter(UP_M, 0)) == (0, 0, 3.0)
        assert at(touch, 0, 0, -1.0) == (0, 0, 3.0)

    def test_heights_have_256_steps(self):
        ramp = np.linspace(0, 0.01, 4001)[None, :]
        path = np.column_stack([np.linspace(-0.0399, 0.0399, 4001), np.zeros(4001), np.full(4001, -0.001)])
        felt = GreyLevel(force_at_white_n=255.0).touch(HapticSurface.from_heights(ramp)).path(path)[:, 2]
        assert np.array_equal(np.unique(felt), np.arange(256))

    @pytest.mark.parametrize("highest", [1e-45, 1e-30, 3e38])
    def test_any_range_of_heights_spans_all_greys(self, highest: float):
        surface = HapticSurface.from_heights(np.array([[0, highest]]))
        assert at(GreyLevel(force_at_white_n=2.0).touch(surface), 0.01, 0, -0.01) == (0, 0, 2.0)
