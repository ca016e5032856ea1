"""KITTI 2012 and 2015, as their archives unpack: disparities as uint16, 256 a pixel, 0 unknown."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import NamedTuple

from ..cameras import if_there, kitti_cameras
from ..folders import folders
from ..standard_pair import Mask, StandardPair

SCALE = 256.0
END = "_10.png"
"""Of the first picture of a sequence, the one with truth."""


class _Kit(NamedTuple):
    left: str
    right: str
    occ: str
    noc: str
    cameras: str
    projections: tuple[str, str]


_2015 = (_Kit("image_2", "image_3", "disp_occ_0", "disp_noc_0", "calib_cam_to_cam", ("P_rect_02", "P_rect_03")),)
_2012 = (
    _Kit("colored_0", "colored_1", "disp_occ", "disp_noc", "calib", ("P2", "P3")),
    _Kit("image_0", "image_1", "disp_occ", "disp_noc", "calib", ("P0", "P1")),
)


def kitti_2015(root: Path) -> Iterator[StandardPair]:
    """image_2, image_3, disp_occ_0, disp_noc_0, and obj_map, which is 0 in the background."""
    return _pairs(root, _2015)


def kitti_2012(root: Path) -> Iterator[StandardPair]:
    """colored_0 and colored_1, or image_0 and image_1 where there are no others; disp_occ, disp_noc."""
    return _pairs(root, _2012)


def _pairs(root: Path, kits: tuple[_Kit, ...]) -> Iterator[StandardPair]:
    held = {each.path: each.files for each in folders(root)}
    for part in dict.fromkeys(path.parent for path in held):
        kit = next((each for each in kits if part / each.left in held and part / each.right in held), None)
        if kit is None:
            continue
        names = held[part / kit.left] & held[part / kit.right]
        for name in sorted(each for each in names if each.endswith(END)):
            marks = (kit.occ, kit.noc, "obj_map")
            lies = {each: part / each / name for each in marks if name in held.get(part / each, ())}
            text = name.removesuffix(END) + ".txt"
            truth = lies.get(kit.occ)
            yield StandardPair(
                name=name.removesuffix(".png"),
                left=part / kit.left / name,
                right=part / kit.right / name,
                truth=truth,
                truth_scale=None if truth is None else SCALE,
                noc=_mask(lies.get(kit.noc)),
                foreground=_mask(lies.get("obj_map")),
                sparse=True,
                cameras=partial(if_there, kitti_cameras, part / kit.cameras / text, *kit.projections),
                test=part.name == "testing",
            )


def _mask(path: Path | None) -> Mask | None:
    return None if path is None else Mask((path,), "above 0")
