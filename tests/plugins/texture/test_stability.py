"""Pictures that break segmenters: with a failure here a method finds segments where there are none, or loses some."""

from collections.abc import Callable, Mapping
from concurrent.futures import ThreadPoolExecutor
from typing import Any, NamedTuple

import numpy as np
import pytest

from label_maps import rand_index
from tangible_core import load_method
from tangible_core.data import SegmentMap
from tangible_core.errors import OptionError
from tangible_core.plugins.interfaces import Segmenter
from tangible_core.plugins.registry import default_registry
from tangible_core.testing.checks import exact_variants
from tangible_core.testing.synthetic.scenes import two_textures

METHODS = [
    listing.name
    for listing in default_registry().listings
    if (listing.kind, listing.distribution) == ("texture", "tangible-images")
]
SLOW_PEERS = {"kornia-gabor", "kornia-gradient", "report"}
"""Methods that others replace, and that take nine tenths of the time of all: in the nightly tests."""
OF_GREY = {"gradient", "hierarchy", "histogram", "kornia-gradient"}
"""The methods that separate by brightness. The others separate by texture, for which a checkerboard is one thing."""
SHAPE = 64, 88
NUMBERS = ("auto", 1, 2, 7, 1000)

by_method = pytest.mark.parametrize(
    "name", [pytest.param(name, marks=pytest.mark.nightly if name in SLOW_PEERS else ()) for name in METHODS]
)


def made(name: str, **options: Any) -> Segmenter | None:
    """Return a method; None if it has no such options: not every one has `auto`."""
    try:
        return load_method("texture", name)(**options)
    except OptionError:
        return None


# Pictures


def one_pixel(row: int, column: int) -> np.ndarray:
    picture = np.full(SHAPE, 128, np.uint8)
    picture[row, column] += 1
    return picture


def board(side_px: int) -> np.ndarray:
    rows, columns = np.indices(SHAPE) // side_px
    return np.where((rows + columns) % 2, 210, 40).astype(np.uint8)


def halves() -> np.ndarray:
    return np.where(np.indices(SHAPE)[1] < SHAPE[1] // 2, 60, 180).astype(np.uint8)


def two(shape: tuple[int, int] = (96, 128)) -> np.ndarray:
    return two_textures(shape)[0]


class Case(NamedTuple):
    """A picture, and the most segments that methods by grey and by texture may find; every map is `well_formed`."""

    picture: Callable[[], np.ndarray]
    of_grey: int
    of_texture: int


ANY = 1 << 30
CASES: Mapping[str, Case] = {
    "clear": Case(lambda: np.zeros((*SHAPE, 4), np.uint8), 1, 1),
    "constant of 1e20": Case(lambda: np.full(SHAPE, 1e20), 1, 1),
    "constant and negative": Case(lambda: np.full(SHAPE, -0.3), 1, 1),
    "constant but for one pixel": Case(lambda: one_pixel(30, 41), 1, 1),
    "constant but for a corner": Case(lambda: one_pixel(0, 0), 1, 1),
    "board of pixels": Case(lambda: board(1), 1, 1),
    "board of squares": Case(lambda: board(4), ANY, 1),  # to a method by grey each square is a thing
    "two levels": Case(halves, 2, ANY),  # to one by texture the step between is a third thing
    "two levels of bool": Case(lambda: halves() > 100, 2, ANY),
    "two textures": Case(two, ANY, ANY),
    "one row": Case(lambda: two((1, 17)), ANY, ANY),
    "few pixels": Case(lambda: two((5, 4)), ANY, ANY),
    "odd sides": Case(lambda: two((61, 97)), ANY, ANY),
}


def well_formed(found: SegmentMap, picture: np.ndarray) -> None:
    """Labels 0..n-1 without a gap, int32, contiguous, of the picture's size; confidence in 0..1."""
    labels, confidence = found.labels, found.confidence
    assert labels.shape == confidence.shape == picture.shape[:2]
    assert (labels.dtype, confidence.dtype) == (np.int32, np.float32)
    assert labels.flags.c_contiguous
    assert np.array_equal(np.unique(labels), np.arange(found.count))
    assert 0 <= confidence.min() <= confidence.max() <= 1


@by_method
@pytest.mark.parametrize("case", CASES)
def test_case_meets_its_demand(case: str, name: str):
    picture, of_grey, of_texture = CASES[case]
    for number in NUMBERS:
        method = made(name, segments=number)
        if method is not None:
            found = method.segment(picture())
            well_formed(found, picture())
            assert number == "auto" or found.count <= int(number)
            assert found.count <= (of_grey if name in OF_GREY else of_texture)


@by_method
def test_labels_under_gain_offset_and_any_kind_of_array_agree(name: str):
    method = load_method("texture", name)()
    expected = method.segment(two()).labels
    changed = [((two() / 255 + offset) * scale) for scale, offset in ((1e20, 0), (1e-20, 0.25), (-1, 0.25))]
    if name == "flat":  # by colours as they are seen, whose differences another gain makes larger or smaller
        changed = []
    for picture in [*changed, *(variant for _, variant in exact_variants(two()))]:
        assert rand_index(method.segment(picture).labels, expected) >= 0.98


@by_method
@pytest.mark.parametrize("upright", [True, False])
def test_borders_do_not_wrap_around(name: str, upright: bool):
    picture, truth = two_textures((120, 200))
    labels = load_method("texture", name)(segments=2).segment(picture if upright else picture.transpose(1, 0, 2)).labels
    labels = labels if upright else labels.T
    for side, half in ((np.s_[:, :8], truth == 0), (np.s_[:, -8:], truth == 1)):
        own = np.bincount(labels[half]).argmax()
        assert np.mean(labels[side] == own) >= 0.95


@by_method
def test_calls_in_parallel_do_not_disturb_each_other(name: str):
    method = load_method("texture", name)()
    pictures = [two(), two()[::-1].copy(), board(4)] * 2
    alone = [method.segment(picture).digest() for picture in pictures[:3]] * 2
    with ThreadPoolExecutor(3) as pool:
        assert [each.digest() for each in pool.map(method.segment, pictures)] == alone
