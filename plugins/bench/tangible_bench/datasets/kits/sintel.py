"""MPI Sintel stereo, as its archive unpacks."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Literal

from ..folders import folders
from ..standard_pair import Mask, StandardPair

Variant = Literal["final", "clean"]


def sintel(variant: Variant) -> Callable[[Path], Iterator[StandardPair]]:
    """A pass of the film: final, with blur and atmosphere, or clean."""
    return lambda root: _sintel(root, variant)


def _sintel(root: Path, variant: Variant) -> Iterator[StandardPair]:
    """final_left/SCENE/frame_0001.png and its like in final_right, disparities, occlusions, outofframe (0: seen)."""
    held = {each.path: each.files for each in folders(root)}
    for path in held:
        if path.parent.name != f"{variant}_left":
            continue
        top, scene = path.parent.parent, path.name
        beside = {
            name: held.get(top / name / scene, frozenset[str]())
            for name in (f"{variant}_right", "disparities", "occlusions", "outofframe")
        }
        for name in sorted(each for each in held[path] & beside[f"{variant}_right"] if each.endswith(".png")):
            truth = top / "disparities" / scene / name if name in beside["disparities"] else None
            hidden = [top / each / scene / name for each in ("occlusions", "outofframe") if name in beside[each]]
            yield StandardPair(
                name=f"{scene}/{Path(name).stem}",
                left=path / name,
                right=top / f"{variant}_right" / scene / name,
                truth=truth,
                truth_scale="sintel" if truth else None,
                noc=Mask(tuple(hidden), "at 0") if truth and hidden else None,
                test=top.name == "test",
            )
