"""Sets as their archives unpack: read exactly, found by globs, and made smaller with their truth."""

from pathlib import Path
from typing import get_args

import numpy as np
import pytest

from standard_sets import LAYOUTS, Known, Layout, known, put, put_pfm, put_views
from tangible_bench.datasets import SETS, folders, match_files, pairs
from tangible_bench.datasets.cameras import kitti_cameras
from tangible_bench.datasets.choosing import SetName
from tangible_bench.datasets.standard_pair import StandardPair, shrink_mask, shrink_truth, shrink_views
from tangible_bench.metrics.standard_sets import visible_pixels
from tangible_core.data import Calibration, Views
from tangible_core.errors import ConfigError, PictureError

EACH = pytest.mark.parametrize("name", LAYOUTS)
CAMERAS = {
    "middlebury-2006": (Calibration(3740 / 3, 0.16, 90.0), None, 3.0),
    "middlebury-2014": (Calibration(3000.0, 0.193001, 10.0), 20, 1.0),
    "middlebury-2021": (Calibration(3000.0, 0.193001, 10.0), 20, 1.0),
    "middlebury-eval3": (Calibration(3000.0, 0.193001, 10.0), 20, 4.0),
    "kitti-2012": (Calibration(700.0, 0.545), None, None),
    "kitti-2015": (Calibration(700.0, 0.545), None, None),
    "eth3d": (Calibration(3000.0, 0.193001, 10.0), 20, None),
    "booster": (None, None, 1.0),
    "middlebury-2003": (None, None, 4.0),
    "middlebury-2005": (None, None, 2.0),
}
"""The calibration, the range in px, and the width of a pixel in those of the full size."""


@pytest.fixture(scope="module")
def k() -> Known:
    return known()


def only(name: str, folder: Path, **more: object) -> StandardPair:
    (found,) = pairs(name, folder, **more)
    return found


def names(name: str, folder: Path, **more: object) -> list[str]:
    return [pair.name for pair in pairs(name, folder, **more)]


def make_set(name: str, folder: Path, k: Known) -> Layout:
    LAYOUTS[name].make(folder, k)
    return LAYOUTS[name]


def grey(level: int) -> np.ndarray:
    return np.full((64, 96), level, np.uint8)


@EACH
def test_truth_masks_and_cameras_are_read(name: str, tmp_path: Path, k: Known):
    layout = make_set(name, tmp_path, k)
    found = only(name, tmp_path)
    assert found.name == layout.name and not found.test
    pair = found.open()
    truth = k.pair.truth_px if name == "sintel" else k.truth_px
    np.testing.assert_array_equal(np.isnan(pair.truth_px), np.isnan(truth))
    assert np.nanmax(np.abs(pair.truth_px - truth)) <= layout.within_px + 1e-6
    np.testing.assert_array_equal(pair.views.left, k.pair.views.left)
    np.testing.assert_array_equal(pair.views.right, k.pair.views.right)
    at = np.isfinite(truth)
    shown = k.visible if layout.marks_noc else visible_pixels(pair.truth_px)
    np.testing.assert_array_equal(pair.noc[at], shown[at])
    assert (pair.foreground is None) == (name != "kitti-2015")
    assert pair.foreground is None or (pair.foreground == k.foreground).all()
    calibration, most_px, full_px = CAMERAS.get(name, (None, None, None))
    assert (pair.most_px, pair.full_px) == (most_px, full_px)
    cameras = pair.views.calibration
    assert (cameras is None) == (calibration is None)
    assert calibration is None or vars(cameras) == pytest.approx(vars(calibration))
    scene = found.scene()
    np.testing.assert_array_equal(scene.truth, pair.truth_px)
    assert scene.files.order == "as-named"
    (tmp_path / layout.truth).unlink()
    bare = only(name, tmp_path, only=() if layout.test else [layout.name])
    assert bare.open().truth_px is None and bare.scene().truth is None


def test_missing_and_empty_folders_name_the_archive_to_fetch(tmp_path: Path):
    assert list(SETS) == list(LAYOUTS) == list(get_args(SetName))
    for name, known_set in SETS.items():
        for folder in (tmp_path / "nowhere", tmp_path):
            with pytest.raises(PictureError) as error:
                pairs(name, folder)
            for word in (str(folder), known_set.archive, known_set.page, known_set.contents):
                assert word in str(error.value)


