"""The task for depth methods: errors of disparity, over all pixels and over the pixels that both views show."""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace

import numpy as np

from tangible_core.data import DisparityMap, Views
from tangible_core.errors import PictureError
from tangible_core.metrics import disparity_errors
from tangible_core.plugins import DepthEstimator
from tangible_core.scene import fill_rows
from tangible_core.testing.synthetic import KnownPair

from ..datasets import MarkedPair
from ..metrics.standard_sets import LEFT, LEFT_BY_ORACLE, benchmark_errors, sparsification_errors
from . import damage
from .depth_scenes import DepthScene, scene_size
from .task import Curve, Measure, Perturbation, Task

NOC, FULL = "_noc", "_full"
STEP_PX = 16
# The range for a pair without known truth and range: the largest disparity in KITTI's files, pixels.
UNKNOWN_RANGE_PX = 256
Pair = KnownPair | MarkedPair
QUANTILES = (50, 90, 95, 99)
IN_PIXELS = (
    *(f"bad{bound:g}" for bound in (0.5, 1, 2, 4)), "average_px", "rms_px", *(f"a{share}_px" for share in QUANTILES),
)  # fmt: skip
"""Measures that depend on the size of a pixel; sets in several sizes count pixels of the largest."""


def estimate(method: DepthEstimator, pair: Pair) -> DisparityMap:
    """Run the timed call."""
    return method.estimate(pair.views)


def measure(disparity: DisparityMap, pair: Pair) -> dict[str, float]:
    """Return the errors over all pixels with truth, and (`_noc`) over those that the right view shows too.

    Raises: PictureError if the disparity is relative, as it has no unit to compare.
    """
    if disparity.unit != "px":
        raise PictureError(f"the disparity is {disparity.unit}, not in px; it cannot be compared with the ground truth")
    if isinstance(pair, MarkedPair):
        return _benchmark_measures(disparity.disparity_px, pair)
    everywhere = disparity_errors(disparity.disparity_px, pair.truth_px)
    both = disparity_errors(disparity.disparity_px, np.where(pair.visible, pair.truth_px, np.float32(np.nan)))
    sorted_out = sparsification_errors(disparity.disparity_px, disparity.confidence, pair.truth_px)
    return everywhere | {f"{name}{NOC}": value for name, value in both.items()} | sorted_out


def _benchmark_measures(disparity_px: np.ndarray, pair: MarkedPair) -> dict[str, float]:
    """Return a benchmark's measures, with estimates clipped to the range of its set, as Middlebury's kit does."""
    if pair.truth_px is None:
        return {}
    if pair.most_px is not None:
        disparity_px = np.clip(disparity_px, 0, pair.most_px)
    measures: dict[str, float] = {}
    for end, part in (("", None), (NOC, pair.noc)):
        if part is None and end:
            continue
        truth_px = pair.truth_px if part is None else np.where(part, pair.truth_px, np.float32(np.nan))
        figures = disparity_errors(disparity_px, truth_px) | benchmark_errors(disparity_px, truth_px, pair.foreground)
        if pair.full_px is not None:
            by = np.float32(pair.full_px)
            whole = disparity_errors(by * disparity_px, by * truth_px)
            whole |= benchmark_errors(by * disparity_px, by * truth_px)
            figures |= {f"{name}{FULL}": whole[name] for name in IN_PIXELS}
        measures |= {f"{name}{end}": value for name, value in figures.items()}
    return measures


