"""The reader of MPI Sintel stereo, as its archive unpacks."""

from collections.abc import Iterator
from pathlib import Path
from typing import Literal

from ..folders import folders
from ..standard_pair import Mask, StandardPair


def sintel(root: Path, variant: Literal["final", "clean"]) -> Iterator[StandardPair]:
    """Yield the pairs of a pass of the film: final, with blur and atmosphere, or clean.

    They are final_left/SCENE/frame_0001.png, and the same names in final_right, disparities, occlusions and outofframe
    (0: seen by both views).
    """
    files_in = {each.path: each.files for each in folders(root)}
    for path in files_in:
        if path.parent.name != f"{variant}_left":
            continue
        top, scene = path.parent.parent, path.name
        parts = {
            name: files_in.get(top / name / scene, frozenset[str]())
            for name in (f"{variant}_right", "disparities", "occlusions", "outofframe")
        }
        for name in sorted(each for each in files_in[path] & parts[f"{variant}_right"] if each.endswith(".png")):
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
