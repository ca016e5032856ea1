"""Every standard set, written from a pair with known truth, and read again."""

import sys
from collections.abc import Callable
from pathlib import Path
from typing import get_args

import numpy as np
import pytest

from standard_sets import LAYOUTS, Known, Layout, known, put, put_views
from tangible_bench.datasets import SETS, folders, pairs
from tangible_bench.datasets.choosing import SetName
from tangible_bench.datasets.standard_pair import StandardPair
from tangible_bench.metrics.standard_sets import visible_pixels
from tangible_core.data import Calibration
from tangible_core.errors import ConfigError, PictureError

EACH = pytest.mark.parametrize("name", LAYOUTS)


@pytest.fixture(scope="module")
def k() -> Known:
    return known()


def only(name: str, folder: Path, **more: object) -> StandardPair:
    (found,) = pairs(name, folder, **more)
    return found


def make_set(name: str, folder: Path, k: Known) -> Layout:
    LAYOUTS[name].make(folder, k)
    return LAYOUTS[name]


def test_sets_all_have_a_layout_and_a_name():
    assert list(SETS) == list(LAYOUTS) == list(get_args(SetName))


@EACH
def test_truth_and_masks_are_read_within_their_encoding(name: str, tmp_path: Path, k: Known):
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
    if name == "kitti-2015":
        np.testing.assert_array_equal(pair.foreground, k.foreground)
    else:
        assert pair.foreground is None


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


@EACH
def test_cameras_range_and_size_are_read(name: str, tmp_path: Path, k: Known):
    make_set(name, tmp_path, k)
    calibration, most_px, full_px = CAMERAS.get(name, (None, None, None))
    pair = only(name, tmp_path).open()
    assert (pair.most_px, pair.full_px) == (most_px, full_px)
    found = pair.views.calibration
    assert (found is None) == (calibration is None)
    if calibration is not None:
        assert vars(found) == pytest.approx(vars(calibration))


@EACH
def test_pair_as_a_scene_has_its_truth(name: str, tmp_path: Path, k: Known):
    make_set(name, tmp_path, k)
    pair, scene = only(name, tmp_path).open(), only(name, tmp_path).scene()
    np.testing.assert_array_equal(scene.truth, pair.truth_px)
    assert scene.files.order == "as-named"


@EACH
def test_missing_and_empty_folders_name_the_archive_to_fetch(name: str, tmp_path: Path):
    for folder in (tmp_path / "nowhere", tmp_path):
        with pytest.raises(PictureError) as error:
            pairs(name, folder)
        assert "\n" not in str(error.value)
        for word in (str(folder), SETS[name].archive, SETS[name].page, SETS[name].contents):
            assert word in str(error.value)


@EACH
def test_pair_without_truth_is_read(name: str, tmp_path: Path, k: Known):
    layout = make_set(name, tmp_path, k)
    (tmp_path / layout.truth).unlink()
    (found,) = pairs(name, tmp_path, only=[layout.name]) if not layout.test else pairs(name, tmp_path)
    pair = found.open()
    assert pair.truth_px is None and pair.views.right is not None
    assert found.scene().truth is None


@pytest.mark.parametrize("name", [name for name, layout in LAYOUTS.items() if layout.test])
def test_test_split_is_read_apart(name: str, tmp_path: Path, k: Known):
    layout = make_set(name, tmp_path, k)
    found = only(name, tmp_path, split="test")
    assert found.test and found.name == layout.test
    assert found.open().truth_px is None
    assert not only(name, tmp_path, split="training").test


@EACH
@pytest.mark.parametrize("content", [b"", b"no picture", b"\x89PNG\r\n\x1a\n broken"])
def test_broken_file_is_refused_with_its_name(name: str, content: bytes, tmp_path: Path, k: Known):
    layout = make_set(name, tmp_path, k)
    for part in filter(None, (layout.left, layout.truth, layout.mask)):
        path = tmp_path / part
        whole = path.read_bytes()
        path.write_bytes(content)
        (found,) = pairs(name, tmp_path)  # listing reads none of them
        with pytest.raises(PictureError) as error:
            found.open()
        assert str(path) in str(error.value) and "\n" not in str(error.value)
        path.write_bytes(whole)