def range_px(pair: Pair) -> int:
    """Return the smallest multiple of 16 above every disparity, as OpenCV and most matchers count their range."""
    if isinstance(pair, MarkedPair) and pair.most_px is not None:
        return STEP_PX * math.ceil(pair.most_px / STEP_PX)
    if pair.truth_px is None or not np.isfinite(pair.truth_px).any():
        return UNKNOWN_RANGE_PX
    return STEP_PX * (int(np.nanmax(pair.truth_px)) // STEP_PX + 1)


def doubt(method: DepthEstimator, pair: Pair) -> str:
    """Return a sentence if the range of a method ends below the truth, as a wrong default does; else nothing."""
    limit_px = method.model_dump().get("max_disparity_px")
    if pair.truth_px is None or not isinstance(limit_px, int) or not np.isfinite(pair.truth_px).any():
        return ""
    beyond = 100 * float((pair.truth_px[np.isfinite(pair.truth_px)] >= limit_px).mean())
    if not beyond:
        return ""
    return (
        f"max_disparity_px {limit_px} is below the truth of {beyond:.1f} % of the pixels, which count as wrong; "
        f"write `max_disparity_px: {range_px(pair)}`, or `given: [max_disparity_px]`"
    )


def fill(disparity: DisparityMap) -> DisparityMap:
    """Fill holes from the background in their row (`geometry.fill_rows`); a map without any value stays as it is."""
    if np.isnan(disparity.disparity_px).all():
        return disparity
    return replace(disparity, disparity_px=fill_rows(disparity.disparity_px))


def _both(change: Callable[[np.ndarray, float, int], np.ndarray]) -> Callable[[Pair, float], Pair]:
    """Return a perturbation that damages both views in the same way, with another seed for each."""

    def apply(pair: Pair, value: float) -> Pair:
        left, right = (change(view, value, seed) for seed, view in enumerate(_views(pair)))
        return replace(pair, views=Views(left, right, pair.views.calibration))

    return apply


def _right(change: Callable[[np.ndarray, float], np.ndarray]) -> Callable[[Pair, float], Pair]:
    """Return a perturbation that damages the right view alone, as if the two cameras disagreed."""

    def apply(pair: Pair, value: float) -> Pair:
        left, right = _views(pair)
        return replace(pair, views=Views(left, change(right, value), pair.views.calibration))

    return apply


def _views(pair: Pair) -> tuple[np.ndarray, np.ndarray]:
    assert pair.views.right is not None  # DepthScene opens pairs only
    return pair.views.left, pair.views.right


PERTURBATIONS: Mapping[str, Perturbation] = {
    "noise": Perturbation(
        "standard deviation in grey levels of 255, both views, above 0", lambda sd: 0 < sd <= 255, _both(damage.noise)
    ),
    "gain": Perturbation("factor on the right view, above 0", lambda factor: 0 < factor <= 10, _right(damage.gain)),
    "gamma": Perturbation("exponent on the right view, above 0", lambda power: 0 < power <= 10, _right(damage.gamma)),
    "jpeg": Perturbation(
        "quality 1 to 100, both views",
        lambda quality: 1 <= quality <= 100,
        _both(lambda view, quality, seed: damage.jpeg(view, quality)),
    ),
    "blur": Perturbation(
        "sigma in pixels, both views, above 0",
        lambda sigma: 0 < sigma <= 100,
        _both(lambda view, sigma, seed: damage.blur(view, sigma)),
    ),
    "shift": Perturbation("rows by which the right view is too low", math.isfinite, _right(damage.shift_down)),
}


def _measures() -> dict[str, Measure]:
    errors = {
        **{f"bad{limit_px:g}": Measure(f"bad{limit_px:g} %", at_size=True) for limit_px in (0.5, 1, 2, 4)},
        "average_px": Measure("average px", 3, tolerance=0.0005),
        "rms_px": Measure("rms px", 3, tolerance=0.0005),
        "density": Measure("density %", 1, "high"),
    }
    sorted_out = {
        "ausc": Measure("sparsification %", 3, tolerance=0.0005),
        "ausc_by_oracle": Measure("sparsification / oracle"),
    }
    quantiles = {f"a{share}_px": Measure(f"A{share} px", 3, tolerance=0.0005, of_sets=True) for share in QUANTILES}
    titles = {"invalid": "invalid", "bad3": "bad3", "d1": "D1-all", "d1_bg": "D1-bg", "d1_fg": "D1-fg"}
    of_sets = quantiles | {name: Measure(f"{title} %", of_sets=True) for name, title in titles.items()}
    return _with_noc(errors) | sorted_out | _with_noc(of_sets | _at_full_size(errors | of_sets))


def _at_full_size(all_measures: Mapping[str, Measure]) -> dict[str, Measure]:
    measures: dict[str, Measure] = {}
    for name in IN_PIXELS:
        what, _, unit = all_measures[name].title.partition(" ")
        measures[f"{name}{FULL}"] = replace(all_measures[name], title=f"{what}@F {unit}", at_size=False, of_sets=True)
    return measures


def _with_noc(measures: Mapping[str, Measure]) -> dict[str, Measure]:
    of_noc = {
        f"{name}{NOC}": replace(figure, title=figure.title.replace(" ", " noc ")) for name, figure in measures.items()
    }
    return {**measures, **of_noc}


TASK = Task(
    kind="depth",
    version=3,
    scene=DepthScene,
    work=estimate,
    measure=measure,
    measures=_measures(),
    columns=("bad2", "bad2_noc", "bad1", "average_px", "density"),
    plot_measures=("bad2", "bad2_noc", "ausc"),
    curve=Curve("wrong among those left (bad2), %", "least confident pixels removed, %", LEFT, LEFT_BY_ORACLE),
    perturbations=PERTURBATIONS,
    facts={"max_disparity_px": range_px},
    finishes={"fill": fill},
    doubt=doubt,
    scene_size=scene_size,
)
