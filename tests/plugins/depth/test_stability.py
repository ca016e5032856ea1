"""Pairs that break matchers: with a failure here a depth method claims what is not there, or misses what is."""

from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest

from tangible_core import load_method
from tangible_core.data import DisparityMap, Views
from tangible_core.errors import PictureError
from tangible_core.plugins.registry import default_registry
from tangible_core.testing.synthetic.stereo_scenes import (
    KnownPair,
    Surface,
    everywhere,
    left_view,
    rectangle,
    right_view,
    slanted_plane,
    synthetic_pair,
    true_disparity,
    truly_visible,
)

SHAPE = 96, 176
PERIOD_PX = 8
HALF = SHAPE[0] // 2
WINDOWS_PX = 12
"""Margin, in pixels, in which a border of texture may affect a map."""
FROM_ONE_PICTURE = ("cues", "luminance")
OTHERS_ANSWERS = ("auto", "onnx")
"""Methods that forward to others, or to the user's network."""
METHODS = [
    listing.name
    for listing in default_registry().listings
    if (listing.kind, listing.distribution) == ("depth", "tangible-images") and listing.name not in OTHERS_ANSWERS
]
SLOW_PEERS = {"kornia-zncc", "kornia-report", "report"}
"""Methods that others replace, and that take nine tenths of the time of all: in the nightly tests."""


def noise(seed: int, *shape: int) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 256, shape or SHAPE, np.uint8)


def one_pixel() -> np.ndarray:
    picture = np.full(SHAPE, 128, np.uint8)
    picture[48, 88] = 255
    return picture


