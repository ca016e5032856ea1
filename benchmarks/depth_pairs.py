"""The pairs that depth is measured on: scikit-image's, four with analytic truth, and those of TANGIBLE_STEREO."""

import os
from functools import cache
from pathlib import Path
from typing import NamedTuple

import numpy as np

from tangible_bench.tasks.depth import range_px
from tangible_bench.tasks.depth_scenes import DepthScene
from tangible_core.data import Views
from tangible_core.testing.synthetic.stereo_scenes import SCENES, KnownPair
from tangible_depth.search.pairs import Pair, grey_pair

# Environment variable: a folder whose sub-folders hold left.png, right.png and disparity.npz.
FOLDER = "TANGIBLE_STEREO"
LARGE_PX = 300_000  # pixels from which times are promised


class KnownScene(NamedTuple):
    """A pair with its truth, its views in grey, and how many disparities a method that is told its range tries."""

    pair: KnownPair
    grey: Pair
    disparities: int

    @property
    def views(self) -> Views:
        """In grey: what is timed, so that nobody pays for the conversion of colours."""
        return Views(*self.grey)

    @property
    def large(self) -> bool:
        """Whether a time is promised for it."""
        return self.grey.left.size >= LARGE_PX


def known(pair: KnownPair) -> KnownScene:
    """Open a pair: its views, its truth and its masks."""
    return KnownScene(pair, grey_pair(pair.views, "the benchmark"), range_px(pair))


def real_specs() -> dict[str, DepthScene]:
    """Photographs: the builtin pair, and those in the folder that FOLDER names."""
    found = {"motorcycle": DepthScene(builtin="motorcycle")}
    if folder := os.environ.get(FOLDER):
        found |= DepthScene(folder=Path(folder)).expand()
    return found


def synthetic_specs(width_px: int = 480, height_px: int = 360) -> dict[str, DepthScene]:
    """One of each kind."""
    return {
        name: DepthScene.model_validate({"synthetic": name, "width_px": width_px, "height_px": height_px})
        for name in SCENES
    }


@cache
def real() -> dict[str, KnownScene]:
    """Return the photographs, opened."""
    return {name: known(spec.open()) for name, spec in real_specs().items()}


@cache
def synthetic() -> dict[str, KnownScene]:
    """Return the analytic scenes, opened."""
    return {name: known(spec.open()) for name, spec in synthetic_specs().items()}


@cache
def large() -> dict[str, KnownScene]:
    """Those for which times are promised, one analytic scene among them."""
    planes = known(synthetic_specs(1024, 768)["planes"].open())
    return {name: each for name, each in real().items() if each.large} | {"planes 1024x768": planes}


def mean_error(values: dict[str, float]) -> float:
    """Mean over the photographs and, as one more, the mean of the analytic scenes."""
    photographs = [values[name] for name in real_specs()]
    return float(np.mean([*photographs, np.mean([values[name] for name in SCENES])]))
