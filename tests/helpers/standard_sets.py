"""Folders of standard sets as their archives unpack, made of one pair whose truth is known."""

from collections.abc import Callable, Mapping
from pathlib import Path
from typing import NamedTuple

import numpy as np
from PIL import Image

from tangible_core.testing.synthetic.stereo_scenes import KnownPair, synthetic_pair

WIDTH, HEIGHT = 96, 64
UNKNOWN_ROWS = 4


class Known(NamedTuple):
    """The pair, and its truth with some rows unknown."""

    pair: KnownPair
    truth_px: np.ndarray
    visible: np.ndarray

    @property
    def foreground(self) -> np.ndarray:
        return self.truth_px > np.nanmedian(self.truth_px)


def known() -> Known:
    pair = synthetic_pair("spheres", WIDTH, HEIGHT, seed=0)
    truth = pair.truth_px.copy()
    truth[:UNKNOWN_ROWS] = np.nan
    return Known(pair, truth, pair.visible)


def put(path: Path, values: np.ndarray) -> None:
    path.parent.mkdir(parents=True, exist_ok=True)
    Image.fromarray(np.ascontiguousarray(values)).save(path)


def put_pfm(path: Path, values: np.ndarray, order: str = "<") -> None:
    """Rows from the bottom up; the sign of the scale tells the order of the bytes."""
    path.parent.mkdir(parents=True, exist_ok=True)
    head = f"Pf\n{values.shape[1]} {values.shape[0]}\n{'-1.0' if order == '<' else '1.0'}\n"
    path.write_bytes(head.encode() + values[::-1].astype(f"{order}f4").tobytes())


def put_views(folder: Path, k: Known, left: str = "im0.png", right: str = "im1.png") -> None:
    put(folder / left, k.pair.views.left)
    put(folder / right, k.pair.views.right)


CALIB = """cam0=[3000 0 40; 0 3000 30; 0 0 1]
cam1=[3000 0 50; 0 3000 30; 0 0 1]
doffs=10.0
baseline=193.001
width=96
height=64
ndisp=20
"""


def with_inf(k: Known) -> np.ndarray:
    return np.where(np.isnan(k.truth_px), np.inf, k.truth_px)


def nocc(k: Known) -> np.ndarray:
    return np.where(k.visible, 255, 128).astype(np.uint8)


def grey(k: Known, scale: int, dtype: type = np.uint8) -> np.ndarray:
    return np.rint(scale * np.nan_to_num(k.truth_px)).astype(dtype)


def middlebury_eval3(root: Path, k: Known) -> None:
    folder = root / "trainingQ/Adirondack"
    put_views(folder, k)
    put_pfm(folder / "disp0GT.pfm", with_inf(k))
    put(folder / "mask0nocc.png", nocc(k))
    (folder / "calib.txt").write_text(CALIB)
    put_views(root / "testQ/Australia", k)
    (root / "testQ/Australia/calib.txt").write_text(CALIB)


def _kitti(root: Path, k: Known, left: str, right: str, occ: str, noc: str) -> None:
    for part, number in (("training", "000000"), ("testing", "000000")):
        put(root / part / left / f"{number}_10.png", k.pair.views.left)
        put(root / part / right / f"{number}_10.png", k.pair.views.right)
        put(root / part / left / f"{number}_11.png", k.pair.views.left)
        put(root / part / right / f"{number}_11.png", k.pair.views.right)
    put(root / "training" / occ / "000000_10.png", grey(k, 256, np.uint16))
    put(root / "training" / noc / "000000_10.png", grey(k, 256, np.uint16) * k.visible)


def kitti_2012(root: Path, k: Known) -> None:
    _kitti(root, k, "colored_0", "colored_1", "disp_occ", "disp_noc")
    (root / "training/calib").mkdir()
    (root / "training/calib/000000.txt").write_text(
        "P2: 700 0 600 31.5 0 700 180 0.2 0 0 1 0.002\nP3: 700 0 600 -350 0 700 180 2.2 0 0 1 0.003\n"
    )


def kitti_2015(root: Path, k: Known) -> None:
    _kitti(root, k, "image_2", "image_3", "disp_occ_0", "disp_noc_0")
    put(root / "training/obj_map/000000_10.png", k.foreground.astype(np.uint8))
    (root / "training/calib_cam_to_cam").mkdir()
    (root / "training/calib_cam_to_cam/000000.txt").write_text(
        "calib_time: 09-Jan-2012 13:57:47\nP_rect_02: 700 0 600 31.5 0 700 180 0.2 0 0 1 0.002\n"
        "P_rect_03: 700 0 600 -350 0 700 180 2.2 0 0 1 0.003\n"
    )


def eth3d(root: Path, k: Known) -> None:
    put_views(root / "two_view_training/delivery_area_1l", k)
    (root / "two_view_training/delivery_area_1l/calib.txt").write_text(CALIB)
    put_pfm(root / "two_view_training_gt/delivery_area_1l/disp0GT.pfm", with_inf(k))
    put(root / "two_view_training_gt/delivery_area_1l/mask0nocc.png", nocc(k))
    put_views(root / "two_view_test/lakeside_1l", k)


