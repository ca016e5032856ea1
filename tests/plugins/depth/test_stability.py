"""Pairs that break matchers, over every depth method that is shipped: one table of cases, each demanding a bound.

Method by method exactness is tested beside the method; here every cell of cases x methods gets the same questions.
`SLOW_PEERS`, which the conformance kit asks most of them every day, are asked all of them in the nightly tests.
"""

import json
import subprocess
import sys
from collections.abc import Callable, Iterable, Mapping
from concurrent.futures import ThreadPoolExecutor
from functools import cache
from typing import Any, NamedTuple

import numpy as np
import pytest

from tangible_core.data import DisparityMap, Views
from tangible_core.errors import PictureError, TangibleError
from tangible_core.plugins.interfaces import DepthEstimator
from tangible_core.plugins.registry import default_registry
from tangible_core.testing.synthetic.stereo_scenes import KnownPair, synthetic_pair
from tangible_core.testing.synthetic.surfaces import (
    Surface,
    everywhere,
    left_view,
    rectangle,
    right_view,
    slanted_plane,
    true_disparity,
    truly_visible,
)
from tangible_core.testing.variants import exact_variants

SHAPE = 96, 176
PERIOD_PX = 8
HALF = SHAPE[0] // 2
WINDOWS_PX = 12
"""Margin, in pixels, in which a border of texture may affect a map."""
FROM_ONE_PICTURE = ("contour", "luminance")
OTHERS_ANSWERS = ("auto", "onnx")
"""Methods that forward to others, or to the user's network."""
METHODS = [
    each.name
    for each in default_registry().listings
    if (each.kind, each.distribution) == ("depth", "tangible-images") and each.name not in OTHERS_ANSWERS
]
MATCHERS = [name for name in METHODS if name not in FROM_ONE_PICTURE]
SLOW_PEERS = {"kornia-zncc", "kornia-report", "report"}
"""Methods that others replace, and that take nine tenths of the time of all."""


def each_of(names: Iterable[str]) -> list[Any]:
    """Values of a parameter `name`; the slow peers among them are for the nightly tests."""
    return [pytest.param(name, marks=pytest.mark.nightly if name in SLOW_PEERS else ()) for name in names]


def method(name: str, **options: Any) -> DepthEstimator:
    return default_registry().load("depth", name)(**options)


# Scenes


def noise(seed: int, *shape: int) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 256, shape or SHAPE, np.uint8)


def flat(value: float, shape: tuple[int, ...] = SHAPE) -> np.ndarray:
    return np.full(shape, value, np.uint8)


def one_pixel() -> np.ndarray:
    picture = flat(128)
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


def change(scene: Callable[[], KnownPair], left: Callable = lambda z: z, right: Callable | None = None) -> KnownPair:
    known = scene()
    both = left(known.views.left), (right or left)(known.views.right)
    return KnownPair(Views(*both), known.truth_px, known.visible)


def curve(gain: float, gamma: float = 1.0, offset: float = 0.0) -> Callable[[np.ndarray], np.ndarray]:
    return lambda z: np.rint(np.clip(gain * 255 * (z / 255) ** gamma + offset, 0, 255)).astype(np.uint8)


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


# What is demanded

Demand = Callable[[DisparityMap, KnownPair], None]


def well_formed(found: DisparityMap, known: KnownPair) -> None:
    """A map of the views' size; disparities that two columns can have, or nearness in 0..1; confidence in 0..1."""
    disparity, width = found.disparity_px, known.views.shape[1]
    assert disparity.shape == found.confidence.shape == known.views.shape
    assert disparity.dtype == found.confidence.dtype == np.float32
    assert found.confidence.min() >= 0
    assert found.confidence.max() <= 1
    assert not found.confidence[np.isnan(disparity)].any()
    told = disparity[~np.isnan(disparity)]
    lowest, highest = (0, 1) if found.unit == "relative" else (0.5 - width, width - 0.5)
    assert ((lowest <= told) & (told <= highest)).all()


def right(share: float, px: float = 2.0, rows: slice = slice(None)) -> Demand:
    """Claim that this share of the visible pixels at least is within px of the truth; unknown ones are not."""

    def demand(found: DisparityMap, known: KnownPair) -> None:
        near = np.abs(found.disparity_px - known.truth_px) <= px
        assert near[rows][known.visible[rows]].mean() >= share

    return demand


def claims(most: float, over: float = 0.0, rows: slice = slice(None)) -> Demand:
    """Claim that this share of the pixels at most has a confidence above `over`."""

    def demand(found: DisparityMap, known: KnownPair) -> None:
        assert np.mean((np.isfinite(found.disparity_px) & (found.confidence > over))[rows]) <= most

    return demand


def within_px(low: float, high: float) -> Demand:
    """Every disparity that is told lies within what was asked for."""

    def demand(found: DisparityMap, known: KnownPair) -> None:
        told = found.disparity_px[np.isfinite(found.disparity_px)]
        assert ((low - 0.5 <= told) & (told <= high + 0.5)).all()

    return demand


