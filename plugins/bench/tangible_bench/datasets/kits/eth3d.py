"""The reader of ETH3D's pairs, as its archives unpack: the truth next to the pictures, or in its own folder."""

from collections.abc import Iterator
from functools import partial
from pathlib import Path

from ..cameras import if_there, middlebury_cameras
from ..folders import folders
from ..standard_pair import Mask, StandardPair

TRUTH, NOC = "disp0GT.pfm", "mask0nocc.png"


def eth3d(root: Path) -> Iterator[StandardPair]:
    """Yield the pairs of NAME/im0.png, im1.png, calib.txt.

    The truth is NAME/disp0GT.pfm (infinite: unknown), the mask NAME/mask0nocc.png (255: both views).
    """
    listed = list(folders(root))
    truths = {each.path.name: each for each in reversed(listed) if TRUTH in each.files}
    for each in listed:
        if not each.has("im0.png", "im1.png"):
            continue
        truth = truths.get(each.path.name)
        masked = truth is not None and NOC in truth.files
        yield StandardPair(
            name=each.path.name,
            left=each.path / "im0.png",
            right=each.path / "im1.png",
            truth=truth and truth.path / TRUTH,
            noc=Mask((truth.path / NOC,), "at 255") if truth is not None and masked else None,
            sparse=True,
            cameras=partial(if_there, middlebury_cameras, each.path / "calib.txt"),
            test=truth is None and not {"two_view_test", "test"}.isdisjoint(each.within),
        )