def stripes(start_px: int) -> np.ndarray:
    """Upright, PERIOD_PX apart."""
    row = np.where((np.arange(SHAPE[1]) + start_px) % PERIOD_PX < PERIOD_PX // 2, 40, 210).astype(np.uint8)
    return np.tile(row, (SHAPE[0], 1))


def level_stripes(dark: int) -> np.ndarray:
    """The same anywhere along a row."""
    column = np.where(np.arange(SHAPE[0]) % PERIOD_PX < PERIOD_PX // 2, dark, 210).astype(np.uint8)
    return np.tile(column[:, None], (1, SHAPE[1]))


def render(*surfaces: Surface) -> KnownPair:
    left, right = (np.rint(np.clip(view(surfaces, SHAPE), 0, 255)).astype(np.uint8) for view in (left_view, right_view))
    truth = true_disparity(surfaces, SHAPE).astype(np.float32)
    return KnownPair(Views(left, right), truth, truly_visible(surfaces, SHAPE))


@cache
def planes() -> KnownPair:
    """Slanted planes, 3.5 to 22 px."""
    return synthetic_pair("planes", SHAPE[1], SHAPE[0], 1)


@cache
def border() -> KnownPair:
    """Near objects cut by the left and right borders of the pictures."""
    return render(
        slanted_plane(1, everywhere, 4),
        slanted_plane(2, rectangle(-99, 20, 30, 70), 18),
        slanted_plane(3, rectangle(145, 30, 999, 80), 16),
    )


@cache
def jump() -> KnownPair:
    """A third of the width between the depths of two things."""
    return render(slanted_plane(4, everywhere, 2), slanted_plane(5, rectangle(90, 16, 160, 80), 58))


def change(left: Callable = lambda z: z, right: Callable | None = None) -> KnownPair:
    known = planes()
    both = left(known.views.left), (right or left)(known.views.right)
    return KnownPair(Views(*both), known.truth_px, known.visible)


def curve(gain: float, gamma: float = 1.0) -> Callable[[np.ndarray], np.ndarray]:
    return lambda z: np.rint(np.clip(gain * 255 * (z / 255) ** gamma, 0, 255)).astype(np.uint8)


def half_white(picture: np.ndarray) -> np.ndarray:
    picture = picture.copy()
    picture[:HALF] = 255
    return picture


def mirror(known: KnownPair) -> KnownPair:
    """Both views turned left for right: all disparities are negative, as when the views are exchanged."""
    views = Views(known.views.left[:, ::-1], known.views.right[:, ::-1])
    return KnownPair(views, -known.truth_px[:, ::-1], known.visible[:, ::-1])


def same(picture: np.ndarray) -> KnownPair:
    shape = picture.shape[:2]
    return KnownPair(Views(picture, picture.copy()), np.zeros(shape, np.float32), np.ones(shape, np.bool_))


def unknown(left: np.ndarray, right: np.ndarray) -> KnownPair:
    """A pair of which nothing is true."""
    shape = left.shape[:2]
    return KnownPair(Views(left, right), np.full(shape, np.nan, np.float32), np.zeros(shape, np.bool_))


Demand = Callable[[DisparityMap, KnownPair], bool]


def well_formed(found: DisparityMap, known: KnownPair) -> None:
    """A map of the views' size; disparities that two columns can have, or nearness in 0..1; confidence in 0..1."""
    disparity, width = found.disparity_px, known.views.shape[1]
    assert disparity.shape == found.confidence.shape == known.views.shape
    assert found.confidence.min() >= 0
    assert found.confidence.max() <= 1
    assert not found.confidence[np.isnan(disparity)].any()
    told = disparity[~np.isnan(disparity)]
    lowest, highest = (0, 1) if found.unit == "relative" else (0.5 - width, width - 0.5)
    assert ((lowest <= told) & (told <= highest)).all()


def right(share: float, px: float = 2.0, rows: slice = slice(None)) -> Demand:
    """This share of the visible pixels at least is within px of the truth; unknown ones are not."""
    return lambda found, known: (
        (np.abs(found.disparity_px - known.truth_px) <= px)[rows][known.visible[rows]].mean() >= share
    )


def claims(most: float, over: float = 0.0, rows: slice = slice(None)) -> Demand:
    """This share of the pixels at most has a confidence above `over`."""
    return lambda found, _: np.mean((np.isfinite(found.disparity_px) & (found.confidence > over))[rows]) <= most


def within_px(low: float, high: float) -> Demand:
    """Every disparity that is told lies within what was asked for."""

    def demand(found: DisparityMap, _: KnownPair) -> bool:
        told = found.disparity_px[np.isfinite(found.disparity_px)]
        return bool(((low - 0.5 <= told) & (told <= high + 0.5)).all())

    return demand


def periodic(found: DisparityMap, _: KnownPair) -> bool:
    """Confident disparities align stripes three columns apart; a tenth may not, at the borders."""
    told = found.disparity_px[found.confidence > 0.5]
    off = np.abs((told - 3 + PERIOD_PX / 2) % PERIOD_PX - PERIOD_PX / 2)
    return np.count_nonzero(off > 1) <= 0.1 * told.size


class Case(NamedTuple):
    """A pair, and what is demanded of the methods that match two views; of every one: `well_formed`."""

    pair: Callable[[], KnownPair]
    demands: tuple[Demand, ...]
    options: Mapping[str, Any] = {}
    """A method that lacks one of these has no such cell."""


HALF_LIT = right(0.85, rows=slice(HALF + WINDOWS_PX, None)), claims(0.05, over=0.5, rows=slice(HALF - WINDOWS_PX))

CASES: dict[str, Case] = {
    "planes": Case(planes, (right(0.95),)),
    "constant but for one pixel of one view": Case(
        lambda: unknown(one_pixel(), np.full(SHAPE, 128, np.uint8)), (claims(0.01),)
    ),
    "identical noise": Case(lambda: same(noise(0)), (right(0.99, 0.5),)),
    "unrelated noise": Case(lambda: unknown(noise(0), noise(1)), (claims(0.02, over=0.5),)),
    "upright stripes": Case(lambda: unknown(stripes(0), stripes(3)), (periodic,)),
    "level stripes": Case(lambda: unknown(level_stripes(40), level_stripes(50)), (claims(0.1, over=0.5),)),
    "level stripes, not filled": Case(
        lambda: unknown(level_stripes(40), level_stripes(50)), (claims(0),), {"fill": False}
    ),
    "darker": Case(lambda: change(right=curve(0.8)), (right(0.9),)),
    "gamma": Case(lambda: change(right=curve(1, 1.4)), (right(0.9),)),
    "dim": Case(lambda: change(curve(0.12)), (right(0.95),)),
    "black and white": Case(lambda: change(lambda z: z > 127), (right(0.85),)),
    "floats of 1e20": Case(lambda: change(lambda z: z / 255 * 1e20), (right(0.95),)),
    "a row lower": Case(lambda: change(right=lambda z: np.vstack([z[:1], z[:-1]])), (right(0.9),)),
    "cut by the border": Case(border, (right(0.95),)),
    "huge jump": Case(jump, (right(0.95),)),
    "exchanged": Case(lambda: mirror(border()), (right(0.95),)),
    "half of one view saturated": Case(lambda: change(right=half_white), HALF_LIT),
    "range over the width": Case(planes, (right(0.95),), {"max_disparity_px": 500}),
    "negative range": Case(
        lambda: mirror(border()), (right(0.95), within_px(-24, 0)), {"min_disparity_px": -24, "max_disparity_px": 1}
    ),
    "range beside the truth": Case(planes, (within_px(30, 40),), {"min_disparity_px": 30, "max_disparity_px": 40}),
    "n x 1": Case(lambda: unknown(noise(0, 80, 1), noise(1, 80, 1)), (within_px(0, 0),)),
    "narrow, wide range": Case(lambda: same(noise(0, 60, 20)), (right(0.9, 0.5),), {"max_disparity_px": 64}),
}

NOT_KEPT = {("exchanged", "opencv-sgbm")}
"""It searches the disparities that it is told, 0 to 63 px by default."""


@pytest.mark.parametrize(
    "name", [pytest.param(each, marks=pytest.mark.nightly if each in SLOW_PEERS else ()) for each in METHODS]
)
@pytest.mark.parametrize("case", CASES)
def test_method_on_a_case_keeps_its_bound(case: str, name: str):
    pair, demands, options = CASES[case]
    cls = load_method("depth", name)
    if not options.keys() <= cls.model_fields.keys() or (case, name) in NOT_KEPT:
        return
    known = pair()
    try:
        found = cls(**options).estimate(known.views)
    except PictureError:
        assert name == "cues"  # refuses a picture in which nothing stands on a ground
        return
    well_formed(found, known)
    assert found.unit == ("relative" if name in FROM_ONE_PICTURE else "px")
    assert found.unit == "relative" or all(demand(found, known) for demand in demands)


@pytest.mark.parametrize("name", ["semi-global", "zncc", "opencv-sgbm", "luminance"])
def test_simultaneous_calls_are_independent(name: str):
    method = load_method("depth", name)()
    pairs = [planes().views, border().views, jump().views] * 2
    alone = [method.estimate(pair).digest() for pair in pairs[:3]] * 2
    with ThreadPoolExecutor(3) as pool:
        assert [each.digest() for each in pool.map(method.estimate, pairs)] == alone
