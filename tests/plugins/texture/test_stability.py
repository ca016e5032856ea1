"""Pictures that break segmenters, over every installed texture method: one table of cases, each with a demand.

Exactness is tested in each method's own module; here every pair of case and method gets the same questions.
`SLOW_PEERS`, which the conformance kit asks most of them every day, are asked all of them in the nightly tests.
"""

import subprocess
import sys
from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import numpy as np
import pytest

from tangible_core.data import SegmentMap
from tangible_core.data.pictures import fill_non_finite
from tangible_core.errors import OptionError, PictureError
from tangible_core.plugins.interfaces import Segmenter
from tangible_core.plugins.registry import default_registry
from tangible_core.testing.synthetic.scenes import two_textures
from tangible_core.testing.variants import TINY, coarse_variants, exact_variants

METHODS = [
    each.name
    for each in default_registry().listings
    if (each.kind, each.distribution) == ("texture", "tangible-images")
]
SLOW_PEERS = {"kornia-gabor", "kornia-gradient", "report"}
"""Methods that others replace, and that take nine tenths of the time of all."""
OF_GREY = {"gradient", "hierarchy", "histogram", "kornia-gradient"}
"""The methods that separate by brightness. The others separate by texture, for which a checkerboard is one thing."""
SHAPE = 64, 88
HALF = SHAPE[1] // 2
NUMBERS = ("auto", 1, 2, 7, 1000)


def method(name: str, **options: Any) -> Segmenter:
    return default_registry().load("texture", name)(**options)


def takes(name: str, options: Mapping[str, Any]) -> bool:
    """Return True if a method has these options: not every method has `auto`."""
    try:
        method(name, **options)
    except OptionError:
        return False
    return True


# Pictures


def flat(value: float = 128, shape: tuple[int, ...] = SHAPE) -> np.ndarray:
    return np.full(shape, value, np.uint8)


def one_pixel(row: int, column: int) -> np.ndarray:
    picture = flat()
    picture[row, column] += 1
    return picture


def board(side_px: int) -> np.ndarray:
    rows, columns = np.indices(SHAPE) // side_px
    return np.where((rows + columns) % 2, 210, 40).astype(np.uint8)


def halves(left: float = 60, right: float = 180) -> np.ndarray:
    picture = flat(left)
    picture[:, HALF:] = right
    return picture


def two(shape: tuple[int, int] = (96, 128)) -> np.ndarray:
    return two_textures(shape)[0]


# Demands

Demand = Callable[[SegmentMap, np.ndarray], None]


def well_formed(found: SegmentMap, picture: np.ndarray) -> None:
    """Demand labels 0..n-1 without a gap, int32, contiguous, of the picture's size; confidence in 0..1."""
    labels, confidence = found.labels, found.confidence
    assert labels.shape == confidence.shape == picture.shape[:2]
    assert (labels.dtype, confidence.dtype) == (np.int32, np.float32)
    assert labels.flags.c_contiguous
    assert np.array_equal(np.unique(labels), np.arange(found.count))
    assert np.isfinite(confidence).all()
    assert confidence.min() >= 0
    assert confidence.max() <= 1


def at_most(count: int) -> Demand:
    def demand(found: SegmentMap, picture: np.ndarray) -> None:
        assert found.count <= count

    return demand


def anything(found: SegmentMap, picture: np.ndarray) -> None:
    """Demand nothing beyond `well_formed`."""


class Case(NamedTuple):
    """A picture, and the demands on methods by grey and by texture; every method must give `well_formed`."""

    picture: Callable[[], np.ndarray]
    of_grey: Demand
    of_texture: Demand


ONE = at_most(1)

CASES: dict[str, Case] = {
    "black": Case(lambda: flat(0), ONE, ONE),
    "grey": Case(flat, ONE, ONE),
    "white, colour": Case(lambda: flat(255, (*SHAPE, 3)), ONE, ONE),
    "clear": Case(lambda: flat(0, (*SHAPE, 4)), ONE, ONE),
    "constant of 1e20": Case(lambda: np.full(SHAPE, 1e20), ONE, ONE),
    "constant of 1e-20": Case(lambda: np.full(SHAPE, 1e-20), ONE, ONE),
    "constant and negative": Case(lambda: np.full(SHAPE, -0.3), ONE, ONE),
    "constant but for one pixel": Case(lambda: one_pixel(30, 41), ONE, ONE),
    "constant but for a corner": Case(lambda: one_pixel(0, 0), ONE, ONE),
    "board of pixels": Case(lambda: board(1), ONE, ONE),
    "board of squares": Case(lambda: board(4), anything, ONE),  # to a method by grey each square is a thing
    "two levels": Case(halves, at_most(2), anything),  # to one by texture the step between is a third thing
    "two levels of bool": Case(lambda: halves() > 100, at_most(2), anything),
    "two textures": Case(two, anything, anything),
}

KNOWN_FAILURES: dict[tuple[str, str], str] = {}
"""The reasons of known failures by case and method; the test must then fail."""


def cells() -> list[Any]:
    return [
        pytest.param(
            case,
            name,
            number,
            id=f"{case}-{name}-{number}",
            marks=[
                *(
                    [pytest.mark.xfail(reason=KNOWN_FAILURES[case, name], strict=True)]
                    if (case, name) in KNOWN_FAILURES
                    else []
                ),
                *([pytest.mark.nightly] if name in SLOW_PEERS else []),
            ],
        )
        for case in CASES
        for name in METHODS
        for number in NUMBERS
        if takes(name, {"segments": number})
    ]


