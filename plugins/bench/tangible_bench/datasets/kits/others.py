"""The readers of ETH3D (the truth next to the pictures, or in its own folder), MPI Sintel stereo and Booster."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Literal

from ..cameras import if_there, middlebury_cameras
from ..folders import folders
from ..standard_pair import Mask, StandardPair

ETH3D_TRUTH, ETH3D_NOC = "disp0GT.pfm", "mask0nocc.png"


def eth3d(root: Path) -> Iterator[StandardPair]:
    """Yield the pairs of NAME/im0.png, im1.png, calib.txt.

    The truth is NAME/disp0GT.pfm (infinite: unknown), the mask NAME/mask0nocc.png (255: both views).
    """
    listed = list(folders(root))
    truths = {each.path.name: each for each in reversed(listed) if ETH3D_TRUTH in each.files}
    for each in listed:
        if not each.has("im0.png", "im1.png"):
            continue
        truth = truths.get(each.path.name)
        masked = truth is not None and ETH3D_NOC in truth.files
        yield StandardPair(
            name=each.path.name,
            left=each.path / "im0.png",
            right=each.path / "im1.png",
            truth=truth and truth.path / ETH3D_TRUTH,
            noc=Mask((truth.path / ETH3D_NOC,), "at 255") if truth is not None and masked else None,
            sparse=True,
            cameras=partial(if_there, middlebury_cameras, each.path / "calib.txt"),
            test=truth is None and not {"two_view_test", "test"}.isdisjoint(each.within),
        )


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


def sintel(root: Path, variant: Literal["final", "clean"]) -> Iterator[StandardPair]:
    """Yield the pairs of a pass of the film: final, with blur and atmosphere, or clean.

    They are final_left/SCENE/frame_0001.png, and the same names in final_right, disparities, occlusions and outofframe
    (0: seen by both views).
    """
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
            hidden = [top / each / scene / name for each in ("occlusions", "outofframe") if name in parts[each]]
            yield StandardPair(
                name=f"{scene}/{Path(name).stem}",
                left=path / name,
                right=top / f"{variant}_right" / scene / name,
                truth=truth,
                truth_scale="sintel" if truth else None,
                noc=Mask(tuple(hidden), "at 0") if truth and hidden else None,
                test=top.name == "test",
            )
