"""Checks of a depth estimator."""

from collections.abc import Callable, Iterator

import numpy as np

from ...data import DisparityMap, Views
from ...errors import BrokenMethod, ModelAbsent, PictureError, TangibleError
from ...plugins.interfaces import DepthEstimator
from ..checks import TINY, Check, checks_in, coarse_variants, demand, exact_variants, refuses
from ..synthetic.scenes import wall

WALL_PX = 6.0


def map_is_well_formed(method: DepthEstimator) -> None:
    """Check that disparity and confidence are read-only float32 (h, w) of the left view's size, confidence in 0..1."""
    views = wall(WALL_PX)
    result = method.estimate(views)
    demand(type(result) is DisparityMap, f"estimate returns {type(result).__name__}, not DisparityMap")
    for name, values in (("disparity_px", result.disparity_px), ("confidence", result.confidence)):
        demand(values.dtype == np.float32, f"{name} is {values.dtype}, not float32")
        demand(values.shape == views.shape, f"{name} is {values.shape}, the left view {views.shape}")
        demand(not values.flags.writeable, f"{name} can be written to")
    demand(not np.isinf(result.disparity_px).any(), "a disparity is infinite; write NaN where it is unknown")
    low, high = float(result.confidence.min()), float(result.confidence.max())
    demand(low >= 0 and high <= 1, f"confidence runs from {low:g} to {high:g}, not within 0..1")  # NaN fails too


def wall_is_found(method: DepthEstimator) -> None:
    """Check that a textured wall shifted by 6 px is found: half of it is known, with a median error of 0.5 px at
    most."""
    result = method.estimate(wall(WALL_PX))
    near = result.disparity_px[np.isfinite(result.disparity_px)]
    share = near.size / result.disparity_px.size
    demand(share >= 0.5, f"{share:.0%} of the wall is known; a texture this clear allows at least half")
    # A method for one picture cannot see the shift: its map must lie within 0..1, where 1 is nearest.
    if result.unit == "relative":
        demand(near.min() >= 0 and near.max() <= 1, f"nearness runs from {near.min():g} to {near.max():g}, not 0..1")
        return
    error = float(np.median(np.abs(near - WALL_PX)))
    demand(error <= 0.5, f"the wall is shifted by {WALL_PX:g} px; the median error is {error:.3g} px")


def same_views_same_map(method: DepthEstimator) -> None:
    """Check that two runs on equal views agree to the last bit: results are cached, compared and repeated."""
    views = wall()
    again = Views(np.array(views.left), np.array(views.right))
    first, second = method.estimate(views), type(method)(**dict(method)).estimate(again)
    demand(first.digest() == second.digest(), "two runs on equal views differ; seed what is random")


def views_are_not_written_to(method: DepthEstimator) -> None:
    """Check that the input pictures are not changed: other stages read them too."""
    views = wall()
    pair = np.array(views.left), np.array(views.right)
    before = views.digest()
    method.estimate(Views(*pair))
    demand(Views(*pair).digest() == before, "estimate writes to its input; work on a copy")


def every_picture_type_is_taken(method: DepthEstimator) -> None:
    """Check that 8 and 16 bits, floats, RGBA and any memory layout give nearly the same map."""
    views = wall(WALL_PX)
    first = method.estimate(views)
    for name, pair in _variants(views, exact_variants):
        _demand_agreement(first, method.estimate(pair), name)
    for name, pair in _variants(views, coarse_variants):
        shape = method.estimate(pair).disparity_px.shape
        demand(shape == views.shape, f"{name} pictures of {views.shape} give a map of {shape}")


def any_size_is_taken(method: DepthEstimator) -> None:
    """Check that views of any size, even one pixel, give a map of their size, or a TangibleError with the reason."""
    for shape in TINY:
        try:
            result = method.estimate(wall(1.0, shape))
        except BrokenMethod:
            raise
        except TangibleError:
            continue
        demand(result.disparity_px.shape == shape, f"views of {shape} give a map of {result.disparity_px.shape}")


def flat_pair_claims_nothing(method: DepthEstimator) -> None:
    """Check that at most 5 % of a pair of one colour, which matches at any shift, is known with a confidence above
    0."""
    flat = np.full((64, 160, 3), 128, np.uint8)
    try:
        result = method.estimate(Views(flat, flat.copy()))
    except PictureError:
        return
    demand(not np.isinf(result.disparity_px).any(), "a disparity is infinite; write NaN where it is unknown")
    # A method for one picture claims no shift.
    share = float(np.mean(np.isfinite(result.disparity_px) & (result.confidence > 0)))
    demand(
        result.unit == "relative" or share <= 0.05,
        f"{share:.0%} of a pair without any texture is claimed as known; give NaN or confidence 0",
    )


def one_view_is_answered(method: DepthEstimator) -> None:
    """Check that one view gives a relative map, or else a TangibleError, and that `needs_pair` is true for the
    latter."""
    try:
        result = method.estimate(Views(wall().left))
    except (BrokenMethod, ModelAbsent):
        raise
    except TangibleError as error:
        cure = "if the method needs a pair, write `needs_pair: ClassVar[bool] = True` in its class"
        demand(method.needs_pair, f"it raises without a right view ({error}); {cure}")
        return
    demand(not method.needs_pair, "one view gives a map, though the class has `needs_pair = True`; leave that out")
    demand(result.unit == "relative", "one view gives a map in px; without a second view only relative is known")


def nan_is_refused(method: DepthEstimator) -> None:
    """Check that a picture with NaN raises PictureError and nothing else, before or in the method."""
    left = np.asarray(wall().left / 255, np.float32)
    left[3, 5] = np.nan
    refuses(PictureError, "a picture with NaN", lambda: method.estimate(Views(left, wall().right)))


def _variants(
    views: Views, variants: Callable[[np.ndarray], Iterator[tuple[str, np.ndarray]]]
) -> Iterator[tuple[str, Views]]:
    right = views.left if views.right is None else views.right
    for (name, one), (_, other) in zip(variants(views.left), variants(right), strict=True):
        yield name, Views(one, other)


def _demand_agreement(first: DisparityMap, result: DisparityMap, name: str) -> None:
    finite, again = np.isfinite(first.disparity_px), np.isfinite(result.disparity_px)
    differ = float(np.mean(np.logical_xor(finite, again)))
    demand(differ <= 0.05, f"as {name}, {differ:.0%} of the pixels change between known and unknown")
    both = np.logical_and(finite, again)
    if both.any():
        apart = float(np.median(np.abs(first.disparity_px[both] - result.disparity_px[both])))
        most = 0.02 if first.unit == "relative" else 0.5
        demand(apart <= most, f"as {name}, the median disparity differs by {apart:.3g} ({first.unit})")


CHECKS: tuple[Check, ...] = checks_in(__name__)
