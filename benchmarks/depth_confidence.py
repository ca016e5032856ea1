"""Whether a map knows where it is wrong: areas under the sparsification curve, against OpenCV's left-right check."""

import numpy as np

from tangible_bench.metrics.standard_sets import WRONG_PX, sparsification_errors
from tangible_bench.tasks.depth import measure
from tangible_depth.dense.confidence import probability
from tangible_depth.opencv_sgbm import OpenCVSGBM
from tangible_depth.semi_global import SemiGlobal

from .depth_pairs import KnownScene, real, synthetic
from .figures import Figure, table

LARGEST_RATIO = 1.25
MAX_OFF = 0.05  # largest difference of a probability and what happens
# Lower ends of ranges of probability; hardly any value is below the second.
EDGES = (0.0, 0.6, 0.7, 0.8, 0.9, 0.95, 0.98)


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
        _reliability(),
    ]


def _reliability() -> Figure:
    """Judge the probability by scene, and over all photographs by ranges of it."""
    shares = {name: _by_probability(scene) for name, scene in {**real(), **synthetic()}.items()}
    off = {name: abs(float(stated.sum() - right.sum())) for name, (_, stated, right) in shares.items()}
    worst = max(off, key=off.__getitem__)
    pixels, stated, right = np.sum([shares[name] for name in real()], axis=0)
    by_range = float(np.abs(stated - right).sum() / pixels.sum())
    return Figure(
        "confidence as a probability of being within 2 px, against the share that is",
        f"within {MAX_OFF:g} on every scene, and in the mean of its ranges",
        f"{off[worst]:.3f} at most ({worst}); {by_range:.3f} in the mean of the ranges, photographs",
        max(off[worst], by_range) <= MAX_OFF,
    )


def rows() -> list[str]:
    """How often a value is over 2 px off, by the probability that its confidence states."""
    kinds = [np.array([_by_probability(each) for each in scenes().values()]) for scenes in (real, synthetic)]
    columns = [f"{what} %, {kind}" for kind in ("photographs", "synthetic") for what in ("pixels", "stated", "right")]
    figures = []
    for i, (low, high) in enumerate(zip(EDGES, (*EDGES[1:], 1.0), strict=True)):
        cells = []
        for each in kinds:
            pixels, stated, right = each[:, :, i].sum(axis=0)
            shares = (pixels / len(each), *(value / max(pixels, 1e-9) for value in (stated, right)))
            cells += [f"{100 * value:.1f}" for value in shares]
        figures.append((f"{low:g} to {high:g}", *cells))
    return table(("probability", *columns), figures)


def _by_probability(scene: KnownScene) -> np.ndarray:
    """Return by range of probability the shares of pixels with truth, of what is stated, and of what is right."""
    found, truth_px = SemiGlobal().estimate(scene.pair.views), scene.pair.truth_px
    measured = np.isfinite(truth_px)
    stated = probability(found.confidence[measured])
    at = np.searchsorted(EDGES, stated, side="right") - 1
    right = np.abs(found.disparity_px - truth_px)[measured] <= WRONG_PX
    return np.stack([np.bincount(at, weights, minlength=len(EDGES)) for weights in (None, stated, right)]) / at.size


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
