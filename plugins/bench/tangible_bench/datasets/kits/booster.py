"""Booster's balanced pairs, as its archives unpack: both views of one size."""

from collections.abc import Iterator
from pathlib import Path

from ..folders import folders
from ..standard_pair import Mask, StandardPair

LEFT, RIGHT, TRUTH, NOC = "camera_00", "camera_02", "disp_00.npy", "mask_00.png"


def booster(root: Path) -> Iterator[StandardPair]:
    """SCENE/camera_00/im0.png and its like in camera_02 (one a lamp); disp_00.npy, 0 unknown; mask_00.png, 0 hidden."""
    found = list(folders(root))
    held = {each.path: each.files for each in found}
    for scene, within, files in found:
        if "unbalanced" in within or scene / LEFT not in held:
            continue
        lit = held[scene / LEFT] & held.get(scene / RIGHT, frozenset[str]())
        for name in sorted(each for each in lit if each.endswith(".png")):
            yield StandardPair(
                name=f"{scene.name}/{Path(name).stem}",
                left=scene / LEFT / name,
                right=scene / RIGHT / name,
                truth=scene / TRUTH if TRUTH in files else None,
                truth_scale=1.0 if TRUTH in files else None,
                noc=Mask((scene / NOC,), "above 0") if {TRUTH, NOC} <= files else None,
                resolution="F",
                test=TRUTH not in files and "test" in within,
            )
