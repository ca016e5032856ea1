"""Readers for the folders of the standard sets, as their archives unpack: Middlebury, KITTI and the others."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Literal, NamedTuple

from .cameras import if_there, kitti_cameras, middlebury_cameras, old_middlebury_cameras
from .folders import Folder, folders
from .standard_pair import FULL_PX, Mask, Resolution, StandardPair

FORMATS = (".png", ".ppm", ".pgm")
_TRAINING: dict[str, Resolution] = {"trainingF": "F", "trainingH": "H", "trainingQ": "Q"}
_TEST: dict[str, Resolution] = {"testF": "F", "testH": "H", "testQ": "Q"}
_OF_EVAL3: dict[str, Resolution] = {**_TRAINING, **_TEST}
_SIZES: dict[str, Resolution] = {"fullsize": "F", "halfsize": "H", "thirdsize": "T"}
_OF_2003: dict[str, Resolution] = {
    **{"conesF": "F", "conesH": "H", "conesQ": "Q"},
    **{"teddyF": "F", "teddyH": "H", "teddyQ": "Q"},
}
_LIT = ("Illum2", "Exp1")
"""The folder of the lamp and exposure, out of three each, that the archives of two views have."""


def since_2014(root: Path) -> Iterator[StandardPair]:
    """Yield the pairs of 2014, 2021 and MiddEval3 (a folder for each size and part, such as trainingQ)."""
    for folder in folders(root):
        if not folder.has("im0.png", "im1.png"):
            continue
        part = next((name for name in folder.within[::-1] if name in _OF_EVAL3), "trainingF")
        truth = next((name for name in ("disp0GT.pfm", "disp0.pfm") if name in folder.files), None)
        noc = Mask((folder.path / "mask0nocc.png",), "at 255") if "mask0nocc.png" in folder.files else None
        yield StandardPair(
            name=folder.path.name,
            left=folder.path / "im0.png",
            right=folder.path / "im1.png",
            truth=None if truth is None else folder.path / truth,
            noc=noc if truth else None,
            cameras=partial(if_there, middlebury_cameras, folder.path / "calib.txt"),
            resolution=_OF_EVAL3[part],
            test=part in _TEST,
        )


def of_2005_and_2006(root: Path) -> Iterator[StandardPair]:
    """Yield the pairs of view1.png, view5.png, with the truth disp1.png: disparity times its size, 0 unknown."""
    for folder in folders(root):
        own = folder.has("view1.png", "view5.png")
        views = folder.path if own else folder.path.joinpath(*_LIT)
        lit = any(name.startswith("Illum") for name in folder.within)
        if lit or not (own or ("disp1.png" in folder.files and (views / "view1.png").exists())):
            continue
        size = _folder_size(folder)
        by = FULL_PX[size]
        yield StandardPair(
            name=folder.path.name,
            left=views / "view1.png",
            right=views / "view5.png",
            truth=folder.path / "disp1.png" if "disp1.png" in folder.files else None,
            truth_scale=float(by),
            cameras=partial(if_there, old_middlebury_cameras, folder.path / "dmin.txt", by),
            resolution=size,
            test="disp1.png" not in folder.files,
        )


def _folder_size(folder: Folder) -> Resolution:
    for name in reversed(folder.within):
        if size := _SIZES.get(name.lower()):
            return size
    return "F"


def of_2003(root: Path) -> Iterator[StandardPair]:
    """Yield the pairs of im2, im6, with the truth disp2: disparity at full size, 0 unknown; conesH is half the size."""
    for folder in folders(root):
        size = _OF_2003.get(folder.path.name)
        name = folder.path.name[:-1] if size else folder.path.name
        yield from _grey_level_pairs(folder, name, ("im2", "im6", "disp2"), float(FULL_PX[size or "Q"]), size or "Q")


def of_2001(root: Path) -> Iterator[StandardPair]:
    """Yield the pairs of im2, im6, with the truth disp2: 8 times the disparity; of Tsukuba, 16 times."""
    for folder in folders(root):
        tsukuba = ("scene1.row3.col3", "scene1.row3.col4", "truedisp.row3.col3")
        for names, scale in ((("im2", "im6", "disp2"), 8.0), (tsukuba, 16.0), (("im0", "im1", "disp0"), 8.0)):
            if first_pair := list(_grey_level_pairs(folder, folder.path.name, names, scale, None)):
                yield first_pair[0]
                break


def _grey_level_pairs(
    folder: Folder, name: str, files: tuple[str, str, str], scale: float, size: Resolution | None
) -> Iterator[StandardPair]:
    left, right, truth = (
        next((folder.path / f"{stem}{end}" for end in FORMATS if f"{stem}{end}" in folder.files), None)
        for stem in files
    )
    if left is not None and right is not None:
        yield StandardPair(name, left, right, truth, None if truth is None else scale, resolution=size)


KITTI_SCALE = 256.0
KITTI_END = "_10.png"  # the end of the name of a sequence's picture that has a truth


class _Layout(NamedTuple):
    left: str
    right: str
    occ: str
    noc: str
    cameras: str
    projections: tuple[str, str]


_LAYOUTS_2015 = (
    _Layout("image_2", "image_3", "disp_occ_0", "disp_noc_0", "calib_cam_to_cam", ("P_rect_02", "P_rect_03")),
)
_LAYOUTS_2012 = (
    _Layout("colored_0", "colored_1", "disp_occ", "disp_noc", "calib", ("P2", "P3")),
    _Layout("image_0", "image_1", "disp_occ", "disp_noc", "calib", ("P0", "P1")),
)


def kitti_2015(root: Path) -> Iterator[StandardPair]:
    """Yield the pairs of image_2, image_3, disp_occ_0, disp_noc_0, and obj_map (0: background)."""
    return _kitti_pairs(root, _LAYOUTS_2015)


def kitti_2012(root: Path) -> Iterator[StandardPair]:
    """Yield the pairs of colored_0 and colored_1 (or else image_0 and image_1), disp_occ, disp_noc."""
    return _kitti_pairs(root, _LAYOUTS_2012)


def _kitti_pairs(root: Path, layouts: tuple[_Layout, ...]) -> Iterator[StandardPair]:
    files_in = {folder.path: folder.files for folder in folders(root)}
    for part in dict.fromkeys(path.parent for path in files_in):
        layout = next(
            (
                candidate
                for candidate in layouts
                if part / candidate.left in files_in and part / candidate.right in files_in
            ),
            None,
        )
        if layout is None:
            continue
        names = files_in[part / layout.left] & files_in[part / layout.right]
        for name in sorted(picture for picture in names if picture.endswith(KITTI_END)):
            maps = (layout.occ, layout.noc, "obj_map")
            paths = {folder: part / folder / name for folder in maps if name in files_in.get(part / folder, ())}
            text = name.removesuffix(KITTI_END) + ".txt"
            truth = paths.get(layout.occ)
            yield StandardPair(
                name=name.removesuffix(".png"),
                left=part / layout.left / name,
                right=part / layout.right / name,
                truth=truth,
                truth_scale=None if truth is None else KITTI_SCALE,
                noc=_mask(paths.get(layout.noc)),
                foreground=_mask(paths.get("obj_map")),
                sparse=True,
                cameras=partial(if_there, kitti_cameras, part / layout.cameras / text, *layout.projections),
                test=part.name == "testing",
            )


def _mask(path: Path | None) -> Mask | None:
    return None if path is None else Mask((path,), "above 0")


ETH3D_TRUTH, ETH3D_NOC = "disp0GT.pfm", "mask0nocc.png"


def eth3d(root: Path) -> Iterator[StandardPair]:
    """Yield the pairs of NAME/im0.png, im1.png, with the truth disp0GT.pfm, next to them or in a folder of its own."""
    all_folders = list(folders(root))
    truths = {place.path.name: place for place in reversed(all_folders) if ETH3D_TRUTH in place.files}
    for place in all_folders:
        if not place.has("im0.png", "im1.png"):
            continue
        truth = truths.get(place.path.name)
        has_mask = truth is not None and ETH3D_NOC in truth.files
        yield StandardPair(
            name=place.path.name,
            left=place.path / "im0.png",
            right=place.path / "im1.png",
            truth=truth and truth.path / ETH3D_TRUTH,
            noc=Mask((truth.path / ETH3D_NOC,), "at 255") if truth is not None and has_mask else None,
            sparse=True,
            cameras=partial(if_there, middlebury_cameras, place.path / "calib.txt"),
            test=truth is None and not {"two_view_test", "test"}.isdisjoint(place.within),
        )


BOOSTER_LEFT, BOOSTER_RIGHT, BOOSTER_TRUTH, BOOSTER_NOC = "camera_00", "camera_02", "disp_00.npy", "mask_00.png"


def booster(root: Path) -> Iterator[StandardPair]:
    """Yield the pairs of SCENE/camera_00/im0.png (an image for each lamp) and camera_02, with the truth disp_00.npy."""
    all_folders = list(folders(root))
    files_in = {place.path: place.files for place in all_folders}
    for scene, within, files in all_folders:
        if "unbalanced" in within or scene / BOOSTER_LEFT not in files_in:
            continue
        lit = files_in[scene / BOOSTER_LEFT] & files_in.get(scene / BOOSTER_RIGHT, frozenset[str]())
        for name in sorted(picture for picture in lit if picture.endswith(".png")):
            yield StandardPair(
                name=f"{scene.name}/{Path(name).stem}",
                left=scene / BOOSTER_LEFT / name,
                right=scene / BOOSTER_RIGHT / name,
                truth=scene / BOOSTER_TRUTH if BOOSTER_TRUTH in files else None,
                truth_scale=1.0 if BOOSTER_TRUTH in files else None,
                noc=Mask((scene / BOOSTER_NOC,), "above 0") if {BOOSTER_TRUTH, BOOSTER_NOC} <= files else None,
                resolution="F",
                test=BOOSTER_TRUTH not in files and "test" in within,
            )


def sintel(root: Path, variant: Literal["final", "clean"]) -> Iterator[StandardPair]:
    """Yield the pairs of a pass of the film: final, with blur and atmosphere, or clean."""
    files_in = {folder.path: folder.files for folder in folders(root)}
    for path in files_in:
        if path.parent.name != f"{variant}_left":
            continue
        top, scene = path.parent.parent, path.name
        parts = {
            name: files_in.get(top / name / scene, frozenset[str]())
            for name in (f"{variant}_right", "disparities", "occlusions", "outofframe")
        }
        for name in sorted(part for part in files_in[path] & parts[f"{variant}_right"] if part.endswith(".png")):
            truth = top / "disparities" / scene / name if name in parts["disparities"] else None
            masks = [top / mask / scene / name for mask in ("occlusions", "outofframe") if name in parts[mask]]
            yield StandardPair(
                name=f"{scene}/{Path(name).stem}",
                left=path / name,
                right=top / f"{variant}_right" / scene / name,
                truth=truth,
                truth_scale="sintel" if truth else None,
                noc=Mask(tuple(masks), "at 0") if truth and masks else None,
                test=top.name == "test",
            )