@pytest.mark.parametrize("name", [name for name, layout in LAYOUTS.items() if layout.test])
def test_test_split_is_read_apart(name: str, tmp_path: Path, k: Known):
    layout = make_set(name, tmp_path, k)
    found = only(name, tmp_path, split="test")
    assert found.test and found.name == layout.test and found.open().truth_px is None
    assert not only(name, tmp_path, split="training").test


@EACH
def test_broken_file_is_refused_with_its_name(name: str, tmp_path: Path, k: Known):
    layout = make_set(name, tmp_path, k)
    for part in filter(None, (layout.left, layout.truth, layout.mask)):
        path = tmp_path / part
        whole = path.read_bytes()
        path.write_bytes(b"no picture")
        (found,) = pairs(name, tmp_path)  # listing reads none of them
        with pytest.raises(PictureError) as error:
            found.open()
        assert str(path) in str(error.value)
        path.write_bytes(whole)
    if layout.mask:
        put(tmp_path / layout.mask, np.zeros((5, 7), np.uint8))
        with pytest.raises(PictureError, match="7 x 5"):
            only(name, tmp_path).open()


@pytest.mark.parametrize("name", ["middlebury-2006", "kitti-2015", "sintel", "booster", "eth3d"])
def test_extra_files_nested_folders_and_links_are_ignored(name: str, tmp_path: Path, k: Known):
    root = tmp_path / "deep" / "deeper" / "set"
    layout = make_set(name, root, k)
    for folder in [tmp_path, *(path for path in tmp_path.rglob("*") if path.is_dir())]:
        (folder / "README.txt").write_text("hello")
        (folder / "gone.png").symlink_to(tmp_path / "nothing.png")
        (folder / "loop").symlink_to(tmp_path, target_is_directory=True)
    assert only(name, tmp_path).name == layout.name
    linked = tmp_path / "linked"
    linked.symlink_to(root, target_is_directory=True)
    assert only(name, linked).open().truth_px is not None


def test_folders_are_listed_once_by_name_from_the_outer_to_the_inner(tmp_path: Path):
    """Links that lead back would otherwise be followed as deep as folders may lie, in every order."""
    for name in ("b/z", "b/a", "a/c"):
        (tmp_path / name).mkdir(parents=True)
    for folder in (tmp_path, tmp_path / "a", tmp_path / "a" / "c"):
        (folder / "back").symlink_to(tmp_path, target_is_directory=True)
    found = [each.within[1:] for each in folders.folders(tmp_path)]
    assert found == [(), ("a",), ("a", "c"), ("b",), ("b", "a"), ("b", "z")]


@pytest.mark.parametrize(
    ("call", "said"),
    [
        ({"name": "kitty-2015"}, "did you mean 'kitti-2015'"),
        ({"resolution": "Q"}, "one size"),
        ({"split": "validation"}, "training or test"),
        ({"variant": "clean"}, "leave `variant:` out"),
        ({"name": "sintel", "variant": "final_left"}, "final and clean"),
        ({"only": ["000000_01"]}, "did you mean '000000_10'"),
        ({"only": [11]}, "'11'"),
    ],
)
def test_wrong_choice_of_pairs_is_refused(call: dict[str, object], said: str, tmp_path: Path, k: Known):
    make_set(str(call.get("name", "kitti-2015")).replace("kitty", "kitti"), tmp_path, k)
    with pytest.raises(ConfigError) as error:
        pairs(**{"name": "kitti-2015", "folder": tmp_path, **call})
    assert said in str(error.value)


