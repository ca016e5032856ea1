"""Whether a map knows where it is wrong: areas under the sparsification curve, against OpenCV's left-right check."""

import numpy as np

from tangible_bench.tasks.depth import measure
from tangible_core.metrics import sparsification_errors
from tangible_depth.opencv_sgbm import OpenCVSGBM
from tangible_depth.semi_global import SemiGlobal

from .depth_pairs import KnownScene, real, synthetic
from .figures import Figure

LARGEST_RATIO = 1.25


def figures() -> list[Figure]:
    """Area against the oracle's, and against that of OpenCV's second pass: for its own map, and for ours."""
    areas = {name: _areas(scene) for name, scene in {**real(), **synthetic()}.items()}
    by_oracle = {name: ours["ausc_by_oracle"] for name, (ours, _, _) in areas.items()}
    by_peer = {name: ours["ausc"] / peer["ausc"] for name, (ours, peer, _) in areas.items()}
    by_same = {name: ours["ausc"] / same["ausc"] for name, (ours, _, same) in areas.items()}
    return [
        _figure("the oracle's", by_oracle, LARGEST_RATIO),
        _figure("that of OpenCV's map (3WAY, filled) by its second pass", by_peer, 1),
        _figure("that of the same map by OpenCV's second pass", by_same, 1),
    ]


def _areas(scene: KnownScene) -> tuple[dict[str, float], ...]:
    """Of ours, of OpenCV's filled map by its second pass, and of our map by OpenCV's second pass."""
    ours = SemiGlobal().estimate(scene.pair.views)
    peer = OpenCVSGBM(max_disparity_px=scene.disparities, fill=True).estimate(scene.pair.views)
    same = sparsification_errors(ours.disparity_px, peer.confidence, scene.pair.truth_px)
    return measure(ours, scene.pair), measure(peer, scene.pair), same


def _figure(what: str, ratios: dict[str, float], most: float) -> Figure:
    worst = max(ratios, key=ratios.__getitem__)
    return Figure(
        f"confidence, area under the sparsification curve over {what}",
        f"<= {most:g} x on every scene",
        f"median {np.median(list(ratios.values())):.2f} x, worst {ratios[worst]:.2f} x ({worst})",
        ratios[worst] <= most,
    )
