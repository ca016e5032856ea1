"""If one of these fails, another part of a picture is felt than was cut out, or its unknown places are felt."""

from pathlib import Path

import numpy as np
import pytest

from tangible_core import Pipeline, Scene, Workspace
from tangible_core.errors import ConfigError, PictureError
from tangible_core.scene.scene_source import make_source
from tangible_depth.luminance import Luminance
from tangible_texture.gradient import Gradient

HEIGHTS = np.arange(12.0).reshape(3, 4)
PHOTO = np.arange(36, dtype=np.uint8).reshape(3, 4, 3)


class TestHeights:
    def of(self, heights=HEIGHTS, **options) -> np.ndarray:
        framed = Scene.heights(heights, **options).height
        assert framed is not None
        return framed

    def test_crop_counts_from_the_upper_left_corner_and_rotate_turns_clockwise_after(self):
        assert self.of(crop=[1, 0, 3, 2]).tolist() == [[1, 2, 3], [5, 6, 7]]
        assert self.of(rotate=90).tolist() == [[8, 4, 0], [9, 5, 1], [10, 6, 2], [11, 7, 3]]
        assert self.of(rotate=270).tolist() == [[3, 7, 11], [2, 6, 10], [1, 5, 9], [0, 4, 8]]
        assert self.of(crop=[1, 0, 2, 1], rotate=180).tolist() == [[2, 1]]

    @pytest.mark.parametrize("nodata", [-9999, [-9999, 1e20], -9999.0])
    def test_nodata_values_become_unknown(self, nodata):
        torn = HEIGHTS.copy()
        torn[1, 1] = -9999
        framed = self.of(torn, nodata=nodata)
        assert np.isnan(framed).tolist() == (torn == -9999).tolist()
        assert np.nanmin(framed) == 0

    def test_heights_are_clipped_and_unknown_where_transparent(self):
        spiked = np.linspace(0, 1, 1000).reshape(20, 50)
        spiked[3, 3] = 1e6
        framed = self.of(spiked, clip=[1, 99])
        assert framed.max() == pytest.approx(0.99, abs=0.005)
        assert framed.min() == pytest.approx(0.01, abs=0.005)
        grey = np.repeat(HEIGHTS.astype(np.uint8)[..., None], 4, axis=2)
        grey[..., 3] = 255
        grey[0, 3, 3] = 0
        assert np.argwhere(np.isnan(self.of(grey))).tolist() == [[0, 3]]


class TestPhotos:
    def of(self, photo=PHOTO, **options) -> np.ndarray:
        views = Scene.photo(photo, **options).views
        assert views is not None
        return views.left

    def test_photo_is_inverted_and_clipped_with_labels_and_disparity(self):
        labels = np.uint8([[0, 0, 0, 0], [0, 0, 7, 9], [0, 0, 7, 9]])
        scene = Scene.photo(PHOTO, segments=labels, disparity=HEIGHTS, crop=[2, 1, 2, 2], rotate=90)
        assert scene.segments is not None and scene.disparity is not None
        assert scene.segments.labels.tolist() == [[1, 1], [2, 2]]
        assert scene.disparity.disparity_px.tolist() == [[10, 6], [11, 7]]
        for dark, light, white in ((np.uint8(200), np.uint8(55), 255), (np.float32(0.25), np.float32(0.75), 1)):
            photo = np.array([[0, dark, white]], dark.dtype)
            np.testing.assert_array_equal(
                self.of(photo, invert=True), np.array([[white, light, 0]], dark.dtype), strict=True
            )
        assert self.of(np.uint16([[0, 65535]]), invert=True).tolist() == [[65535, 0]]
        assert self.of(np.array([[True, False]]), invert=True).tolist() == [[False, True]]
        photo = np.linspace(50, 150, 1000).astype(np.uint8).reshape(20, 50)
        photo[0, 0], photo[5, 5] = 0, 255
        framed = self.of(photo, clip=[5, 95])
        assert (framed.min(), framed.max()) == (54, 145)


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
        assert (surface.materials[ground].name, len(surface.materials)) == ("plain", 3)
        assert "transparent in the picture" in pipeline.materials.reasons[ground]
        assert np.isnan(pipeline.disparity.disparity_px[hidden]).all()
        [why] = [outcome.why for outcome in pipeline.outcomes if outcome.product == "views"]
        assert why.endswith(f"{100 * hidden.mean():.0f} % of the array given as photo is transparent: flat ground")

    def test_outline_is_in_the_cache_key_and_an_empty_one_refused(self):
        photos = [np.full((8, 8, 4), 0.5), np.full((8, 8, 4), 0.5)]
        for photo, (clear, torn) in zip(photos, [(0, 1), (1, 0)], strict=True):
            photo[4:, :, :3] = 0.2
            photo[0, clear, 3], photo[0, torn, 0] = 0, np.nan
        pipelines = [
            Pipeline(Scene.photo(each, non_finite="mask"), texture=Gradient(), cached=False) for each in photos
        ]
        assert pipelines[0].scene.views.digest() == pipelines[1].scene.views.digest()
        assert pipelines[0].engine.key("segments") != pipelines[1].engine.key("segments")
        with pytest.raises(PictureError, match="all of the picture is transparent; there is nothing to feel"):
            Scene.photo(np.zeros((3, 3, 4), np.uint8))


@pytest.mark.parametrize("crop", [[2, 0, 3, 3], [0, 1, 1, 3]])
def test_crop_beyond_the_picture_is_refused(crop):
    with pytest.raises(PictureError, match="reaches beyond"):
        Scene.heights(HEIGHTS, crop=crop)


@pytest.mark.parametrize(
    ("parts", "message"),
    [
        ({"photo": PHOTO, "crop": [0, 0, 0, 3]}, "scene.crop.2"),
        ({"photo": PHOTO, "crop": [0, 0, 3]}, "scene.crop.3"),
        ({"photo": PHOTO, "rotate": 45}, "scene.rotate"),
        *(({"photo": PHOTO, "clip": clip}, "clip") for clip in ([99, 1], [7, 7], [-1, 50], [1, 101])),
        ({"photo": PHOTO, "nodata": 0}, "nodata needs height"),
        ({"photo": PHOTO, "layout": "top-bottom"}, "layout needs stereo"),
        ({"left": PHOTO, "right": PHOTO, "rotate": 90, "invert": True}, "rotate and invert is for a photo or a height"),
        ({"stereo": PHOTO, "photo": PHOTO}, "stereo already gives both views; leave out photo"),
    ],
)
def test_wrong_options_are_refused(parts, message):
    with pytest.raises(ConfigError, match=message):
        make_source(parts)


def test_pipeline_file_takes_the_same_options(tmp_path: Path):
    np.save(tmp_path / "dem.npy", HEIGHTS)
    text = "scene: {height: dem.npy, crop: [1, 0, 3, 2], rotate: 180, invert: true, nodata: [6], clip: [0, 90]}\n"
    (tmp_path / "p.yaml").write_text(text)
    pipeline = Pipeline.from_yaml(tmp_path / "p.yaml")
    pipeline.to_yaml(tmp_path / "again.yaml")
    for each in (pipeline, Pipeline.from_yaml(tmp_path / "again.yaml")):
        np.testing.assert_allclose(each.scene.height, [[-6.2, np.nan, -5], [-3, -2, -1]], rtol=1e-6)