def test_named_pairs_come_in_order_of_the_nearest_folder(tmp_path: Path, k: Known):
    for name in ("a", "b", "c"):
        put_views(tmp_path / f"trainingQ/{name}", k)
    assert names("middlebury-eval3", tmp_path) == ["a", "b", "c"]
    assert names("middlebury-eval3", tmp_path, only=["c", "a"]) == ["c", "a"]
    make_set("kitti-2015", tmp_path, k)
    assert names("kitti-2015", tmp_path, only=[10]) == ["000000_10"], "YAML reads the name as a number"
    for part in ("testH", "trainingQ"):
        put_views(tmp_path / "testF" / part / "Adirondack", k)
    found = pairs("middlebury-eval3", tmp_path / "testF")
    assert [(each.resolution, each.test) for each in found] == [("Q", False)]
    put_views(tmp_path / "FullSize/ThirdSize/Aloe", k, "view1.png", "view5.png")
    put(tmp_path / "FullSize/ThirdSize/Aloe/disp1.png", grey(90))
    third = only("middlebury-2006", tmp_path / "FullSize")
    assert (third.resolution, third.truth_scale) == ("T", 3.0)


@pytest.mark.parametrize(
    ("name", "files", "resolution", "truth_px"),
    [
        ("middlebury-2003", ("conesF/im2.png", "conesF/im6.png", "conesF/disp2.png"), "F", 160),
        ("middlebury-2003", ("conesH/im2.png", "conesH/im6.png", "conesH/disp2.png"), "H", 80),
        ("middlebury-2003", ("cones/im2.png", "cones/im6.png", "cones/disp2.png"), "Q", 40),
        ("middlebury-2001", ("map/im0.pgm", "map/im1.pgm", "map/disp0.pgm"), None, 20),
        ("middlebury-2001", ("t/scene1.row3.col3.ppm", "t/scene1.row3.col4.ppm", "t/truedisp.row3.col3.pgm"), None, 10),
    ],
)
def test_grey_levels_of_old_sets_follow_size_and_scene(name, files, resolution, truth_px, tmp_path: Path, k: Known):
    put_views(tmp_path, k, *files[:2])
    put(tmp_path / files[2], grey(160))
    found = only(name, tmp_path)
    assert (found.resolution, found.name in ("cones", "map", "t")) == (resolution, True)
    assert np.all(found.open().truth_px == truth_px)


def test_masks_and_cameras_are_those_of_their_set(tmp_path: Path, k: Known):
    make_set("kitti-2012", tmp_path, k)
    for name in ("image_0", "image_1"):
        put(tmp_path / f"training/{name}/000000_10.png", k.pair.views.left)
    assert only("kitti-2012", tmp_path).left.parent.name == "colored_0"
    (tmp_path / "training/colored_0").rename(tmp_path / "away")
    pair = only("kitti-2012", tmp_path)
    assert pair.left.parent.name == "image_0"
    with pytest.raises(PictureError, match=r"000000\.txt: is not a calibration of a pair: P0"):
        pair.open()
    (tmp_path / "c.txt").write_text(
        "P2: 700 0 600 31.5 0 700 180 0.2 0 0 1 0\nP3: 700 0 612 -350 0 700 180 2 0 0 1 0\n"
    )
    found = kitti_cameras(tmp_path / "c.txt", "P2", "P3").calibration
    assert vars(found) == pytest.approx(vars(Calibration(700.0, 0.545, 12.0)))
    make_set("sintel", tmp_path / "sintel", k)
    assert "clean_left" in str(only("sintel", tmp_path / "sintel", variant="clean").left)
    for name, column in (("occlusions", 20), ("outofframe", 70)):
        (path,) = (tmp_path / "sintel/training" / name).rglob("frame_0001.png")
        mask = grey(0)
        mask[:, column] = 255
        put(path, mask)
    noc = only("sintel", tmp_path / "sintel").open().noc
    assert np.flatnonzero(~noc.all(axis=0)).tolist() == [20, 70], "hidden by any of the two"
    layout = make_set("middlebury-eval3", tmp_path / "v3", k)
    put(tmp_path / "v3" / layout.mask, grey(254))
    assert not only("middlebury-eval3", tmp_path / "v3").open().noc.any(), "255 alone is seen by both"
    make_set("kitti-2015", tmp_path / "kitti", k)
    (tmp_path / "kitti/training/disp_noc_0/000000_10.png").unlink()
    assert only("kitti-2015", tmp_path / "kitti").open().noc is None, "none follows from a sparse truth"


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "cam0 is missing"),
        ("cam0=[0 0 0]\nbaseline=1\ndoffs=0\n", "focal_px > 0"),
        ("cam0=[x 0 0]\nbaseline=1\ndoffs=0\n", "cam0 is x"),
        ("\0" * 300_000, "MB"),
    ],
)
def test_wrong_calibration_is_refused(text: str, why: str, tmp_path: Path, k: Known):
    make_set("middlebury-2014", tmp_path, k)
    (tmp_path / "Adirondack-perfect/calib.txt").write_text(text)
    with pytest.raises(PictureError, match=rf"calib\.txt.*{why}"):
        only("middlebury-2014", tmp_path).open()


