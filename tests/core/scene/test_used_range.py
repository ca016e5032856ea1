"""Pictures of more than eight bits that use a part of their range, and reliefs in which nothing stands out."""

from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from command_line import tangible
from tangible_core import Pipeline, Scene
from tangible_core.data.pictures import used_range
from tangible_depth.luminance import Luminance
from tangible_depth.opencv_sgbm import OpenCVSGBM

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
            np.uint16(30000 * TONES),
            np.uint8(20 * TONES),
            TONES > 0.5,
            np.float32(TONES),
            np.float32(0.3 * TONES),
            np.full((4, 5), 700, np.uint16),
            np.full((1, 1), 3, np.uint16),
            np.full((4, 5), 0.5),
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

    def test_hot_pixels_are_left_out_by_clip(self):
        values = np.uint16(6800 + 1000 * TONES)
        values[3, 3] = 65535
        assert not Scene.photo(values).notes
        assert Scene.photo(values, clip=(0, 99)).views.left.std() > 15000  # uniform: 65535 / sqrt(12) is 18918

    def test_folder_of_frames_has_the_range_of_its_first(self, tmp_path: Path):
        for number, low in enumerate((6800, 6900)):
            Image.fromarray(np.uint16(low + 1000 * TONES)).save(tmp_path / f"{number}.png")
        scene = Scene.video(tmp_path)
        assert "of its range (68" in scene.notes[0] and scene.notes[1].endswith("plays it")
        first = scene.views.left[..., 0].astype(float)
        np.testing.assert_allclose(first, TONES * 255, atol=2)
        with scene.frames.open() as frames:
            frames.next()
            second = frames.next().views.left[..., 0].astype(float)
        np.testing.assert_allclose(second, np.minimum(TONES * 255 + 25.5, 255), atol=2)

    def test_relief_of_a_thermal_picture_stands_out(self):
        pipeline = Pipeline(
            Scene.photo(np.uint16(6800 + 1000 * np.kron(TONES, np.ones((8, 8))))),
            depth=Luminance(),
            relief="edges",
            cached=False,
        )
        assert pipeline.relief.height_m.max() > 0.001

    def test_no_picture_has_no_range(self):
        assert used_range() is None


class TestFlat:
    def test_run_of_a_flat_picture_says_so_with_the_cure_and_not_that_it_can_be_felt(self, tmp_path: Path):
        Image.new("RGB", (60, 40), "grey").save(tmp_path / "grey.png")
        (tmp_path / "p.yaml").write_text(
            "scene: {photo: grey.png}\nwant: touch\ndepth: {use: luminance}\n"
            "render: {use: proxy}\ndevice: {use: mock}\n"
        )
        for by in ("relief=edges", "relief=disparity"):
            done = tangible("run", "p.yaml", "--out", by, "--set", by, cwd=tmp_path)
            said = " ".join((done.stdout + done.stderr).split())
            assert done.returncode == 0 and "can now be felt" not in said
            assert "grey.png has come out flat, there is nothing to feel" in said
            assert "the relief is flat, nothing stands out: " in said

    @pytest.mark.parametrize("heights", [np.full((4, 5), 7.0), np.zeros((3, 3), np.uint8), np.ones((1, 1))])
    def test_flat_map_warns_with_its_relief(self, heights: np.ndarray):
        pipeline = Pipeline(Scene.heights(heights), cached=False)
        assert pipeline.relief.is_flat
        [note] = pipeline.outcomes[0].notes
        assert note.kind == "warning" and "all heights are equal; check the file" in note.text

    def test_relief_that_stands_out_has_no_warning(self):
        pipeline = Pipeline(Scene.heights(TONES), cached=False)
        assert not pipeline.relief.is_flat and not pipeline.outcomes[0].notes

    def test_relief_of_two_identical_views_warns(self):
        views = np.uint8(255 * TONES)
        pipeline = Pipeline(Scene.pair(views, views), depth=OpenCVSGBM(), cached=False)
        assert pipeline.relief.is_flat
        [relief] = [each for each in pipeline.outcomes if each.product == "relief"]
        assert "all of it is equally far; check the map of depth, or that left and right are two" in relief.why
