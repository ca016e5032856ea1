"""If one of these fails, a map of depth beside a picture, or in a phone's photo, is felt with other depths."""

from base64 import b64encode
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from PIL import Image

from phone_photos import PHOTO, gdepth, jpeg
from tangible_core import Pipeline, Scene, Workspace
from tangible_core.data import Calibration
from tangible_core.errors import ConfigError
from tangible_core.scene.workspace import kind_of

GREY = np.full((3, 4), 90, np.uint8)
MILLIMETRES = np.array([[0, 500, 1000, 2000], [4000, 8000, 65535, 1], [800, 900, 1600, 3200]], np.uint16)
NAN = np.nan


def stored(folder: Path, values: np.ndarray) -> Path:
    Image.fromarray(values).save(folder / "map.png")
    return folder / "map.png"


class TestDisparity:
    @pytest.mark.parametrize("in_file", [True, False])
    def test_scale_and_zero_are_those_of_kitti(self, tmp_path: Path, in_file: bool):
        values = np.array([[0, 256, 128, 640], [1, 2560, 25600, 65535], [0, 0, 512, 768]], np.uint16)
        scene = Scene.photo(GREY, disparity=stored(tmp_path, values) if in_file else values, disparity_scale=256)
        expected = [[NAN, 1, 0.5, 2.5], [1 / 256, 10, 100, 65535 / 256], [NAN, NAN, 2, 3]]
        np.testing.assert_array_equal(scene.disparity.disparity_px, np.float32(expected))

    def test_scale_of_one_makes_zero_and_less_unknown(self):
        values = np.array([[0.0, -1, 2.5, np.inf]] * 3)
        known = Scene.photo(GREY, disparity=values, disparity_scale=1).disparity.disparity_px
        np.testing.assert_array_equal(known[0], np.float32([NAN, NAN, 2.5, NAN]))
        plain = Scene.photo(GREY, disparity=values).disparity.disparity_px
        np.testing.assert_array_equal(plain[0], np.float32([0, -1, 2.5, NAN]))

    def test_other_number_for_no_data_is_that_of_the_file(self, tmp_path: Path):
        values = np.array([[0, 256, 65535, 512]] * 3, np.uint16)
        for nodata, row in ((65535, [NAN, 1, NAN, 2]), ([65535, 256], [NAN, NAN, NAN, 2])):
            scene = Scene.photo(GREY, disparity=stored(tmp_path, values), disparity_scale=256, nodata=nodata)
            np.testing.assert_array_equal(scene.disparity.disparity_px[0], np.float32(row))