def test_size_is_that_in_the_folder_or_made_from_the_largest_that_it_divides(tmp_path: Path, k: Known):
    make_set("middlebury-2006", tmp_path / "both", k)
    for folder in ("both/FullSize/Aloe", "half/HalfSize/Aloe"):
        put_views(tmp_path / folder, k, "view1.png", "view5.png")
        put(tmp_path / folder / "disp1.png", grey(90))
    largest = only("middlebury-2006", tmp_path / "both")
    assert largest.resolution == "F" and np.all(largest.open().truth_px == 90)
    third = only("middlebury-2006", tmp_path / "both", resolution="T")
    assert third.shrink == 1 and "ThirdSize" in str(third.left)
    with pytest.raises(PictureError, match="holds Aloe at H, from which T cannot be made"):
        pairs("middlebury-2006", tmp_path / "half", resolution="T")
    for size in ("F", "H"):
        put_views(tmp_path / f"eval3/training{size}/Adirondack", k)
    quarter = only("middlebury-eval3", tmp_path / "eval3", resolution="Q")
    assert (quarter.left.parent.parent.name, quarter.shrink, quarter.resolution) == ("trainingF", 4, "Q")
    with pytest.raises(ConfigError, match="is not in its folder at Q"):
        quarter.files()


def test_smaller_size_is_made_by_shrinking(tmp_path: Path, k: Known):
    make_set("middlebury-2014", tmp_path, k)
    whole, quarter = (only("middlebury-2014", tmp_path, resolution=size).open() for size in ("F", "Q"))
    assert quarter.views.shape == (16, 24) and quarter.full_px == 4 and quarter.most_px == 5
    assert vars(quarter.views.calibration) == pytest.approx(vars(Calibration(750.0, 0.193001, 2.5)))
    assert np.isnan(quarter.truth_px[0]).all() and np.isfinite(quarter.truth_px[1:]).all()
    blocks = whole.truth_px.reshape(16, 4, 24, 4).swapaxes(1, 2).reshape(16, 24, 16)
    held = (blocks == 4 * quarter.truth_px[..., None]).any(axis=-1)
    assert held[1:].all(), "each is the disparity of one of its pixels, and no mean across an edge"


@pytest.mark.parametrize("shape", [(1, 1), (3, 2), (5, 9)])
def test_tiny_pair_is_shrunk(shape: tuple[int, int], tmp_path: Path):
    for view in ("im0.png", "im1.png"):
        put(tmp_path / "tiny" / view, np.full(shape, 7, np.uint8))
    put_pfm(tmp_path / "tiny/disp0.pfm", np.full(shape, 8))
    pair = only("middlebury-2014", tmp_path, resolution="Q").open()
    assert np.all(pair.truth_px == 2) and np.all(pair.views.left == 7)
    assert pair.truth_px.shape == pair.views.shape


NAN = float("nan")


@pytest.mark.parametrize(
    ("block", "found"),
    [
        ([8.0, 2.0, 6.0, 4.0], 3.0),  # the upper one of the two in the middle, in pixels of half the size
        ([8.0, 2.0, NAN, 4.0], 2.0),
        ([NAN, 2.0, 6.0, NAN], 3.0),  # just half of them are known
        ([NAN, 2.0, NAN, NAN], NAN),
        ([NAN, NAN, NAN, NAN], NAN),
    ],
)
def test_disparity_of_a_block_is_the_upper_middle_of_those_known(block: list[float], found: float):
    truth_px = np.float32([[*block[:2], 5.0, 5.0], [*block[2:], 5.0, 5.0]])
    np.testing.assert_array_equal(shrink_truth(truth_px, 2), np.float32([[found, 2.5]]))