@pytest.mark.parametrize("name", [name for name, layout in LAYOUTS.items() if layout.mask])
def test_mask_of_another_size_is_refused(name: str, tmp_path: Path, k: Known):
    path = tmp_path / make_set(name, tmp_path, k).mask
    put(path, np.zeros((5, 7), np.uint8))
    with pytest.raises(PictureError, match="a mask has the size of its picture") as error:
        only(name, tmp_path).open()
    assert str(path) in str(error.value) and "7 x 5" in str(error.value)


@EACH
def test_extra_files_nested_folders_and_links_are_ignored(name: str, tmp_path: Path, k: Known):
    root = tmp_path / "deep" / "deeper" / "set"
    layout = make_set(name, root, k)
    for folder in [tmp_path, *(path for path in tmp_path.rglob("*") if path.is_dir())]:
        (folder / "README.txt").write_text("hello")
        (folder / ".DS_Store").write_bytes(b"\0")
        (folder / "gone.png").symlink_to(tmp_path / "nothing.png")
        (folder / "loop").symlink_to(tmp_path, target_is_directory=True)
    assert only(name, tmp_path).name == layout.name
    linked = tmp_path / "linked"
    linked.symlink_to(root, target_is_directory=True)
    assert only(name, linked).open().truth_px is not None


def test_folders_with_link_cycles_are_listed_once(tmp_path: Path):
    """Links that lead back would otherwise be followed as deep as folders may lie, in every order."""
    (tmp_path / "a" / "b").mkdir(parents=True)
    for folder in (tmp_path, tmp_path / "a", tmp_path / "a" / "b"):
        for number in range(3):
            (folder / f"back{number}").symlink_to(tmp_path, target_is_directory=True)
    found = [each.path for each in folders.folders(tmp_path)]
    assert found == [tmp_path, tmp_path / "a", tmp_path / "a" / "b"]


def calls_of(work: Callable[[], object]) -> int:
    """Count the calls that a piece of work makes, of Python's own functions too."""
    count, before = 0, sys.getprofile()

    def note(_frame: object, event: str, _of: object) -> None:
        nonlocal count
        count += event in ("call", "c_call")

    sys.setprofile(note)
    try:
        work()
    finally:
        sys.setprofile(before)
    return count


def make_eval3(root: Path, number: int) -> None:
    folder = root / "trainingQ" / f"scene{number:04}"
    folder.mkdir(parents=True)
    for file in ("im0.png", "im1.png", "calib.txt"):
        (folder / file).touch()


def make_kitti(root: Path, number: int) -> None:
    for side in ("image_2", "image_3"):
        (root / "training" / side).mkdir(parents=True, exist_ok=True)
        (root / "training" / side / f"{number:06}_10.png").touch()


@pytest.mark.parametrize(("name", "make"), [("middlebury-eval3", make_eval3), ("kitti-2015", make_kitti)])
def test_pairs_of_a_large_set_are_listed_in_linear_time_unopened(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, name: SetName, make: Callable[[Path, int], None]
):
    """Eight times the pairs take eight times the calls; twelve allow for sorting."""
    monkeypatch.setattr("tangible_core.scene.formats.decoding.read_bytes", None)
    for number in range(50):
        make(tmp_path, number)
    few = calls_of(lambda: pairs(name, tmp_path))
    for number in range(50, 400):
        make(tmp_path, number)
    assert calls_of(lambda: pairs(name, tmp_path)) < 12 * few
    found = pairs(name, tmp_path)
    assert len(found) == 400 and "0007" in found[7].name


def test_folder_with_too_many_entries_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, k: Known):
    make_set("kitti-2015", tmp_path, k)
    monkeypatch.setattr(folders, "MOST_ENTRIES", 5)
    with pytest.raises(PictureError, match="more than 5 files; name the folder of the set alone"):
        pairs("kitti-2015", tmp_path)


@pytest.mark.skipif(sys.platform == "win32", reason="permissions are other ones there")
def test_folder_without_permission_is_refused(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, k: Known):
    make_set("kitti-2015", tmp_path, k)

    def deny(path: str) -> None:
        raise PermissionError(13, "Permission denied")

    monkeypatch.setattr(folders.os, "scandir", deny)  # root may list anything
    with pytest.raises(PictureError, match="cannot be listed: Permission denied; check its permissions"):
        pairs("kitti-2015", tmp_path)