@pytest.mark.parametrize(("case", "name", "number"), cells())
def test_case_meets_its_demand(case: str, name: str, number: int | str):
    picture = CASES[case].picture()
    found = method(name, segments=number).segment(picture)
    well_formed(found, picture)
    assert number == "auto" or found.count <= int(number)
    (CASES[case].of_grey if name in OF_GREY else CASES[case].of_texture)(found, picture)


# Demands beyond the table of pictures

by_method = pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.nightly if name in SLOW_PEERS else ()) for name in METHODS]
)
SIZES = (*TINY, (3, 1), (5, 4), (8, 8), (9, 17), (16, 9), (31, 33), (61, 97), (100, 63))


def agreement(one: np.ndarray, other: np.ndarray) -> float:
    """Return the share of pixels on which two label maps agree, each label matched to the one it covers most."""
    table = np.zeros((one.max() + 1, other.max() + 1), np.int64)
    np.add.at(table, (one.ravel(), other.ravel()), 1)
    return min(table.max(axis=0).sum(), table.max(axis=1).sum()) / one.size


@by_method
@pytest.mark.parametrize("shape", SIZES, ids=str)
def test_picture_of_every_size_is_segmented(name: str, shape: tuple[int, int]):
    picture = two(shape)
    for number in NUMBERS:
        if takes(name, {"segments": number}):
            found = method(name, segments=number).segment(picture)
            well_formed(found, picture)
            assert found.count <= (picture[..., 0].size if number == "auto" else number)


@by_method
def test_labels_of_any_kind_of_array_agree(name: str):
    expected = method(name).segment(two()).labels
    for kind, variant in exact_variants(two()):
        assert agreement(method(name).segment(variant).labels, expected) >= 0.99, kind
    for _, variant in coarse_variants(two()):
        well_formed(method(name).segment(variant), variant)


@by_method
@pytest.mark.parametrize("scale", [1e20, 1e-20, 0.5, -1.0])
@pytest.mark.parametrize("offset", [0.0, 0.25])
def test_labels_under_gain_and_offset_agree(name: str, scale: float, offset: float):
    if name == "report" and 0 < scale < 1:
        pytest.xfail("its bounded non-linearity is one of grey levels")
    picture = two() / 255
    changed = (picture + offset) * scale
    assert agreement(method(name).segment(changed).labels, method(name).segment(picture).labels) >= 0.99


@by_method
@pytest.mark.parametrize("upright", [True, False])
def test_borders_do_not_wrap_around(name: str, upright: bool):
    """Pixels at one border get the label of their neighbours, not that of the other border."""
    picture, truth = two_textures((120, 200))
    labels = method(name, segments=2).segment(picture if upright else picture.transpose(1, 0, 2)).labels
    labels = labels if upright else labels.T
    for side, half in ((np.s_[:, :8], truth == 0), (np.s_[:, -8:], truth == 1)):
        own = np.bincount(labels[half]).argmax()
        assert np.mean(labels[side] == own) >= 0.95


@by_method
@pytest.mark.parametrize("value", [np.nan, np.inf, -np.inf])
def test_non_finite_value_is_named_with_its_place_or_filled(name: str, value: float):
    whole = two() / 255
    torn = whole.copy()
    torn[31, 64], torn[40, 7, 1] = value, value
    with pytest.raises(PictureError, match="the first at row 31, column 64"):
        method(name).segment(torn)
    filled, known = fill_non_finite(torn)
    assert np.argwhere(~known).tolist() == [[31, 64], [40, 7]]
    halves = method(name, segments=2)
    assert agreement(halves.segment(filled).labels, halves.segment(whole).labels) >= 0.98


@by_method
def test_picture_given_stays_as_it_is(name: str):
    for picture in (two(), two() / 255, two()[..., 0]):
        before = picture.copy()
        picture.flags.writeable = False
        method(name).segment(picture)
        assert np.array_equal(picture, before)


@by_method
def test_calls_in_parallel_do_not_disturb_each_other(name: str):
    pictures = [two(), two()[::-1].copy(), board(4)] * 2
    alone = [method(name).segment(each).digest() for each in pictures[:3]] * 2
    with ThreadPoolExecutor(3) as pool:
        assert [each.digest() for each in pool.map(method(name).segment, pictures)] == alone


def test_installed_methods_are_listed():
    assert {"gradient", "histogram"} <= set(METHODS)


@pytest.mark.parametrize(
    ("name", "bytes_a_pixel"), [("gabor", 64), ("gradient", 40), ("hierarchy", 40), ("histogram", 50)]
)
def test_memory_stated_is_enough_for_four_megapixels(name: str, bytes_a_pixel: int):
    """The bound holds for grey, above the picture, with 16 MiB for constant parts."""
    script = (
        "import numpy as np; from tangible_bench.memory import start_peak;"
        "from tangible_core.plugins.registry import default_registry as installed;"
        "squares = (np.indices((2000, 2000)) // 250).sum(axis=0) % 2 * 90;"
        "picture = (squares + np.random.default_rng(0).integers(60, 80, squares.shape)).astype(np.uint8); del squares;"
        f"method = installed().load('texture', '{name}')();"
        "method.segment(picture[:300, :400].copy()); peak = start_peak(); found = method.segment(picture);"
        "print(peak(), found.count)"
    )
    printed = subprocess.run([sys.executable, "-c", script], capture_output=True, text=True, check=True).stdout.split()
    assert int(printed[0]) <= bytes_a_pixel * 4_000_000 + (16 << 20)
    assert int(printed[1]) > 1
