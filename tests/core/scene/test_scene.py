"""If one of these fails, a scene has other pictures, sizes or numbers than its files, or a wrong one is taken."""

import socket
from pathlib import Path

import numpy as np
import pytest

from pictures import write_png
from standard_sets import put
from tangible_core.data import DisparityMap, Relief, SegmentMap
from tangible_core.errors import ConfigError, OptionError, PictureError
from tangible_core.scene.scene import Scene
from tangible_core.scene.scene_files import BUILTINS, SceneFiles

NAN = np.nan
SIZE = {"width_m": 0.08, "relief_m": 0.02}
PICTURE = np.random.default_rng(0).integers(0, 256, (4, 6, 3), dtype=np.uint8)


@pytest.fixture
def folder(tmp_path):
    for name in ("left", "right", "photo"):
        write_png(tmp_path / f"{name}.png", PICTURE)
    write_png(tmp_path / "wide.png", np.zeros((4, 7), np.uint8))
    for name, shape in (("map", (4, 6)), ("wide", (4, 7))):
        np.save(tmp_path / f"{name}.npy", np.arange(np.prod(shape), dtype=np.float32).reshape(shape))
    return tmp_path


def complaint(**files):
    with pytest.raises(OptionError) as caught:
        SceneFiles(**files)
    (sentence,) = caught.value.args
    return sentence


@pytest.mark.parametrize("names", ["", "left", "right", "left photo", "left right height", "photo height", "disparity"])
def test_scene_is_exactly_one_of_pair_photo_and_height(names):
    missing = {"left": "; right is missing", "right": "; left is missing"}.get(names, "")
    says = f"gives {', '.join(names.split()) or 'nothing'}{missing}"
    assert complaint(**dict.fromkeys(names.split(), "a")).endswith(says)


@pytest.mark.parametrize(
    ("files", "message"),
    [
        ({"photo": "a", "focal_px": 3}, "focal_px needs baseline_m"),
        ({"photo": "a", "baseline_m": 3}, "baseline_m needs focal_px"),
        ({"photo": "a", "offset_px": 3}, "offset_px needs focal_px"),
        ({"photo": "a", "relief_m": 3}, "relief_m needs height"),
        ({"height": "a", "truth": "b"}, "height already gives all heights; leave out truth"),
        ({"height": "a", "disparity": "b"}, "leave out disparity"),
        ({"photo": "a", "focal_px": 0, "baseline_m": 1}, "greater than 0"),
        ({"photo": "a", "phot": "b"}, "unknown option (did you mean 'photo'?)"),
        ({"photo": 3}, "should be the path of a file"),
    ],
)
def test_incompatible_files_are_refused(files, message):
    assert message in complaint(**files)


@pytest.mark.parametrize("name", BUILTINS)
def test_builtin_scenes_need_no_network(name, monkeypatch):
    def refuse(*args, **options):
        raise AssertionError("the network was used")

    monkeypatch.setattr(socket.socket, "connect", refuse)
    scene = Scene.read(name, Path())
    assert scene.views.left.size > 10_000


@pytest.mark.parametrize(
    ("name", "hint"), [("builtin/motorcicle", "did you mean"), ("a.png", "{photo: FILE}"), ("", "")]
)
def test_unknown_scene_name_lists_the_builtin_scenes(name, hint):
    with pytest.raises(ConfigError, match="builtin/gravel") as caught:
        Scene.read(name, Path())
    assert hint in str(caught.value)


def test_paths_of_a_photo_its_disparity_and_segments_start_at_the_folder(folder):
    files = SceneFiles(left="left.png", right=folder / "right.png")
    scene = Scene.read(files, folder)
    np.testing.assert_array_equal(scene.views.left, PICTURE)
    np.testing.assert_array_equal(scene.views.right, PICTURE)
    assert scene.name == "left.png"
    assert scene.views.calibration is None
    assert scene.truth is None
    write_png(folder / "labels.png", np.repeat(np.uint8([[0, 0, 0, 9, 9, 9]]), 4, axis=0))
    files = SceneFiles(photo="photo.png", disparity="map.npy", segments="labels.png", truth="map.npy")
    scene = Scene.read(files, folder)
    assert set(scene.brings(**SIZE)) == {"views", "disparity", "segments"}
    disparity, segments = scene.disparity, scene.segments
    assert isinstance(disparity, DisparityMap)
    assert isinstance(segments, SegmentMap)
    np.testing.assert_array_equal(disparity.disparity_px, np.load(folder / "map.npy"))
    assert segments.labels[0].tolist() == [0, 0, 0, 1, 1, 1]
    assert scene.views.right is None


def test_height_map_brings_its_relief_and_no_views(folder):
    scene = Scene.read(SceneFiles(height="map.npy"), folder)
    assert scene.views is None
    relief = scene.brings(**SIZE)["relief"]
    assert isinstance(relief, Relief)
    np.testing.assert_allclose(relief.height_m, np.load(folder / "map.npy") / 23 * 0.02, rtol=1e-6)
    assert relief.extent_m == pytest.approx((0.08, 0.08 * 4 / 6))
    scene = Scene.read(SceneFiles(height="map.npy", relief_m=0.005), folder)
    assert scene.brings(**SIZE)["relief"].height_m.max() == np.float32(0.005)


@pytest.mark.parametrize(
    ("files", "named"),
    [
        ({"left": "left.png", "right": "wide.png"}, ("wide.png (right) is 7 x 4", "left.png (left) is 6 x 4")),
        ({"photo": "photo.png", "disparity": "wide.npy"}, ("wide.npy (disparity)", "photo.png (photo)")),
        ({"photo": "photo.png", "segments": "wide.png"}, ("wide.png (segments)", "photo.png (photo)")),
        ({"photo": "photo.png", "truth": "wide.npy"}, ("wide.npy (truth)", "photo.png (photo)")),
        ({"height": "map.npy", "segments": "wide.png"}, ("wide.png (segments)", "map.npy (height)")),
    ],
)
def test_parts_of_two_sizes_are_named_with_their_files(folder, files, named):
    with pytest.raises(PictureError, match="all parts of a scene must be of one size") as caught:
        Scene.read(SceneFiles(**files), folder)
    assert all(each in str(caught.value) for each in named)


@pytest.mark.parametrize("as_file", [True, False])
def test_truth_is_decoded_by_its_scale(as_file: bool, tmp_path: Path):
    """A scale, with 0 unknown; or Sintel's three channels."""
    grey = np.uint16([[0, 256, 640]])
    packed = np.uint8([[[0, 0, 0], [1, 32, 0], [2, 0, 64]]])
    given = {"grey": grey, "packed": packed}
    for name, values in given.items():
        put(tmp_path / f"{name}.png", values)
    grey_of, packed_of = ((tmp_path / f"{name}.png" if as_file else given[name]) for name in given)
    view = np.zeros((1, 3), np.uint8)
    scene = Scene.pair(left=view, right=view, truth=grey_of, truth_scale=256)
    np.testing.assert_array_equal(scene.truth, [[np.nan, 1, 2.5]])
    np.testing.assert_array_equal(Scene.pair(left=view, right=view, truth=grey_of).truth, grey)
    scene = Scene.pair(left=view, right=view, truth=packed_of, truth_scale="sintel")
    np.testing.assert_array_equal(scene.truth, [[0, 4.5, 8 + 64 / 16384]])
    with pytest.raises(PictureError, match="three channels of 8 bits, not"):
        Scene.pair(left=view, right=view, truth=grey_of, truth_scale="sintel")
    with pytest.raises(ConfigError, match="truth_scale needs truth"):
        Scene.pair(left=view, right=view, truth_scale=4)