@pytest.mark.parametrize(
    ("call", "said"),
    [
        ({"name": "kitty-2015"}, "no set is named 'kitty-2015' (did you mean 'kitti-2015'?)"),
        ({"resolution": "Q"}, "resolution: kitti-2015 has none called 'Q'; it is left out, for it has one size"),
        ({"split": "validation"}, "split: there is none called 'validation'; it is training or test"),
        ({"variant": "clean"}, "variant: kitti-2015 has none called 'clean'; leave `variant:` out"),
        ({"only": ["000000_01"]}, "no pair in it is named '000000_01' (did you mean '000000_10'?); there are:"),
    ],
)
def test_wrong_choice_of_pairs_is_refused(call: dict[str, object], said: str, tmp_path: Path, k: Known):
    make_set("kitti-2015", tmp_path, k)
    with pytest.raises(ConfigError) as error:
        pairs(**{"name": "kitti-2015", "folder": tmp_path, **call})
    assert said in str(error.value)


def test_pair_name_read_as_a_number_is_resolved(tmp_path: Path, k: Known):
    make_set("kitti-2015", tmp_path, k)
    assert only("kitti-2015", tmp_path, only=[10]).name == "000000_10"
    with pytest.raises(ConfigError, match="no pair in it is named '11'"):
        pairs("kitti-2015", tmp_path, only=[11])


def test_sintel_variant_selects_its_folder(tmp_path: Path, k: Known):
    make_set("sintel", tmp_path, k)
    assert "clean_left" in str(only("sintel", tmp_path, variant="clean").left)
    with pytest.raises(ConfigError, match="there are final and clean"):
        pairs("sintel", tmp_path, variant="final_left")


def test_tsukuba_is_read_with_its_file_names(tmp_path: Path, k: Known):
    put_views(tmp_path / "tsukuba", k, "scene1.row3.col3.ppm", "scene1.row3.col4.ppm")
    put(tmp_path / "tsukuba/truedisp.row3.col3.pgm", np.full((64, 96), 160, np.uint8))
    assert np.all(only("middlebury-2001", tmp_path).open().truth_px == 10)


def test_seven_view_folder_gives_views_of_one_lamp(tmp_path: Path, k: Known):
    make_set("middlebury-2006", tmp_path, k)
    folder = tmp_path / "ThirdSize/Aloe"
    for lamp in ("Illum1/Exp0", "Illum2/Exp1"):
        put_views(folder / lamp, k, "view1.png", "view5.png")
    for view in ("view1.png", "view5.png"):
        (folder / view).unlink()
    assert only("middlebury-2006", tmp_path).left == folder / "Illum2/Exp1/view1.png"


def test_kitti_grey_cameras_replace_missing_colour_ones(tmp_path: Path, k: Known):
    make_set("kitti-2012", tmp_path, k)
    for grey, colour in (("image_0", "colored_0"), ("image_1", "colored_1")):
        (tmp_path / "training" / colour).rename(tmp_path / "training" / grey)
    pair = only("kitti-2012", tmp_path)
    assert pair.left.parent.name == "image_0"
    with pytest.raises(PictureError, match=r"000000\.txt: is not a calibration of a pair: P0 has 1 numbers, not 12"):
        pair.open()


@pytest.mark.parametrize(
    ("text", "why"),
    [
        ("", "cam0 is missing"),
        ("cam0=[0 0 0]\nbaseline=1\ndoffs=0\n", "a calibration needs focal_px > 0"),
        ("cam0=[x 0 0]\nbaseline=1\ndoffs=0\n", "cam0 is x"),
        ("cam0=[9 0 0]\nbaseline=1e999\ndoffs=0\n", "a calibration needs"),
        ("\0" * 300_000, "it holds more than 0.25 MB"),
    ],
)
def test_wrong_calibration_is_refused_in_one_line(text: str, why: str, tmp_path: Path, k: Known):
    make_set("middlebury-2014", tmp_path, k)
    (tmp_path / "Adirondack-perfect/calib.txt").write_text(text)
    with pytest.raises(PictureError) as error:
        only("middlebury-2014", tmp_path).open()
    assert why in str(error.value) and "\n" not in str(error.value) and "calib.txt" in str(error.value)