class TestDepth:
    @pytest.mark.parametrize("in_file", [True, False])
    def test_millimetres_are_nearer_where_they_are_fewer(self, tmp_path: Path, in_file: bool):
        scene = Scene.photo(GREY, depth=stored(tmp_path, MILLIMETRES) if in_file else MILLIMETRES, nodata=65535)
        depth_m = np.where(np.isin(MILLIMETRES, (0, 65535)), NAN, MILLIMETRES / 1000)
        np.testing.assert_allclose(scene.disparity.disparity_px, 1 / depth_m, rtol=1e-6)
        assert kind_of(scene) == "depth"

    def test_relief_to_scale_is_linear_in_the_depth(self):
        depth_mm = np.tile(np.linspace(500, 1500, 101), (40, 1))
        scene = Scene.photo(np.zeros((40, 101), np.uint8), depth=depth_mm)
        workspace = Workspace(relief_m=0.01, smooth_m=0)
        relief = {"by": "depth", "slope": 0, "grain_m": 0}
        heights = Pipeline(scene, workspace=workspace, relief=relief, cached=False).relief.height_m[20]
        np.testing.assert_allclose(heights[5:-5], (1500 - depth_mm[0, 5:-5]) / 1e5, atol=1e-4)

    def test_cameras_and_unit_give_the_disparity_of_a_pair(self):
        """Z = f B / (d + offset): 1000 px, 0.1 m, and 3 px of offset."""
        depth_m = np.array([[1.0, 2, 4, 5]] * 3)
        camera = Calibration(1000, 0.1, 3)
        scene = Scene.pair(GREY, GREY, depth=depth_m, depth_unit_m=1, calibration=camera)
        np.testing.assert_allclose(scene.disparity.disparity_px[0], [97, 47, 22, 17], rtol=1e-6)

    def test_near_and_far_bound_the_depth(self):
        scene = Scene.photo(GREY, depth=MILLIMETRES, near_m=0.6, far_m=2)
        near = 1 / scene.disparity.disparity_px
        np.testing.assert_allclose(near[0], [NAN, 0.6, 1, 2], rtol=1e-6)
        np.testing.assert_allclose(near[1], [2, 2, 2, 0.6], rtol=1e-6)
        for bound, column, distance_m in (({"near_m": 0.6}, 1, 0.6), ({"far_m": 1.5}, 3, 1.5)):
            alone = Scene.photo(GREY, depth=MILLIMETRES, **bound).disparity.disparity_px
            assert alone[0, column] == pytest.approx(1 / distance_m)

    @pytest.mark.parametrize(
        ("options", "sentence"),
        [
            ({"depth": MILLIMETRES, "disparity": MILLIMETRES}, "depth and disparity are two forms of one map"),
            ({"depth": MILLIMETRES, "near_m": 2, "far_m": 1}, "near_m is less than far_m"),
            ({"depth": MILLIMETRES, "far_m": np.inf}, "far_m: Input should be a finite number"),
            ({"near_m": 2}, "near_m needs depth"),
            ({"depth_unit_m": 2}, "depth_unit_m needs depth"),
            ({"disparity_scale": 2}, "disparity_scale needs disparity"),
            ({"nodata": 2}, "nodata needs height or depth or disparity"),
        ],
    )
    def test_options_that_do_not_fit_are_refused(self, options: dict[str, Any], sentence: str):
        with pytest.raises(ConfigError, match=sentence):
            Scene.photo(GREY, **options)


class TestPhones:
    RAMP = np.tile(np.linspace(0, 255, 16).astype(np.uint8), (12, 1))

    def photo(self, folder: Path, turn: int, depth_turn: int) -> Scene:
        """Return a photo of 24 x 32 with a depth map, near at the sensor's left; each with its EXIF orientation."""
        exif, own = Image.Exif(), Image.Exif()
        exif[0x0112], own[0x0112] = turn, depth_turn
        data, head = gdepth(jpeg(self.RAMP, exif=own)), jpeg(PHOTO, exif=exif)
        (folder / "portrait.jpg").write_bytes(head[:2] + data[2 : data.index(b"\xff\xe0")] + head[2:])
        return Scene.photo(folder / "portrait.jpg")

    @pytest.mark.parametrize("depth_turn", [1, 6])
    def test_depth_is_turned_once_whether_it_states_an_orientation_or_not(self, tmp_path: Path, depth_turn: int):
        near = self.photo(tmp_path, 6, depth_turn).disparity.disparity_px
        assert near.shape == (32, 24)
        assert near[0].min() > 0.9 and near[-1].max() < 0.1  # the sensor's left edge is the upper one

    def test_depths_that_are_stored_linearly_become_nearness(self, tmp_path: Path):
        """From 1 to 9 m; half of the way, 5 m, is (1/5 - 1/9) / (1 - 1/9) = 1/10 near, and not 1/2."""
        text = b'<x GDepth:Format="RangeLinear" GDepth:Near="1" GDepth:Far="9" GDepth:Data="'
        photo = jpeg(PHOTO, text + b64encode(jpeg(np.full((12, 16), 127, np.uint8))) + b'"/>')
        (tmp_path / "portrait.jpg").write_bytes(photo)
        near = Scene.photo(tmp_path / "portrait.jpg").disparity.disparity_px
        np.testing.assert_allclose(near, 0.1, atol=0.005)
