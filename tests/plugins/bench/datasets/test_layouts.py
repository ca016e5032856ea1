"""Folders of standard sets beside their usual layout: several sizes and parts, folders in folders, other cameras."""

from pathlib import Path

import numpy as np
import pytest

from standard_sets import LAYOUTS, Known, known, put, put_pfm, put_views, with_inf
from tangible_bench.datasets import folders, pairs
from tangible_bench.datasets.cameras import kitti_cameras
from tangible_core.errors import PictureError


@pytest.fixture(scope="module")
def k() -> Known:
    return known()


def named(name: str, folder: Path, **more: object) -> dict[str, object]:
    return {each.name: each for each in pairs(name, folder, **more)}


def test_principal_points_of_the_cameras_give_the_offset(tmp_path: Path):
    (tmp_path / "c.txt").write_text(
        "P2: 700 0 600 31.5 0 700 180 0.2 0 0 1 0\nP3: 700 0 612 -350 0 700 180 2 0 0 1 0\n"
    )
    found = kitti_cameras(tmp_path / "c.txt", "P2", "P3").calibration
    assert found is not None
    assert (found.focal_px, found.offset_px) == (700, 12)
    assert found.baseline_m == pytest.approx(0.545)


def test_folders_are_listed_by_name_from_the_outer_to_the_inner(tmp_path: Path):
    for name in ("b/z", "b/a", "a/c"):
        (tmp_path / name).mkdir(parents=True)
    found = [each.within[1:] for each in folders.folders(tmp_path)]
    assert found == [(), ("a",), ("a", "c"), ("b",), ("b", "a"), ("b", "z")]


def test_part_and_size_are_those_of_the_nearest_folder(tmp_path: Path, k: Known):
    for part in ("testH", "trainingQ"):
        put_views(tmp_path / "testF" / part / "Adirondack", k)
    found = pairs("middlebury-eval3", tmp_path / "testF")
    assert [(each.resolution, each.test) for each in found] == [("Q", False)]
    put_views(tmp_path / "FullSize/ThirdSize/Aloe", k, "view1.png", "view5.png")
    put(tmp_path / "FullSize/ThirdSize/Aloe/disp1.png", np.full((64, 96), 90, np.uint8))
    (third,) = pairs("middlebury-2006", tmp_path / "FullSize")
    assert (third.resolution, third.truth_scale) == ("T", 3.0)


@pytest.mark.parametrize(("folder", "size", "scale"), [("conesF", "F", 1.0), ("conesH", "H", 2.0), ("cones", "Q", 4.0)])
def test_grey_levels_of_2003_follow_the_size(tmp_path: Path, k: Known, folder: str, size: str, scale: float):
    put_views(tmp_path / folder, k, "im2.png", "im6.png")
    put(tmp_path / folder / "disp2.png", np.full((64, 96), 40, np.uint8))
    (found,) = pairs("middlebury-2003", tmp_path)
    assert (found.name, found.resolution, found.truth_scale) == ("cones", size, scale)
    assert np.all(found.open().truth_px == 40 / scale)


def test_map_has_eight_grey_levels_a_pixel(tmp_path: Path, k: Known):
    put_views(tmp_path / "map", k, "im0.pgm", "im1.pgm")
    put(tmp_path / "map/disp0.pgm", np.full((64, 96), 160, np.uint8))
    (found,) = pairs("middlebury-2001", tmp_path)
    assert np.all(found.open().truth_px == 20)


def test_pair_of_2005_without_a_truth_is_of_the_test_part(tmp_path: Path, k: Known):
    LAYOUTS["middlebury-2005"].make(tmp_path, k)
    put_views(tmp_path / "HalfSize/Computer", k, "view1.png", "view5.png")
    assert list(named("middlebury-2005", tmp_path)) == ["Art"]
    assert list(named("middlebury-2005", tmp_path, split="test")) == ["Computer"]


def test_colour_is_preferred_to_grey(tmp_path: Path, k: Known):
    LAYOUTS["kitti-2012"].make(tmp_path, k)
    for name in ("image_0", "image_1"):
        put(tmp_path / f"training/{name}/000000_10.png", k.pair.views.left)
    (found,) = pairs("kitti-2012", tmp_path)
    assert found.left.parent.name == "colored_0"


def test_truth_of_a_name_that_lies_twice_is_the_first(tmp_path: Path, k: Known):
    put_views(tmp_path / "pictures/hall", k)
    for number, folder in enumerate(("gt_1", "gt_2")):
        put_pfm(tmp_path / folder / "hall/disp0GT.pfm", with_inf(k) + number)
    (found,) = pairs("eth3d", tmp_path)
    assert found.truth == tmp_path / "gt_1/hall/disp0GT.pfm"


def test_pixels_are_seen_by_both_views_if_no_mask_hides_them(tmp_path: Path, k: Known):
    LAYOUTS["sintel"].make(tmp_path, k)
    hidden = np.zeros((64, 96), np.uint8)
    for name, column in (("occlusions", 20), ("outofframe", 70)):
        (path,) = (tmp_path / "training" / name).rglob("frame_0001.png")
        mask = hidden.copy()
        mask[:, column] = 255
        put(path, mask)
    (found,) = pairs("sintel", tmp_path)
    assert np.flatnonzero(~found.open().noc.all(axis=0)).tolist() == [20, 70]


def test_pairs_of_two_sizes_are_left_out(tmp_path: Path, k: Known):
    LAYOUTS["booster"].make(tmp_path, k)
    usual = list(named("booster", tmp_path))
    for camera in ("camera_00", "camera_02"):
        put(tmp_path / f"train/unbalanced/Case/{camera}/im0.png", k.pair.views.left)
    assert list(named("booster", tmp_path)) == usual


def test_size_is_made_from_the_largest_that_it_divides(tmp_path: Path, k: Known):
    put_views(tmp_path / "HalfSize/Aloe", k, "view1.png", "view5.png")
    put(tmp_path / "HalfSize/Aloe/disp1.png", np.full((64, 96), 90, np.uint8))
    with pytest.raises(PictureError, match="holds Aloe at H, from which T cannot be made"):
        pairs("middlebury-2006", tmp_path, resolution="T")
    for size in ("F", "H"):
        put_views(tmp_path / f"eval3/training{size}/Adirondack", k)
    (quarter,) = pairs("middlebury-eval3", tmp_path / "eval3", resolution="Q")
    assert (quarter.left.parent.parent.name, quarter.shrink, quarter.resolution) == ("trainingF", 4, "Q")


def test_pairs_that_are_named_come_in_that_order(tmp_path: Path, k: Known):
    for name in ("a", "b", "c"):
        put_views(tmp_path / f"trainingQ/{name}", k)
    assert list(named("middlebury-eval3", tmp_path)) == ["a", "b", "c"]
    assert list(named("middlebury-eval3", tmp_path, only=["c", "a"])) == ["c", "a"]
