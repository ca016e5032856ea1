"""The readers of Middlebury's sets, as their archives unpack."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path

from ..cameras import if_there, middlebury_cameras, old_middlebury_cameras
from ..folders import Folder, folders
from ..standard_pair import FULL_PX, Mask, Resolution, StandardPair

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
    """Yield the pairs of 2014, 2021 and MiddEval3: im0.png, im1.png, calib.txt.

    The truth is disp0.pfm or disp0GT.pfm, the mask mask0nocc.png (255: both views). MiddEval3 has a folder for each
    size and part, such as trainingQ; the others are at full size.
    """
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
    """Yield the pairs of view1.png, view5.png, with the truth disp1.png.

    Its grey levels are disparities times 1, 2 or 3 at FullSize, HalfSize, ThirdSize; 0 is unknown. dmin.txt has the
    offset that is added to disparities of a metric pair.
    """
    for folder in folders(root):
        own = folder.has("view1.png", "view5.png")
        views = folder.path if own else folder.path.joinpath(*_LIT)
        lit = any(name.startswith("Illum") for name in folder.within)
        if lit or not (own or ("disp1.png" in folder.files and (views / "view1.png").exists())):
            continue
        size = _size_of(folder)
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


def _size_of(folder: Folder) -> Resolution:
    for name in reversed(folder.within):
        if size := _SIZES.get(name.lower()):
            return size
    return "F"


def of_2003(root: Path) -> Iterator[StandardPair]:
    """Yield the pairs of im2, im6, with the truth disp2.

    Its grey levels are disparities times 4 at a quarter of the size, 2 at half (conesH), 1 at full size (conesF); 0 is
    unknown.
    """
    for folder in folders(root):
        size = _OF_2003.get(folder.path.name)
        name = folder.path.name[:-1] if size else folder.path.name
        yield from _old(folder, name, ("im2", "im6", "disp2"), float(FULL_PX[size or "Q"]), size or "Q")


def of_2001(root: Path) -> Iterator[StandardPair]:
    """Yield the pairs of im2, im6, with the truth disp2: grey levels of 8 times the disparity.

    Tsukuba (16 times the disparity) and map have other file names.
    """
    for folder in folders(root):
        tsukuba = ("scene1.row3.col3", "scene1.row3.col4", "truedisp.row3.col3")
        for names, scale in ((("im2", "im6", "disp2"), 8.0), (tsukuba, 16.0), (("im0", "im1", "disp0"), 8.0)):
            if named := list(_old(folder, folder.path.name, names, scale, None)):
                yield named[0]
                break


def _old(
    folder: Folder, name: str, files: tuple[str, str, str], scale: float, size: Resolution | None
) -> Iterator[StandardPair]:
    left, right, truth = (
        next((folder.path / f"{stem}{end}" for end in FORMATS if f"{stem}{end}" in folder.files), None)
        for stem in files
    )
    if left is not None and right is not None:
        yield StandardPair(name, left, right, truth, None if truth is None else scale, resolution=size)