def sintel(root: Path, k: Known) -> None:
    """Truth that is unknown nowhere: its encoding has no mark for it."""
    d = k.pair.truth_px
    red = np.floor(d / 4)
    green = np.floor((d - 4 * red) * 64)
    blue = np.floor((d - 4 * red - green / 64) * 16384)
    frame = "alley_1/frame_0001.png"
    for kind in ("final", "clean"):
        put(root / f"training/{kind}_left/{frame}", k.pair.views.left)
        put(root / f"training/{kind}_right/{frame}", k.pair.views.right)
    put(root / f"training/disparities/{frame}", np.stack([red, green, blue], -1).astype(np.uint8))
    half = np.indices(d.shape)[1] < d.shape[1] // 2
    put(root / f"training/occlusions/{frame}", np.where(k.visible | half, 0, 255).astype(np.uint8))
    put(root / f"training/outofframe/{frame}", np.where(k.visible | ~half, 0, 255).astype(np.uint8))


def booster(root: Path, k: Known) -> None:
    scene = root / "train/balanced/Bathroom"
    put(scene / "camera_00/im0.png", k.pair.views.left)
    put(scene / "camera_02/im0.png", k.pair.views.right)
    np.save(scene / "disp_00.npy", np.nan_to_num(k.truth_px))
    put(scene / "mask_00.png", np.where(k.visible, 255, 0).astype(np.uint8))
    put(root / "test/balanced/Cans/camera_00/im0.png", k.pair.views.left)
    put(root / "test/balanced/Cans/camera_02/im0.png", k.pair.views.right)


class Layout(NamedTuple):
    """How a set is made, which pair of it there is, and within what its truth returns."""

    make: Callable[[Path, Known], None]
    name: str
    left: str
    truth: str
    within_px: float
    mask: str = ""
    marks_noc: bool = False
    test: str = ""


def middlebury_of_bytes(folder: str, left: str, right: str, truth: str, scale: int) -> Layout:
    def make(root: Path, k: Known) -> None:
        put_views(root / folder, k, left, right)
        put(root / folder / truth, grey(k, scale))
        if scale == 3:  # the sets of 2006 alone cut a margin off
            (root / folder / "dmin.txt").write_text("270\n")

    return Layout(make, Path(folder).name, f"{folder}/{left}", f"{folder}/{truth}", 1 / (2 * scale))


def middlebury_of_floats(folder: str, order: str) -> Layout:
    def make(root: Path, k: Known) -> None:
        put_views(root / folder, k)
        put_pfm(root / folder / "disp0.pfm", with_inf(k), order)
        (root / folder / "calib.txt").write_text(CALIB)

    return Layout(make, Path(folder).name, f"{folder}/im0.png", f"{folder}/disp0.pfm", 0)


LAYOUTS: Mapping[str, Layout] = {
    "middlebury-2001": middlebury_of_bytes("sawtooth", "im2.ppm", "im6.ppm", "disp2.pgm", 8),
    "middlebury-2003": middlebury_of_bytes("cones", "im2.png", "im6.png", "disp2.png", 4),
    "middlebury-2005": middlebury_of_bytes("HalfSize/Art", "view1.png", "view5.png", "disp1.png", 2),
    "middlebury-2006": middlebury_of_bytes("ThirdSize/Aloe", "view1.png", "view5.png", "disp1.png", 3),
    "middlebury-2014": middlebury_of_floats("Adirondack-perfect", "<"),
    "middlebury-2021": middlebury_of_floats("data/artroom1", ">"),
    "middlebury-eval3": Layout(
        middlebury_eval3, "Adirondack", "trainingQ/Adirondack/im0.png", "trainingQ/Adirondack/disp0GT.pfm", 0,
        "trainingQ/Adirondack/mask0nocc.png", True, "Australia",
    ),
    "kitti-2012": Layout(
        kitti_2012, "000000_10", "training/colored_0/000000_10.png", "training/disp_occ/000000_10.png", 1 / 512,
        "training/disp_noc/000000_10.png", True, "000000_10",
    ),
    "kitti-2015": Layout(
        kitti_2015, "000000_10", "training/image_2/000000_10.png", "training/disp_occ_0/000000_10.png", 1 / 512,
        "training/obj_map/000000_10.png", True, "000000_10",
    ),
    "eth3d": Layout(
        eth3d, "delivery_area_1l", "two_view_training/delivery_area_1l/im0.png",
        "two_view_training_gt/delivery_area_1l/disp0GT.pfm", 0, "two_view_training_gt/delivery_area_1l/mask0nocc.png",
        True, "lakeside_1l",
    ),
    "sintel": Layout(
        sintel, "alley_1/frame_0001", "training/final_left/alley_1/frame_0001.png",
        "training/disparities/alley_1/frame_0001.png", 1 / 16384, "training/occlusions/alley_1/frame_0001.png", True,
    ),
    "booster": Layout(
        booster, "Bathroom/im0", "train/balanced/Bathroom/camera_00/im0.png", "train/balanced/Bathroom/disp_00.npy", 0,
        "train/balanced/Bathroom/mask_00.png", True, "Cans/im0",
    ),
}  # fmt: skip
