"""Framing of a picture: crop, rotation, inversion, clipping, no data, transparency."""

import json
from pathlib import Path

import numpy as np
import pytest
from PIL import Image

from tangible_core import Pipeline, Scene, Workspace
from tangible_core.errors import ConfigError, PictureError
from tangible_core.scene.scene_source import source_of_arguments
from tangible_depth.luminance import Luminance
from tangible_texture.gradient import Gradient

HEIGHTS = np.arange(12.0).reshape(3, 4)
PHOTO = np.arange(36, dtype=np.uint8).reshape(3, 4, 3)


class TestHeights:
    def of(self, heights=HEIGHTS, **options) -> np.ndarray:
        framed = Scene.heights(heights, **options).height
        assert framed is not None
        return framed

    def test_crop_counts_from_the_upper_left_corner(self):
        assert self.of(crop=[1, 0, 3, 2]).tolist() == [[1, 2, 3], [5, 6, 7]]

    def test_rotate_turns_clockwise_after_cropping(self):
        assert self.of(rotate=90).tolist() == [[8, 4, 0], [9, 5, 1], [10, 6, 2], [11, 7, 3]]
        assert self.of(rotate=270).tolist() == [[3, 7, 11], [2, 6, 10], [1, 5, 9], [0, 4, 8]]
        assert self.of(crop=[1, 0, 2, 1], rotate=180).tolist() == [[2, 1]]

    def test_invert_exchanges_high_and_low(self):
        relief = Pipeline(Scene.heights(HEIGHTS, invert=True), cached=False).relief.height_m
        assert (relief[0, 0], relief[2, 3]) == (np.float32(0.02), 0)

    @pytest.mark.parametrize("nodata", [-9999, [-9999, 1e20], -9999.0])
    def test_nodata_values_become_unknown(self, nodata):
        torn = HEIGHTS.copy()
        torn[1, 1] = -9999
        framed = self.of(torn, nodata=nodata)
        assert np.isnan(framed).tolist() == (torn == -9999).tolist()
        assert np.nanmin(framed) == 0

    def test_nodata_values_are_compared_in_32_bits(self):
        lowest = float(np.finfo(np.float32).min)
        assert np.isnan(self.of(np.array([[lowest, 0.1, 1]]), nodata=[-3.4028235e38, 0.1])).tolist() == [[1, 1, 0]]

    def test_clip_cuts_spikes(self):
        spiked = np.linspace(0, 1, 1000).reshape(20, 50)
        spiked[3, 3] = 1e6
        framed = self.of(spiked, clip=[1, 99])
        assert framed.max() == pytest.approx(0.99, abs=0.005)
        assert framed.min() == pytest.approx(0.01, abs=0.005)

    def test_transparent_heights_are_unknown(self):
        grey = np.repeat(HEIGHTS.astype(np.uint8)[..., None], 4, axis=2)
        grey[..., 3] = 255
        grey[0, 3, 3] = 0
        assert np.argwhere(np.isnan(self.of(grey))).tolist() == [[0, 3]]

    @pytest.mark.parametrize("rotate", [0, 90, 180, 270])
    def test_stated_size_is_that_of_the_part_as_it_lies(self, tmp_path: Path, rotate: int):
        """A map of 40 x 90 mm; of its 4 columns and 3 rows, 2 and 1 are cut out: 20 x 30 mm."""
        state = {"format": "tangible heights 1", "file": "h.png", "columns": 4, "rows": 3}
        size = {"width_mm": 40, "length_mm": 90, "high_mm": 11, "low_mm": 0, "step_mm": 1}
        (tmp_path / "h.json").write_text(json.dumps({**state, **size}))
        Image.fromarray(HEIGHTS.astype(np.uint16)).save(tmp_path / "h.png")
        for crop, sides in ((None, (0.04, 0.09)), ([1, 2, 2, 1], (0.02, 0.03))):
            scene = Scene.heights(tmp_path / "h.png", crop=crop, rotate=rotate)
            width_m, length_m = sides if rotate in (0, 180) else sides[::-1]
            assert scene.own_size == pytest.approx((width_m, length_m, 0.011))
        assert Scene.heights(tmp_path / "h.png", invert=True).measured is None


