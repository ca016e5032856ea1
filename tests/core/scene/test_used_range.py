"""If one of these fails, a dark picture of many bits, such as a thermal one, is felt flat without a warning."""

import numpy as np
import pytest

from tangible_core import DisparityMap, Pipeline, Scene
from tangible_core.scene.geometry import nearness_range

TONES = np.random.default_rng(0).random((20, 30))


class TestUsedRange:
    @pytest.mark.parametrize(
        ("dtype", "low", "high", "white"),
        [
            (np.uint16, 6800, 7800, 65535),
            (np.uint16, 0, 4095, 65535),
            (np.uint16, 0, 16383, 65535),
            (np.uint16, 7, 8, 65535),
            (np.float32, 20, 37, 255),
            (np.float64, 0.5, 0.51, 1),
            (np.int32, 300, 900, 65535),
        ],
    )
    def test_few_values_are_stretched_in_proportion_and_told(self, dtype, low: float, high: float, white: float):
        values = (low + (high - low) * TONES).astype(dtype)
        values.flat[:2] = low, high
        scene = Scene.photo(values)
        share = (values.astype(np.float64) - low) / (high - low)
        step = 0.5 if scene.views.left.dtype.kind == "u" else white * 1e-5
        np.testing.assert_allclose(scene.views.left, share * white, atol=step)
        [note] = scene.notes
        assert scene.warnings == (note,)
        assert "of its range" in note and note.endswith("it is stretched to all of it") and f"of {white}" in note

    @pytest.mark.parametrize(
        "values",
        [
            *(np.uint16(30000 * TONES), np.uint8(20 * TONES), TONES > 0.5, np.float32(TONES), np.float32(0.3 * TONES)),
            *(np.full((4, 5), 700, np.uint16), np.full((1, 1), 3, np.uint16), np.full((4, 5), 0.5)),
        ],
    )
    def test_pictures_that_use_their_range_or_have_one_shade_stay_the_same_to_the_bit(self, values: np.ndarray):
        scene = Scene.photo(values)
        np.testing.assert_array_equal(scene.views.left, values, strict=True)
        assert not scene.notes

    def test_two_views_are_stretched_alike(self):
        left, right = np.uint16(6800 + 1000 * TONES), np.uint16(7000 + 1000 * TONES)
        views = Scene.pair(left, right).views
        low, high = float(left.min()), float(right.max())
        for view, values in ((views.left, left), (views.right, right)):
            np.testing.assert_allclose(view, (values - low) / (high - low) * 65535, atol=0.5)
        wide = np.uint16(60000 * TONES)
        np.testing.assert_array_equal(Scene.pair(left, wide).views.left, left)

    def test_transparency_and_unknown_pixels_do_not_count(self):
        colours = np.uint16(6800 + 1000 * np.repeat(TONES[..., None], 4, 2))
        colours[..., 3] = 65535
        colours[0, 0] = 0
        scene = Scene.photo(colours)
        assert scene.views.left.min() == 0 and scene.views.left.max() == 65535
        assert scene.views.left[5, 5, 0] == pytest.approx((colours[5, 5, 0] - 6800) * 65.7, rel=0.02)
        hole = np.float32(20 + 17 * TONES)
        hole[0, 0] = np.nan
        assert Scene.photo(hole, non_finite="mask").views.left.max() == 255


class TestFlat:
    def test_map_with_one_pixel_that_differs_is_not_flat(self):
        """Nearly all of a photograph's wall is at one distance: percentiles alone would see nothing else."""
        values = np.full((40, 50), 5, np.float32)
        values[3, 4] = 9
        assert tuple(nearness_range(DisparityMap(values), None)) == (5, 9)

    @pytest.mark.parametrize("heights", [np.full((4, 5), 7.0), np.zeros((3, 3), np.uint8), np.ones((1, 1))])
    def test_flat_map_warns_with_its_relief(self, heights: np.ndarray):
        pipeline = Pipeline(Scene.heights(heights), cached=False)
        assert pipeline.relief.is_flat
        [note] = next(one.notes for one in pipeline.outcomes if one.product == "relief")
        assert note.kind == "warning" and "all heights are equal; check the file" in note.text
