"""Whether a map knows where it is wrong: areas under the sparsification curve, against OpenCV's left-right check."""

import numpy as np

from tangible_bench.tasks.depth import measure
from tangible_core.metrics import sparsification_errors
from tangible_core.metrics.sparsification import WRONG_PX
from tangible_depth.opencv_sgbm import OpenCVSGBM
from tangible_depth.semi_global import SemiGlobal

from .depth_pairs import KnownScene, real, synthetic
from .figures import Figure, table

LARGEST_RATIO = 1.25
EDGES = (0.0, 0.02, 0.04, 0.06, 0.1, 0.3, 0.4, 0.5, 0.6)
"""Lower ends of ranges of confidence: a filled value has at most 0.1, a matched one mostly 0.2 or more."""


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


def rows() -> list[str]:
    """How often a value is over 2 px off, by its confidence: what a number between 0 and 1 means."""
    kinds = [np.array([_by_confidence(each) for each in scenes().values()]) for scenes in (real, synthetic)]
    columns = "pixels %, photographs", "of these wrong %", "pixels %, synthetic", "of these wrong %"
    figures = []
    for i, (low, high) in enumerate(zip(EDGES, (*EDGES[1:], 1.0), strict=True)):
        shares = [each[:, :, i].sum(axis=0) for each in kinds]
        cells = [
            f"{100 * value:.1f}"
            for (pixels, wrong), each in zip(shares, kinds, strict=True)
            for value in (pixels / len(each), wrong / max(pixels, 1e-9))
        ]
        figures.append((f"{low:g} to {high:g}", *cells))
    return table(("confidence", *columns), figures)


def _by_confidence(scene: KnownScene) -> np.ndarray:
    """Return the shares of pixels with truth by range of confidence, and the shares of those that are wrong too."""
    found, truth_px = SemiGlobal().estimate(scene.pair.views), scene.pair.truth_px
    measured = np.isfinite(truth_px)
    at = np.searchsorted(EDGES, found.confidence[measured], side="right") - 1
    wrong = ~(np.abs(found.disparity_px - truth_px)[measured] <= WRONG_PX)
    return np.stack([np.bincount(at, weights, minlength=len(EDGES)) for weights in (None, wrong)]) / at.size


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