def periodic(start_px: int) -> Demand:
    """Claim that confident disparities align the stripes; a tenth may not, at the borders."""

    def demand(found: DisparityMap, known: KnownPair) -> None:
        told = found.disparity_px[found.confidence > 0.5]
        off = np.abs((told - start_px + PERIOD_PX / 2) % PERIOD_PX - PERIOD_PX / 2)
        assert np.count_nonzero(off > 1) <= 0.1 * told.size

    return demand


def right_or_silent(found: DisparityMap, known: KnownPair) -> None:
    if np.isfinite(found.disparity_px).any():
        right(0.9)(found, known)


def both(one: Demand, other: Demand) -> Demand:
    def demand(found: DisparityMap, known: KnownPair) -> None:
        one(found, known)
        other(found, known)

    return demand


class Case(NamedTuple):
    """A pair, and what is demanded of the methods that match two views; of every one: `well_formed`."""

    pair: Callable[[], KnownPair]
    matched: Demand
    options: Mapping[str, Any] = {}
    """A method that lacks one of these has no such cell."""


LIT, SATURATED = slice(HALF + WINDOWS_PX, None), slice(0, HALF - WINDOWS_PX)
UNSURE = claims(0.1, over=0.5)
HALF_LIT = both(right(0.85, rows=LIT), claims(0.05, over=0.5, rows=SATURATED))

CASES: dict[str, Case] = {
    "planes": Case(planes, right(0.95)),
    "constant": Case(lambda: unknown(flat(128), flat(128)), claims(0)),
    "constant, two shades": Case(lambda: unknown(flat(0), flat(255)), claims(0)),
    "constant, one row": Case(lambda: unknown(flat(9, (1, 60)), flat(9, (1, 60))), claims(0)),
    "constant but for one pixel": Case(lambda: same(one_pixel()), claims(0.05, over=0.1)),
    "constant but for one pixel of one view": Case(lambda: unknown(one_pixel(), flat(128)), claims(0.01)),
    "identical": Case(lambda: same(planes().views.left), right(0.99, 0.5)),
    "identical noise": Case(lambda: same(noise(0)), right(0.99, 0.5)),
    "unrelated noise": Case(lambda: unknown(noise(0), noise(1)), claims(0.02, over=0.5)),
    "upright stripes": Case(lambda: unknown(stripes(0), stripes(3)), periodic(3)),
    "level stripes": Case(lambda: unknown(level_stripes(40), level_stripes(50)), UNSURE),
    "level stripes, not filled": Case(
        lambda: unknown(level_stripes(40), level_stripes(50)), claims(0), {"fill": False}
    ),
    "darker": Case(lambda: change(planes, right=curve(0.8)), right(0.9)),
    "brighter": Case(lambda: change(planes, right=curve(0.9, offset=25)), right(0.95)),
    "gamma": Case(lambda: change(planes, right=curve(1, 1.4)), right(0.9)),
    "dim": Case(lambda: change(planes, curve(0.12)), right(0.95)),
    "black and white": Case(lambda: change(planes, lambda z: z > 127), right(0.85)),
    "floats of 1e20": Case(lambda: change(planes, lambda z: z / 255 * 1e20), right(0.95)),
    "floats of 1e-20": Case(lambda: change(planes, lambda z: z / 255 * 1e-20), right_or_silent),
    "a row lower": Case(lambda: change(planes, right=lambda z: np.vstack([z[:1], z[:-1]])), right(0.9)),
    "cut by the border": Case(border, right(0.95)),
    "huge jump": Case(jump, right(0.95)),
    "exchanged": Case(lambda: mirror(border()), right(0.95)),
    "half saturated": Case(lambda: change(planes, half_white), HALF_LIT),
    "half of one view saturated": Case(lambda: change(planes, right=half_white), HALF_LIT),
    "range over the width": Case(planes, right(0.95), {"max_disparity_px": 500}),
    "negative range": Case(
        lambda: mirror(border()),
        both(right(0.95), within_px(-24, 0)),
        {"min_disparity_px": -24, "max_disparity_px": 1},
    ),
    "range beside the truth": Case(planes, within_px(30, 40), {"min_disparity_px": 30, "max_disparity_px": 40}),
    "1 x 1": Case(lambda: unknown(noise(0, 1, 1), noise(1, 1, 1)), within_px(0, 0)),
    "1 x n": Case(lambda: unknown(noise(0, 1, 80), noise(1, 1, 80)), UNSURE),
    "n x 1": Case(lambda: unknown(noise(0, 80, 1), noise(1, 80, 1)), within_px(0, 0)),
    "narrow": Case(lambda: unknown(noise(0, 60, 7), noise(1, 60, 7)), UNSURE),
    "narrow, wide range": Case(lambda: same(noise(0, 60, 20)), right(0.9, 0.5), {"max_disparity_px": 64}),
}

NOT_KEPT: dict[tuple[str, str], str] = {
    ("exchanged", "opencv-sgbm"): "it searches the disparities that it is told, 0 to 63 px by default",
}
"""Known failures by case and method, with the reason; the cell must then fail."""


