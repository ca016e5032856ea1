"""How depth methods are compared: disparity against the truth, over all pixels and over those that both views show."""

import math
from collections.abc import Callable, Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from ..data import DisparityMap, Views
from ..errors import PictureError
from ..metrics import disparity_errors
from ..plugins.interfaces import DepthEstimator
from ..scene.geometry import fill_rows
from ..synthetic.stereo_scenes import KnownPair
from . import damage
from .depth_scenes import DepthScene
from .task import Measure, Perturbation, Task

NOC = "_noc"
STEP_PX = 16


def estimate(method: DepthEstimator, pair: KnownPair) -> DisparityMap:
    """What is timed."""
    return method.estimate(pair.views)


def measure(found: DisparityMap, pair: KnownPair) -> dict[str, float]:
    """Errors over all pixels with truth, and (`_noc`) over those of them that the right view shows too.

    Raises: PictureError if the disparity is relative: it has no unit to compare.
    """
    if found.unit != "px":
        raise PictureError(f"the disparity is {found.unit}, not in px; it cannot be compared with the ground truth")
    everywhere = disparity_errors(found.disparity_px, pair.truth_px)
    both = disparity_errors(found.disparity_px, np.where(pair.visible, pair.truth_px, np.float32(np.nan)))
    return everywhere | {f"{name}{NOC}": value for name, value in both.items()}


def range_px(pair: KnownPair) -> int:
    """The smallest multiple of 16 above every true disparity, as OpenCV and most matchers count their range."""
    return STEP_PX * (int(np.nanmax(pair.truth_px)) // STEP_PX + 1)


def fill(found: DisparityMap) -> DisparityMap:
    """Holes filled from the background in their row (`geometry.fill_rows`); a map without any value stays as it is."""
    if np.isnan(found.disparity_px).all():
        return found
    return replace(found, disparity_px=fill_rows(found.disparity_px))


def _both(change: Callable[[np.ndarray, float, int], np.ndarray]) -> Callable[[KnownPair, float], KnownPair]:
    """The same damage to both views, with another seed for each."""

    def apply(pair: KnownPair, value: float) -> KnownPair:
        left, right = (change(view, value, seed) for seed, view in enumerate(_views(pair)))
        return replace(pair, views=Views(left, right, pair.views.calibration))

    return apply


def _right(change: Callable[[np.ndarray, float], np.ndarray]) -> Callable[[KnownPair, float], KnownPair]:
    """A damage to the right view alone: the two cameras disagree."""

    def apply(pair: KnownPair, value: float) -> KnownPair:
        left, right = _views(pair)
        return replace(pair, views=Views(left, change(right, value), pair.views.calibration))

    return apply


def _views(pair: KnownPair) -> tuple[np.ndarray, np.ndarray]:
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
        **{f"bad{bound:g}": Measure(f"bad{bound:g} %") for bound in (0.5, 1, 2, 4)},
        "average_px": Measure("average px", 3, tolerance=0.0005),
        "rms_px": Measure("rms px", 3, tolerance=0.0005),
        "density": Measure("density %", 1, "high"),
    }
    hidden: dict[str, Any] = {
        f"{name}{NOC}": replace(each, title=each.title.replace(" ", " noc ")) for name, each in errors.items()
    }
    return errors | hidden


TASK = Task(
    kind="depth",
    version=1,
    scene=DepthScene,
    work=estimate,
    measure=measure,
    measures=_measures(),
    columns=("bad2", "bad2_noc", "bad1", "average_px", "density"),
    plotted=("bad2", "bad2_noc"),
    perturbations=PERTURBATIONS,
    given={"max_disparity_px": range_px},
    finishes={"fill": fill},
)
