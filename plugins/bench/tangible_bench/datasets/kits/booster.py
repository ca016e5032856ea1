"""The reader of Booster's balanced pairs, whose views have the same size, as its archives unpack."""

from collections.abc import Iterator
from pathlib import Path

from ..folders import folders
from ..standard_pair import Mask, StandardPair

LEFT, RIGHT, TRUTH, NOC = "camera_00", "camera_02", "disp_00.npy", "mask_00.png"


def booster(root: Path) -> Iterator[StandardPair]:
    """Yield the pairs of SCENE/camera_00/im0.png (an image for each lamp), with the same name in camera_02.

    The truth is disp_00.npy (0: unknown), the mask mask_00.png (0: hidden).
    """
    listed = list(folders(root))
    files_in = {each.path: each.files for each in listed}
    for scene, within, files in listed:
        if "unbalanced" in within or scene / LEFT not in files_in:
            continue
        lit = files_in[scene / LEFT] & files_in.get(scene / RIGHT, frozenset[str]())
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