class TestPhotos:
    def of(self, photo=PHOTO, **options) -> np.ndarray:
        views = Scene.photo(photo, **options).views
        assert views is not None
        return views.left

    def test_photo_is_cropped_and_rotated(self):
        np.testing.assert_array_equal(self.of(crop=[1, 1, 2, 2], rotate=90), np.rot90(PHOTO[1:3, 1:3], -1))

    def test_labels_and_disparity_are_cropped_and_rotated_with_the_photo(self):
        labels = np.uint8([[0, 0, 0, 0], [0, 0, 7, 9], [0, 0, 7, 9]])
        scene = Scene.photo(PHOTO, segments=labels, disparity=HEIGHTS, crop=[2, 1, 2, 2], rotate=90)
        assert scene.segments is not None and scene.disparity is not None
        assert scene.segments.labels.tolist() == [[1, 1], [2, 2]]
        assert scene.disparity.disparity_px.tolist() == [[10, 6], [11, 7]]

    @pytest.mark.parametrize(
        ("photo", "inverted"),
        [
            (np.uint8([[0, 200]]), [[255, 55]]),
            (np.uint16([[0, 65535]]), [[65535, 0]]),
            (np.float32([[0.25, 1]]), [[0.75, 0]]),
            (np.array([[True, False]]), [[False, True]]),
        ],
    )
    def test_invert_exchanges_light_and_dark(self, photo, inverted):
        framed = self.of(photo, invert=True)
        assert framed.tolist() == inverted
        assert framed.dtype == photo.dtype

    def test_clip_limits_brightness_to_percentiles(self):
        photo = np.linspace(50, 150, 1000).astype(np.uint8).reshape(20, 50)
        photo[0, 0], photo[5, 5] = 0, 255
        framed = self.of(photo, clip=[5, 95])
        assert (framed.min(), framed.max()) == (54, 145)

    def test_clip_ignores_transparent_pixels(self):
        photo = np.full((10, 10, 4), 100, np.uint8)
        photo[0, 1:4, :3] = 110
        photo[..., 3] = 255
        photo[:9, :, 3] = 0
        photo[:9, :, :3][photo[:9, :, :3] == 100] = 0
        assert self.of(photo, clip=[1, 99]).min() == 100


class TestTransparency:
    """A disc cut out of a picture: half of it light, half dark, on transparent white."""

    @pytest.fixture
    def cut_out(self) -> np.ndarray:
        y, x = np.mgrid[-1:1:64j, -1:1:64j]
        picture = np.full((64, 64, 4), 255, np.uint8)
        picture[..., :3] = np.where(x < 0, 40, 160)[..., None]
        picture[x * x + y * y > 0.5] = (255, 255, 255, 0)
        return picture

    def test_transparent_area_becomes_flat_ground_of_plain_material(self, cut_out: np.ndarray):
        hidden = cut_out[..., 3] == 0
        pipeline = Pipeline(
            Scene.photo(cut_out), depth=Luminance(), texture=Gradient(smallest_px=20), cached=False,
            workspace=Workspace(width_m=0.05, relief_m=0.02, smooth_m=0),
        )  # fmt: skip
        surface = pipeline.surface
        assert np.all(surface.height_m[hidden] == 0)
        assert surface.height_m[~hidden].max() == pytest.approx(0.02)
        assert surface.labels is not None and surface.materials is not None
        ground = len(surface.materials) - 1
        assert np.array_equal(surface.labels == ground, hidden)
        assert surface.materials[ground].name == "plain"
        assert len(surface.materials) == 3
        assert "transparent in the picture" in pipeline.materials.reasons[ground]
        assert np.isnan(pipeline.disparity.disparity_px[hidden]).all()
        [why] = [each.why for each in pipeline.outcomes if each.product == "views"]
        assert why.endswith(f"{100 * hidden.mean():.0f} % of the array given as photo is transparent: flat ground")

    def test_ground_takes_the_material_named_for_it(self, cut_out: np.ndarray):
        parts = {"depth": Luminance(), "texture": Gradient(smallest_px=20), "cached": False}
        surface = Pipeline(Scene.photo(cut_out), **parts, materials={2: "ice"}).surface
        assert [each.name for each in surface.materials] == ["plain", "plain", "ice"]

    def test_cache_key_depends_on_the_outline(self):
        """Two photos: in one a corner pixel is transparent and its neighbour not finite, in the other the reverse."""
        photos = [np.full((8, 8, 4), 0.5), np.full((8, 8, 4), 0.5)]
        for photo, (clear, torn) in zip(photos, [(0, 1), (1, 0)], strict=True):
            photo[4:, :, :3] = 0.2
            photo[0, clear, 3], photo[0, torn, 0] = 0, np.nan
        pipelines = [
            Pipeline(Scene.photo(each, non_finite="mask"), texture=Gradient(), cached=False) for each in photos
        ]
        assert pipelines[0].scene.views.digest() == pipelines[1].scene.views.digest()
        assert pipelines[0].engine.key("segments") != pipelines[1].engine.key("segments")

    def test_opaque_picture_loses_its_fourth_channel_only(self):
        rgba = np.dstack([PHOTO, np.full(PHOTO.shape[:2], 128, np.uint8)])
        scene = Scene.photo(rgba)
        np.testing.assert_array_equal(scene.views.left, PHOTO)
        assert scene.shown is None and scene.known is None

    def test_transparent_picture_is_refused(self):
        with pytest.raises(PictureError, match="all of the picture is transparent; there is nothing to feel"):
            Scene.photo(np.zeros((3, 3, 4), np.uint8))


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"crop": [2, 0, 3, 3]}, r"crop \[2, 0, 3, 3\] reaches beyond the picture, which is 4 x 3"),
        ({"crop": [0, 1, 1, 3]}, r"crop \[0, 1, 1, 3\] reaches beyond"),
    ],
)
def test_crop_beyond_the_picture_is_refused(parts, message):
    with pytest.raises(PictureError, match=message):
        Scene.heights(HEIGHTS, **parts)


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"photo": PHOTO, "crop": [0, 0, 0, 3]}, "scene.crop.2: Input should be greater than or equal to 1"),
        ({"photo": PHOTO, "crop": [0, 0, 3]}, "scene.crop.3: Field required"),
        ({"photo": PHOTO, "rotate": 45}, "scene.rotate: Input should be 0, 90, 180 or 270"),
        ({"photo": PHOTO, "clip": [99, 1]}, r"^scene: clip is \[low, high\] with low < high"),
        ({"photo": PHOTO, "clip": [-1, 50]}, "scene.clip.0: Input should be greater than or equal to 0"),
        ({"photo": PHOTO, "clip": [1, 101]}, "scene.clip.1: Input should be less than or equal to 100"),
        ({"photo": PHOTO, "clip": [7, 7]}, r"^scene: clip is \[low, high\] with low < high"),
        ({"photo": PHOTO, "nodata": 0}, "nodata needs height"),
        ({"photo": PHOTO, "layout": "top-bottom"}, "layout needs stereo"),
        ({"left": PHOTO, "right": PHOTO, "rotate": 90, "invert": True}, "rotate and invert is for a photo or a height"),
        ({"stereo": PHOTO, "photo": PHOTO}, "stereo already gives both views; leave out photo"),
    ],
)
def test_wrong_options_are_refused(parts, message):
    with pytest.raises(ConfigError, match=message):
        source_of_arguments(parts)