def test_block_is_marked_if_most_of_it_is_and_views_are_means_of_blocks_with_smaller_cameras():
    for block, marked in (([1, 0, 1, 0], False), ([1, 1, 1, 0], True), ([0, 0, 0, 0], False)):
        mask = np.array([[*block[:2], 1, 1], [*block[2:], 1, 1]], bool)
        assert shrink_mask(mask, 2).tolist() == [[marked, True]]
    left, right = np.uint8([[0, 4, 10], [8, 12, 10]]), np.uint8([[20, 20, 0], [40, 40, 0]])
    found = shrink_views(Views(left, right, Calibration(900.0, 0.2, 30.0)), 2)
    assert (found.left.tolist(), found.right.tolist()) == ([[6]], [[30]])
    assert vars(found.calibration) == vars(Calibration(450.0, 0.2, 15.0))


NEEDED = ("left", "right")


def touch(folder: Path, *names: str) -> None:
    for name in names:
        (folder / name).parent.mkdir(parents=True, exist_ok=True)
        (folder / name).touch()


@pytest.mark.parametrize(
    ("files", "patterns", "names"),
    [
        (["a_left.png", "a_right.png", "b_left.png", "b_right.png"], ("*_left.png", "*_right.png"), ["a", "b"]),
        (["l/1.png", "r/1.png", "l/x.txt"], ("l/*.png", "r/*.png"), ["1"]),
        (["a/1/L.png", "a/1/R.png", "a/2/L.png", "a/2/R.png"], ("a/*/L.png", "a/*/R.png"), ["1", "2"]),
        (["x/y/z/L1.png", "x/y/z/R1.png", "L2.png", "R2.png"], ("**/L*.png", "**/R*.png"), ["2", "x/y/z/1"]),
        (["s1/L01.png", "s1/R01.png", "s1/L011.png"], ("s?/L[0-9]1.png", "s?/R[0-9]1.png"), ["1/0"]),
        (["[x]/1.png", "[y]/1.png"], ("[[]x]/*.png", "[[]y]/*.png"), ["[/1"]),
        (["a+b/1.png", "a+c/1.png"], ("a+b/*.png", "a+c/*.png"), ["1"]),
    ],
)
def test_files_with_the_same_stars_are_matched_and_an_optional_part_may_be_missing(
    files, patterns, names, tmp_path: Path
):
    touch(tmp_path, *files)
    found = match_files(tmp_path, dict(zip(NEEDED, patterns, strict=True)), NEEDED)
    assert list(found) == names
    for parts in found.values():
        assert parts["left"] != parts["right"] and all(path.is_file() for path in parts.values())
    touch(tmp_path / "more", "L1.png", "R1.png", "D1.pfm", "L2.png", "R2.png")
    found = match_files(tmp_path / "more", {"left": "L*.png", "right": "R*.png", "truth": "D*.pfm"}, NEEDED)
    assert found["1"]["truth"] == tmp_path / "more/D1.pfm" and "truth" not in found["2"]


@pytest.mark.parametrize(
    ("patterns", "error", "why"),
    [
        ({"left": "L*.png", "right": "R.png"}, ConfigError, "right: 'R.png' has 0 stars and left: 'L*.png' has 1"),
        ({"left": "L1.png", "right": "R1.png"}, ConfigError, "each pattern needs as many, at least one"),
        (
            {"left": "Q*.png", "right": "R*.png"},
            PictureError,
            "no file in it matches left: 'Q*.png'; check the pattern",
        ),
        ({"left": "L*.png", "right": "R*.png"}, PictureError, "L2.png: no file matches right: 'R*.png' with the same"),
        ({"left": "no/L*.png", "right": "R*.png"}, PictureError, "no: there is no such folder for 'no/L*.png'"),
    ],
)
def test_wrong_patterns_are_refused_in_one_line(patterns, error, why, tmp_path: Path):
    touch(tmp_path, "L1.png", "R1.png", "L2.png")
    with pytest.raises(error) as said:
        match_files(tmp_path, patterns, NEEDED)
    assert why in str(said.value) and "\n" not in str(said.value)