def test_noc_mask_has_pixels_of_255_only(tmp_path: Path, k: Known):
    layout = make_set("middlebury-eval3", tmp_path, k)
    put(tmp_path / layout.mask, np.full((64, 96), 254, np.uint8))
    assert not only("middlebury-eval3", tmp_path).open().noc.any()


def test_sparse_truth_without_a_mask_gives_no_noc(tmp_path: Path, k: Known):
    make_set("kitti-2015", tmp_path, k)
    (tmp_path / "training/disp_noc_0/000000_10.png").unlink()
    assert only("kitti-2015", tmp_path).open().noc is None


class TestSizes:
    def test_size_in_the_folder_is_taken(self, tmp_path: Path, k: Known):
        make_set("middlebury-2006", tmp_path, k)
        put_views(tmp_path / "FullSize/Aloe", k, "view1.png", "view5.png")
        put(tmp_path / "FullSize/Aloe/disp1.png", np.full((64, 96), 90, np.uint8))
        assert only("middlebury-2006", tmp_path).resolution == "F"
        assert np.all(only("middlebury-2006", tmp_path).open().truth_px == 90)
        third = only("middlebury-2006", tmp_path, resolution="T")
        assert third.shrink == 1 and "ThirdSize" in str(third.left)

    def test_smaller_size_is_made_by_shrinking(self, tmp_path: Path, k: Known):
        make_set("middlebury-2014", tmp_path, k)
        whole, quarter = (only("middlebury-2014", tmp_path, resolution=size).open() for size in ("F", "Q"))
        assert quarter.views.shape == (16, 24) and quarter.full_px == 4 and quarter.most_px == 5
        assert vars(quarter.views.calibration) == pytest.approx(vars(Calibration(750.0, 0.193001, 2.5)))
        assert np.isnan(quarter.truth_px[0]).all() and np.isfinite(quarter.truth_px[1:]).all()
        blocks = whole.truth_px.reshape(16, 4, 24, 4).swapaxes(1, 2).reshape(16, 24, 16)
        held = (blocks == 4 * quarter.truth_px[..., None]).any(axis=-1)
        assert held[1:].all(), "each is the disparity of one of its pixels, and no mean across an edge"
        low, high = (np.percentile(blocks[1:], q, axis=-1) for q in (40, 60))
        assert (low <= 4 * quarter.truth_px[1:]).all() and (4 * quarter.truth_px[1:] <= high + 1e-4).mean() > 0.9

    def test_larger_size_is_refused(self, tmp_path: Path, k: Known):
        make_set("middlebury-eval3", tmp_path, k)
        with pytest.raises(PictureError, match=r"holds Adirondack at Q, from which H cannot be made; fetch .*, at H"):
            pairs("middlebury-eval3", tmp_path, resolution="H")

    def test_pipeline_refuses_a_size_that_is_not_in_the_folder(self, tmp_path: Path, k: Known):
        make_set("middlebury-2014", tmp_path, k)
        with pytest.raises(ConfigError, match="is not in its folder at Q; fetch that size, or leave `resolution:` out"):
            only("middlebury-2014", tmp_path, resolution="Q").files()

    @pytest.mark.parametrize("shape", [(1, 1), (3, 2), (4, 4), (5, 9)])
    def test_tiny_pair_is_shrunk(self, shape: tuple[int, int], tmp_path: Path):
        folder = tmp_path / "tiny"
        for view in ("im0.png", "im1.png"):
            put(folder / view, np.full(shape, 7, np.uint8))
        (folder / "disp0.pfm").write_bytes(
            f"Pf\n{shape[1]} {shape[0]}\n-1\n".encode() + np.full(shape, 8, "<f4").tobytes()
        )
        pair = only("middlebury-2014", tmp_path, resolution="Q").open()
        assert np.all(pair.truth_px == 2) and np.all(pair.views.left == 7)
        assert pair.truth_px.shape == pair.views.shape
