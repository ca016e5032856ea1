"""If one of these fails, numbers of a map or a dark picture lose their small differences, or holes are heights."""

import re

import numpy as np
import pytest
from ruamel.yaml import YAML

from tangible_core import DisparityMap, Pipeline, Scene, Workspace
from tangible_core.scene.geometry import nearness_range

SLOPE = np.linspace(100, 200, 600).reshape(20, 30)
SIZE = Workspace(width_m=0.05, relief_m=0.01)


def line_of(scene: Scene) -> str:
    """Return what a scene tells one to write."""
    [text] = scene.warnings
    [line] = re.findall("`(nodata: .+?)` under `scene:`", text)
    return line


def felt_mm(scene: Scene) -> np.ndarray:
    return Pipeline(scene, workspace=SIZE, cached=False).relief.height_m * 1e3


def fractal(seed: int, roughness: float) -> np.ndarray:
    """Return a terrain of 0 to 1 whose spectrum falls with this power."""
    rng, n = np.random.default_rng(seed), 96
    frequency = np.fft.fftfreq(n)[:, None] ** 2 + np.fft.fftfreq(n) ** 2
    frequency[0, 0] = 1
    waves = np.fft.ifft2(frequency ** (-roughness / 2) * np.exp(2j * np.pi * rng.random((n, n)))).real
    return (waves - waves.min()) / np.ptp(waves)


class TestUndeclaredNoData:
    @pytest.mark.parametrize("dtype", [np.float32, np.float64, np.dtype(">f4"), np.int32])
    @pytest.mark.parametrize(
        "mark", [-9999, -32768, -32767, -99999, 65535, -2147483648, 9999, -9999.9, 1e20, 3.4e38, -3.4028235e38, -1e30]
    )
    def test_number_far_from_all_others_is_named_and_works_when_it_is_copied(self, mark: float, dtype):
        if np.dtype(dtype).kind == "i" and (mark != int(mark) or abs(mark) > 2**31):
            return
        heights = SLOPE.astype(dtype)
        heights[:3, :4] = mark
        scene = Scene.heights(heights)
        assert scene.warnings == scene.notes and "2 % of the array" in scene.notes[0]
        assert np.isfinite(scene.height).all(), "a guess was made"
        again = Scene.heights(heights, **YAML(typ="safe").load(line_of(scene)))
        assert np.isnan(again.height).sum() == 12 and np.isnan(again.height[:3, :4]).all()
        assert not again.notes
        assert np.ptp(felt_mm(again)[5:]) > 6  # 500 of the 600 heights, of 10 mm
        assert np.ptp(felt_mm(scene)[5:]) < 1.5

    @pytest.mark.parametrize("dtype", [np.float32, np.int16, np.float64])
    @pytest.mark.parametrize("seed", range(8))
    def test_terrain_has_no_mark_and_one_with_voids_has(self, seed: int, dtype):
        rng, ground = np.random.default_rng(seed), fractal(seed, 1.5 + seed / 4)
        heights = rng.choice([-400, 0, 1500]) + 10 ** rng.uniform(1, 3.5) * ground
        y, x = np.mgrid[:96, :96]
        summit = heights + 20 * np.ptp(heights) * np.exp(-((x - 40) ** 2 + (y - 50) ** 2) / 18)
        spike, sea = heights.copy(), np.maximum(heights, np.median(heights))
        spike[50, 40] += 60 * np.ptp(heights)
        tower = heights.copy()
        tower[40:60, 40:60] = heights.max() + 3 * np.ptp(heights)
        terraces = np.round(heights / np.ptp(heights) * 6) * np.ptp(heights) / 6
        for terrain in (heights, summit, spike, sea, tower, terraces):
            assert not Scene.heights(np.clip(terrain, -32000, 32000).astype(dtype)).notes
        voids = heights.astype(dtype)
        voids[ground < 0.1] = -9999
        assert line_of(Scene.heights(voids)) == "nodata: -9999"

    def test_map_that_is_no_terrain_has_no_mark(self):
        labels = [np.arange(36).reshape(6, 6) % 5, np.eye(6) * 65535, np.where(np.eye(20) > 0, 255, np.arange(20))]
        flat = [np.zeros((4, 4)), np.full((4, 4), -9999), np.ones((1, 1)), np.array([[-5.0, 5.0]])]
        for heights in (*labels, *flat, np.full((3, 3), np.nan), np.linspace(-3, 3, 30).reshape(5, 6)):
            assert not Scene.heights(heights).notes


class TestOffsets:
    def test_offset_keeps_small_differences_and_what_is_unknown(self):
        """The radius of Mars in metres: 32 bits have steps of 256 m there."""
        relief_mm = felt_mm(Scene.heights(3396190000.0 + 30 * SLOPE))
        np.testing.assert_allclose(relief_mm, (SLOPE - 100) / 10, atol=1e-5)
        heights = -3396190000.0 + SLOPE
        heights[0, 0], heights[5, 5] = np.nan, -9999
        scene = Scene.heights(heights, nodata=-9999)
        assert np.argwhere(np.isnan(scene.height)).tolist() == [[0, 0], [5, 5]]
        np.testing.assert_allclose(scene.height + scene.offset, heights + 0 * scene.height, atol=1e-4)
        assert Scene.heights(heights, nodata=-9999, invert=True).offset == -scene.offset

    @pytest.mark.parametrize("dtype", [np.float64, np.float32, np.uint16, np.int16, np.uint8, np.int32])
    def test_small_numbers_are_the_same_to_the_bit(self, dtype):
        for heights in (SLOPE * 1.1, SLOPE - 150, SLOPE % 7):
            values = np.abs(heights).astype(dtype) if np.dtype(dtype).kind == "u" else heights.astype(dtype)
            scene = Scene.heights(values)
            assert scene.offset == 0
            np.testing.assert_array_equal(scene.height, values.astype(np.float32), strict=True)


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

    def test_views_are_stretched_alike_by_their_opaque_known_pixels(self):
        left, right = np.uint16(6800 + 1000 * TONES), np.uint16(7000 + 1000 * TONES)
        views = Scene.pair(left, right).views
        low, high = float(left.min()), float(right.max())
        for view, values in ((views.left, left), (views.right, right)):
            np.testing.assert_allclose(view, (values - low) / (high - low) * 65535, atol=0.5)
        wide = np.uint16(60000 * TONES)
        np.testing.assert_array_equal(Scene.pair(left, wide).views.left, left)
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
