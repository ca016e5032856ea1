"""What a pair does not need and is left out: the time that saves, and the error it adds, each by its switch."""

from collections.abc import Callable, Iterator
from functools import partial
from typing import NamedTuple

import numpy as np

from tangible_core.data import DisparityMap, Views
from tangible_core.metrics import disparity_errors
from tangible_core.scene.scaling import felt_factor, in_pixels_of, on_grid, reduce_views
from tangible_depth.opencv_sgbm import OpenCVSGBM
from tangible_depth.rectify.rectification import rectify
from tangible_depth.semi_global import SemiGlobal

from .depth_pairs import KnownScene, real
from .figures import table
from .turns import in_turns


class Skip(NamedTuple):
    """A thing left out: how to have it so, how not, and the true disparity."""

    what: str
    switch: str
    without: Callable[[], DisparityMap]
    whole: Callable[[], DisparityMap]
    truth_px: np.ndarray


def rows() -> list[str]:
    """Return a row a skip, on the builtin pair."""
    return table(
        ("left out", "switch", "time of all of it, ms", "time saved", "bad2 with all of it", "error added, points"),
        [_row(each) for each in skips(real()["motorcycle"])],
    )


def _row(skip: Skip) -> tuple[str, ...]:
    times = in_turns({"whole": skip.whole, "without": skip.without}, 7)
    bad = [disparity_errors(call().disparity_px, skip.truth_px)["bad2"] for call in (skip.whole, skip.without)]
    saved = 100 * (1 - times["without"].ratio)
    return (
        skip.what,
        skip.switch,
        f"{1e3 * times['whole'].seconds:.0f}",
        f"{saved:.0f} %",
        f"{bad[0]:.2f}",
        f"{bad[1] - bad[0]:+.2f}",
    )


def skips(scene: KnownScene) -> Iterator[Skip]:
    """All of them; where the pair does need the thing, a pair that does not."""
    pair, views, told = scene.pair, scene.views, scene.disparities

    def found(views: Views, **options: object) -> Callable[[], DisparityMap]:
        return partial(SemiGlobal.model_validate(options).estimate, views)

    def other(what: str, switch: str, less: dict[str, object], more: dict[str, object]) -> Skip:
        return Skip(what, switch, found(views, **less), found(views, **more), pair.truth_px)

    flat, flat_truth_px = _half_flat(scene)
    same, still_px = Views(views.left, views.left), np.zeros(views.shape, np.float32)
    peer = OpenCVSGBM(max_disparity_px=told, fill=True)
    once = peer.model_copy(update={"second_pass": False})
    levels = {"cost": "levels", "realign_rows": False}
    best: dict[str, object] = {"effort": "best"}
    yield other("disparities outside the range found", "`max_disparity_px`: auto, 256", {}, {"max_disparity_px": 256})
    yield other("the trial of costs and rows", "`cost`: levels, auto; `realign_rows`", levels, {})
    yield other("the comparison of grey levels", "`cost`: sharp, auto", {"cost": "sharp"}, {})
    yield other("what the best effort adds", "`effort`: balanced, best", {}, best)
    yield other("the strict check from the right", "`check`: soft, strict", {}, {"check": "strict"})
    yield other("full resolution", "`resolution`: half, full", {"resolution": "half"}, {"resolution": "full"})
    yield Skip(
        "pixels finer than the device resolves, on a surface 10 mm wide",
        "`workspace: finest_m`: 0.03 mm, 0",
        partial(_felt, views, 30e-6),
        partial(_felt, views, 0.0),
        pair.truth_px,
    )
    yield Skip(
        "rectification of a rectified pair",
        "`tolerance_px` of `rectify`: 0.35, 0",
        partial(_rectified, views, 0.35),
        partial(_rectified, views, 0.0),
        pair.truth_px,
    )
    yield Skip(
        "a second view identical to the first",
        "`skip_identical`",
        found(same),
        found(same, skip_identical=False),
        still_px,
    )
    yield Skip(
        "strips without texture, half the picture",
        "`skip_flat`",
        found(flat, max_disparity_px=told),
        found(flat, max_disparity_px=told, skip_flat=False),
        flat_truth_px,
    )
    yield Skip(
        "colour: grey in place of each channel by itself, the median of three",
        "the views given",
        found(pair.views),
        partial(_each_channel, pair.views),
        pair.truth_px,
    )
    yield Skip(
        "the pass from the right view, `opencv-sgbm`",
        "`second_pass`",
        partial(once.estimate, views),
        partial(peer.estimate, views),
        pair.truth_px,
    )


def _felt(views: Views, finest_m: float) -> DisparityMap:
    factor = felt_factor(views.shape[1], 0.01, finest_m)
    disparity = SemiGlobal().estimate(reduce_views(views, factor))
    return on_grid(in_pixels_of(disparity, views.shape[1]), views.shape)


def _rectified(views: Views, tolerance_px: float) -> DisparityMap:
    turned = rectify(views, tolerance_px)
    return turned.to_original(SemiGlobal().estimate(turned.views))


def _half_flat(scene: KnownScene) -> tuple[Views, np.ndarray]:
    """Return the pair with grey paper over the lower half, of which nothing is known."""
    middle = scene.grey.left.shape[0] // 2
    left, right = (np.where(np.arange(len(each))[:, None] < middle, each, np.uint8(128)) for each in scene.grey)
    truth_px = scene.pair.truth_px.copy()
    truth_px[middle:] = np.nan
    return Views(left, right), truth_px


def _each_channel(views: Views) -> DisparityMap:
    """Match each of the three channels, and return the middle value of each pixel."""
    assert views.right is not None
    left, right = views.left, views.right
    channels = [SemiGlobal().estimate(Views(left[..., i], right[..., i])).disparity_px for i in range(3)]
    return DisparityMap(np.median(channels, axis=0).astype(np.float32))