def cells() -> list[Any]:
    return [
        pytest.param(
            case,
            name,
            id=f"{case}-{name}",
            marks=[
                *([pytest.mark.xfail(reason=NOT_KEPT[case, name], strict=True)] if (case, name) in NOT_KEPT else []),
                *([pytest.mark.nightly] if name in SLOW_PEERS else []),
            ],
        )
        for case in CASES
        for name in METHODS
        if CASES[case].options.keys() <= default_registry().load("depth", name).model_fields.keys()
    ]


@pytest.mark.parametrize(("case", "name"), cells())
def test_method_on_a_case_keeps_its_bound(case: str, name: str):
    pair, matched, options = CASES[case]
    known = pair()
    found = method(name, **options).estimate(known.views)
    well_formed(found, known)
    assert found.unit == ("relative" if name in FROM_ONE_PICTURE else "px")
    if found.unit == "px":
        matched(found, known)


# What a table of pairs does not hold


@pytest.mark.parametrize("name", each_of(METHODS))
def test_array_layout_hardly_changes_the_map(name: str):
    """8 and 16 bits, floats, RGBA, layouts: all but 1 % of the pixels within a twentieth of a pixel."""
    colour = [np.dstack([grey, 255 - grey // 2, grey // 3]) for grey in (planes().views.left, planes().views.right)]
    expected = method(name).estimate(Views(*colour))
    tolerance = 0.05 if expected.unit == "px" else 0.005
    for (kind, left), (_, right_one) in zip(*map(exact_variants, colour), strict=True):
        found = method(name).estimate(Views(left, right_one))
        close = np.isclose(found.disparity_px, expected.disparity_px, atol=tolerance, rtol=0, equal_nan=True)
        assert close.mean() >= 0.99, kind


@pytest.mark.parametrize(
    "name", each_of(name for name in MATCHERS if name != "opencv-sgbm")
)  # it searches what it is told
def test_exchanged_views_are_reported(name: str, caplog: pytest.LogCaptureFixture):
    method(name).estimate(border().views)
    assert "exchanged" not in caplog.text
    method(name).estimate(mirror(border()).views)
    assert "exchanged" in caplog.text


@pytest.mark.parametrize("name", each_of(MATCHERS))
def test_single_view_is_refused(name: str):
    with pytest.raises(PictureError, match="two views"):
        method(name).estimate(Views(noise(0)))


def test_views_of_two_sizes_are_refused():
    with pytest.raises(TangibleError, match=r"176 x 96.*175 x 96"):
        Views(noise(0), noise(0)[:, 1:])


@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
@pytest.mark.parametrize("side", ["left", "right"])
def test_value_that_is_not_finite_is_refused_with_its_place(value: float, side: str):
    views = {"left": noise(0) / 255, "right": noise(1) / 255}
    views[side][31, 64] = value
    with pytest.raises(PictureError, match=f"{side} view.*row 31, column 64"):
        Views(**views)


@pytest.mark.parametrize("name", each_of(METHODS))
def test_simultaneous_calls_are_independent(name: str):
    pairs = [planes().views, border().views, jump().views] * 2
    alone = [method(name).estimate(each).digest() for each in pairs[:3]] * 2
    with ThreadPoolExecutor(3) as pool:
        assert [each.digest() for each in pool.map(method(name).estimate, pairs)] == alone


@pytest.mark.parametrize(
    "names",
    [
        pytest.param([name for name in METHODS if name not in SLOW_PEERS], id="quick"),
        pytest.param(sorted(SLOW_PEERS), id="slow", marks=pytest.mark.nightly),
    ],
)
def test_every_process_gives_the_same_maps(names: list[str]):
    script = (
        "import json; from tangible_core.plugins.registry import default_registry as installed;"
        "from tangible_core.testing.synthetic.stereo_scenes import synthetic_pair;"
        f"views = synthetic_pair('planes', {SHAPE[1]}, {SHAPE[0]}, 1).views;"
        f"maps = {{n: installed().load('depth', n)().estimate(views).digest() for n in {names}}};"
        "print(json.dumps(maps))"
    )
    other = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout
    assert json.loads(other) == {name: method(name).estimate(planes().views).digest() for name in names}


@pytest.mark.parametrize("name", ["semi-global", "zncc"])
def test_stated_memory_is_enough_for_five_megapixels(name: str):
    """40 bytes a pixel above the pictures, and 256 MiB for the volumes of the strips at work."""
    script = (
        "import numpy as np; from tangible_bench.memory import start_peak; from tangible_core.data import Views;"
        "from tangible_core.plugins.registry import default_registry as installed;"
        "wide = np.random.default_rng(0).integers(0, 256, (1944, 2692), np.uint8);"
        "left, right = (np.ascontiguousarray(wide[:, a : a + 2592]) for a in (20, 60));"
        f"method = installed().load('depth', '{name}')(max_disparity_px=64);"
        "method.estimate(Views(left[:200, :300], right[:200, :300])); del wide; peak = start_peak();"
        "found = method.estimate(Views(left, right)); print(peak());"
        "print(np.mean(np.abs(found.disparity_px[:, 40:] - 40) <= 1))"
    )
    said = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout.split()
    assert int(said[0]) <= 40 * 2592 * 1944 + (256 << 20)
    assert float(said[1]) >= 0.99
