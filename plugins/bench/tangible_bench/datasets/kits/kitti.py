"""The readers of KITTI 2012 and 2015, as their archives unpack: disparities as uint16, 256 a pixel, 0 unknown."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import NamedTuple

from ..cameras import if_there, kitti_cameras
from ..folders import folders
from ..standard_pair import Mask, StandardPair

SCALE = 256.0
END = "_10.png"
"""The end of the name of a sequence's picture that has a truth."""


class _Layout(NamedTuple):
    left: str
    right: str
    occ: str
    noc: str
    cameras: str
    projections: tuple[str, str]


_2015 = (_Layout("image_2", "image_3", "disp_occ_0", "disp_noc_0", "calib_cam_to_cam", ("P_rect_02", "P_rect_03")),)
_2012 = (
    _Layout("colored_0", "colored_1", "disp_occ", "disp_noc", "calib", ("P2", "P3")),
    _Layout("image_0", "image_1", "disp_occ", "disp_noc", "calib", ("P0", "P1")),
)


def kitti_2015(root: Path) -> Iterator[StandardPair]:
    """Yield the pairs of image_2, image_3, disp_occ_0, disp_noc_0, and obj_map (0: background)."""
    return _pairs(root, _2015)


def kitti_2012(root: Path) -> Iterator[StandardPair]:
    """Yield the pairs of colored_0 and colored_1 (or else image_0 and image_1), disp_occ, disp_noc."""
    return _pairs(root, _2012)


def _pairs(root: Path, layouts: tuple[_Layout, ...]) -> Iterator[StandardPair]:
    files_in = {folder.path: folder.files for folder in folders(root)}
    for part in dict.fromkeys(path.parent for path in files_in):
        layout = next(
            (each for each in layouts if part / each.left in files_in and part / each.right in files_in), None
        )
        if layout is None:
            continue
        names = files_in[part / layout.left] & files_in[part / layout.right]
        for name in sorted(each for each in names if each.endswith(END)):
            maps = (layout.occ, layout.noc, "obj_map")
            paths = {each: part / each / name for each in maps if name in files_in.get(part / each, ())}
            text = name.removesuffix(END) + ".txt"
            truth = paths.get(layout.occ)
            yield StandardPair(
                name=name.removesuffix(".png"),
                left=part / layout.left / name,
                right=part / layout.right / name,
                truth=truth,
                truth_scale=None if truth is None else SCALE,
                noc=_mask(paths.get(layout.noc)),
                foreground=_mask(paths.get("obj_map")),
                sparse=True,
                cameras=partial(if_there, kitti_cameras, part / layout.cameras / text, *layout.projections),
                test=part.name == "testing",
            )


def _mask(path: Path | None) -> Mask | None:
    return None if path is None else Mask((path,), "above 0")
