"""The standard sets by name: the archive to fetch, the files in its folder, and the reader."""

from collections.abc import Callable, Iterator, Mapping
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from . import kits
from .standard_pair import Resolution, StandardPair

Read = Callable[[Path], Iterator[StandardPair]]


@dataclass(frozen=True)
class StandardSet:
    """A set of pairs, as its makers publish it."""

    title: str
    archive: str
    page: str
    contents: str  # the files in its folder once it is unpacked
    read: Mapping[str, Read]  # variant -> reader; the first variant is the default
    # The sizes of its pairs, the largest first; smaller ones that are not in the folder are made from larger ones.
    sizes: tuple[Resolution, ...] = ()

    @property
    def fetch(self) -> str:
        """The instruction for a set that is missing."""
        return f"fetch {self.archive} from {self.page} and unpack it there, so that it holds {self.contents}"


_MIDDLEBURY = "https://vision.middlebury.edu/stereo"
_KITTI = "https://www.cvlibs.net/datasets/kitti"

SETS: Mapping[str, StandardSet] = {
    "middlebury-2001": StandardSet(
        "Middlebury 2001", "the zip of each scene", f"{_MIDDLEBURY}/data/scenes2001/",
        "NAME/im2.ppm, im6.ppm and disp2.pgm", {"": kits.of_2001},
    ),
    "middlebury-2003": StandardSet(
        "Middlebury 2003", "cones-png-2.zip and teddy-png-2.zip", f"{_MIDDLEBURY}/data/scenes2003/",
        "cones/im2.png, im6.png and disp2.png", {"": kits.of_2003}, ("F", "H", "Q"),
    ),
    "middlebury-2005": StandardSet(
        "Middlebury 2005", "ThirdSize 2-views zip files", f"{_MIDDLEBURY}/data/scenes2005/",
        "ThirdSize/NAME/view1.png, view5.png and disp1.png", {"": kits.of_2005_and_2006}, ("F", "H", "T"),
    ),
    "middlebury-2006": StandardSet(
        "Middlebury 2006", "ThirdSize 2-views zip files", f"{_MIDDLEBURY}/data/scenes2006/",
        "ThirdSize/NAME/view1.png, view5.png and disp1.png", {"": kits.of_2005_and_2006}, ("F", "H", "T"),
    ),
    "middlebury-2014": StandardSet(
        "Middlebury 2014", "NAME-perfect.zip of each scene", f"{_MIDDLEBURY}/data/scenes2014/",
        "NAME-perfect/im0.png, im1.png, disp0.pfm and calib.txt", {"": kits.since_2014}, ("F", "H", "Q"),
    ),
    "middlebury-2021": StandardSet(
        "Middlebury 2021", "all.zip", f"{_MIDDLEBURY}/data/scenes2021/",
        "data/NAME/im0.png, im1.png, disp0.pfm and calib.txt", {"": kits.since_2014}, ("F", "H", "Q"),
    ),
    "middlebury-eval3": StandardSet(
        "Middlebury v3", "MiddEval3-data-Q.zip and MiddEval3-GT0-Q.zip (or -H, -F)", f"{_MIDDLEBURY}/submit3/",
        "trainingQ/NAME/im0.png, im1.png, disp0GT.pfm, mask0nocc.png and calib.txt",
        {"": kits.since_2014}, ("F", "H", "Q"),
    ),
    "kitti-2012": StandardSet(
        "KITTI 2012", "data_stereo_flow.zip", f"{_KITTI}/eval_stereo_flow.php?benchmark=stereo",
        "training/colored_0, colored_1, disp_occ and disp_noc", {"": kits.kitti_2012},
    ),
    "kitti-2015": StandardSet(
        "KITTI 2015", "data_scene_flow.zip (and data_scene_flow_calib.zip for the cameras)",
        f"{_KITTI}/eval_scene_flow.php?benchmark=stereo",
        "training/image_2, image_3, disp_occ_0 and disp_noc_0", {"": kits.kitti_2015},
    ),
    "eth3d": StandardSet(
        "ETH3D two-view", "two_view_training.7z and two_view_training_gt.7z", "https://www.eth3d.net/datasets",
        "NAME/im0.png, im1.png, disp0GT.pfm and mask0nocc.png", {"": kits.eth3d},
    ),
    "sintel": StandardSet(
        "MPI Sintel stereo", "MPI-Sintel-stereo-training-20150305.zip", "http://sintel.is.tue.mpg.de/stereo",
        "training/final_left, final_right, disparities and occlusions",
        {"final": partial(kits.sintel, variant="final"), "clean": partial(kits.sintel, variant="clean")},
    ),
    "booster": StandardSet(
        "Booster", "booster_gt.zip", "https://cvlab-unibo.github.io/booster-web/",
        "train/balanced/SCENE/camera_00, camera_02 and disp_00.npy", {"": kits.booster}, ("F", "H", "Q"),
    ),
}  # fmt: skip