def test_masked_heights_are_unknown():
    scene = Scene.heights(np.ma.masked_equal(HEIGHTS, HEIGHTS[0, 1]))
    assert scene.height is not None
    np.testing.assert_array_equal(np.isnan(scene.height), HEIGHTS[0, 1] == HEIGHTS)


def test_pipeline_file_takes_the_same_options(tmp_path: Path):
    np.save(tmp_path / "dem.npy", HEIGHTS)
    text = "scene: {height: dem.npy, crop: [1, 0, 3, 2], rotate: 180, invert: true, nodata: [6], clip: [0, 90]}\n"
    (tmp_path / "p.yaml").write_text(text)
    pipeline = Pipeline.from_yaml(tmp_path / "p.yaml")
    pipeline.to_yaml(tmp_path / "again.yaml")
    for each in (pipeline, Pipeline.from_yaml(tmp_path / "again.yaml")):
        np.testing.assert_allclose(each.scene.height, [[-6.2, np.nan, -5], [-3, -2, -1]], rtol=1e-6)
    (tmp_path / "p.yaml").write_text("scene:\n  height: dem.npy\n  rotate: 45\n  crop: [0, 0, -1, 2]\nwant: relief\n")
    with pytest.raises(ConfigError) as error:
        Pipeline.from_yaml(tmp_path / "p.yaml")
    first, second = str(error.value).splitlines()
    assert "p.yaml:4:" in first and "scene.crop.2" in first
    assert "p.yaml:3:3: scene.rotate: Input should be 0, 90, 180 or 270, not 45" in second


def test_crop_applies_to_the_upright_picture(tmp_path: Path):
    exif = Image.Exif()
    exif[0x0112] = 6
    Image.fromarray(PHOTO).save(tmp_path / "p.png", exif=exif)
    framed = Scene.photo(tmp_path / "p.png", crop=[0, 0, 3, 1]).views
    np.testing.assert_array_equal(framed.left, np.rot90(PHOTO, -1)[:1])
