"""The range to search and its bands: else near things are missed, or a search takes long."""

import logging

import numpy as np
import pytest

from semi_global_plainly import plain_disparity, plain_sums
from stereo_scenes import step
from tangible_core.data import Views
from tangible_depth import SemiGlobal
from tangible_depth.dense.confidence import flat_pixels
from tangible_depth.dense.span import UNKNOWN, Span
from tangible_depth.search import bands
from tangible_depth.search import disparity_range as module
from tangible_depth.search.bands import (
    COUNT,
    FEWEST_LANES,
    FINE_WIDTH,
    HIGH_PX,
    RADIUS,
    TALL,
    Bands,
    match_bands,
    sweep_columns,
)
from tangible_depth.search.disparity_range import FIRST_WIDTH, RangeEstimate, find_disparity_range, find_range
from tangible_depth.search.pairs import Pair, grey_pair
from tangible_depth.sgm.costs import BLOCK, SHARP, census

PAIR = Pair.of(*np.zeros((2, 8, 500), np.uint8))


def bands_of(disparity_px: np.ndarray, factor: int = 1) -> Bands:
    """Return bands of these disparities of the picture, between unknown ones."""
    sixteenths = np.rint(16 * disparity_px / factor).astype(np.int16)
    return Bands(np.arange(1), np.insert(sixteenths, 0, UNKNOWN)[None], factor, disparity_px.size, 0.0)


def estimated(monkeypatch: pytest.MonkeyPatch, span: Span | None, swapped: bool = False, found: Bands | None = None):
    """Let the bands give this range."""
    estimate = None if span is None else RangeEstimate(span, found or bands_of(np.zeros(1)), swapped)
    monkeypatch.setattr(module, "find_range", lambda pair: estimate)


@pytest.mark.parametrize(
    ("least", "most", "span"),
    [(3, 10, Span(3, 9)), ("auto", 10, Span(0, 9)), (-9, -2, Span(-9, -3)), (-900, 900, Span(-499, 499))],
)
def test_given_range_ends_before_its_upper_end(least: int | str, most: int, span: Span):
    found = find_disparity_range(PAIR, least, most)
    assert (found.span, found.bands, found.notes) == (span, None, ())


@pytest.mark.parametrize(
    ("least", "estimate", "span"),
    [
        ("auto", Span(2, 20), Span(2, 33)),
        (-5, Span(2, 20), Span(-5, 26)),
        (30, Span(2, 20), Span(30, 45)),
        (5, Span(2, 20), Span(5, 20)),
    ],
)
def test_estimated_range_fills_its_lanes_from_the_lower_end(least, estimate: Span, span: Span, monkeypatch):
    estimated(monkeypatch, estimate)
    assert find_disparity_range(PAIR, least, "auto").span == span


def test_range_of_exchanged_views_ends_at_zero_and_that_without_matches_is_the_default(monkeypatch: pytest.MonkeyPatch):
    estimated(monkeypatch, Span(-40, 3), swapped=True)
    found = find_disparity_range(PAIR, "auto", "auto")
    assert found.span == Span(-40, 0)
    (said, level), (outside, _) = found.notes
    assert said.startswith("every disparity is negative") and level == logging.WARNING
    assert outside == (
        "skipped: disparities outside -40..0 px, as none was found up to 400 px; for nearer things write "
        "`max_disparity_px`"
    )
    estimated(monkeypatch, None)
    found = find_disparity_range(PAIR, "auto", "auto")
    assert (found.span, len(found.notes)) == (Span(0, 191), 1)


@pytest.mark.parametrize("factor", [1, 2])
def test_verified_range_goes_on_by_steps_while_a_hundredth_of_the_matches_lies_there(factor: int, monkeypatch):
    """Verified are 20..52 px; steps have 8 px, and 2 of 200 matches are enough: 2 lie before 60, 68 and 76 px."""
    near = np.concatenate([np.full(190, 30.0), [53, 59, 60, 67, 68, 75, 76, 13, 14, 5]])
    estimated(monkeypatch, Span(-99, 99), found=bands_of(near, factor))
    span = find_disparity_range(PAIR, "auto", "auto", (20, 52)).span
    assert span == Span(4, 4 + 96 - 1)


@pytest.mark.parametrize(("verified", "span"), [((-50, 190), Span(-80, 220)), ((-10, 200), Span(-36, 226))])
def test_wide_verified_range_is_not_filled_up(verified: tuple[int, int], span: Span, monkeypatch):
    """A step is an eighth of the verified range, and lies beside it even where nothing matches."""
    estimated(monkeypatch, Span(0, 0))
    assert find_disparity_range(PAIR, "auto", "auto", verified).span == span


WIDE_PAIR = Pair.of(*np.zeros((2, 8, 1000), np.uint8))


def bands_in_sixteenths(sixteenths: np.ndarray, factor: int = 1, loss: float = 0.0) -> Bands:
    """Return bands of these disparities."""
    known = np.count_nonzero(sixteenths != UNKNOWN)
    return Bands(np.arange(len(sixteenths)), sixteenths.astype(np.int16), factor, known, loss)


@pytest.mark.parametrize(("factor", "span"), [(1, Span(1 - 2, 7 + 2)), (3, Span(3 - 6, 19 + 6))])
def test_range_leaves_out_stray_matches_and_has_a_margin_in_pixels_of_the_copy(factor: int, span: Span, monkeypatch):
    """Of 4000 matches two at either end; those left are at 1.0625 to 6.25 px of the copy."""
    values = np.full(4000, 50)
    values[:6], values[-6:] = [-900, -800, 17, 17, 17, 18], [99, 100, 100, 100, 3000, 4000]
    monkeypatch.setattr(module, "match_bands", lambda *_: bands_in_sixteenths(values.reshape(40, 100), factor))
    assert module._range_of_bands(WIDE_PAIR, Span(0, 9), 80, 2).span == span


@pytest.mark.parametrize(
    ("low_px", "high_px", "swapped"), [(-2.0, 1, False), (-2.1, 1, True), (-2.1, 1.1, False), (-9, -5, True)]
)
def test_views_are_exchanged_where_no_disparity_is_above_one(low_px: float, high_px: float, swapped: bool, monkeypatch):
    values = np.rint(16 * np.array([[low_px, high_px]]))
    monkeypatch.setattr(module, "match_bands", lambda *_: bands_in_sixteenths(values))
    assert module._range_of_bands(WIDE_PAIR, Span(-9, 9), 80, 2).is_swapped == swapped


def find(first: RangeEstimate | None, fine: RangeEstimate | None, monkeypatch: pytest.MonkeyPatch):
    """Find the range of two copies; return it, and what each was asked."""
    asked = []

    def look(pair: Pair, span: Span, width: int, margin: int) -> RangeEstimate | None:
        asked.append((span, width, margin))
        return first if width == FIRST_WIDTH else fine

    monkeypatch.setattr(module, "_range_of_bands", look)
    return find_range(WIDE_PAIR), asked


def test_fine_copy_tries_an_eighth_of_the_width_at_least(monkeypatch: pytest.MonkeyPatch):
    nothing = bands_in_sixteenths(np.zeros((1, 1)))
    for high, tried in ((40, 115), (300, 300)):
        fine = RangeEstimate(Span(0, 20), nothing, False)
        found, asked = find(RangeEstimate(Span(-10, high), nothing, False), fine, monkeypatch)
        assert found is fine
        coarse = [(Span(-360, 360), FIRST_WIDTH, 1), (Span(-800, 800), FIRST_WIDTH, 1)]
        assert asked == [*coarse, (Span(-10, tried), FINE_WIDTH, 2)]


@pytest.mark.parametrize(("revealed", "wider"), [(14, False), (15, True)])
@pytest.mark.parametrize("side", [-1, 1])
def test_wider_search_counts_where_it_alone_matches_enough(revealed: int, wider: bool, side: int, monkeypatch):
    """Of 1000 matches 15 are beyond 360 px where the first search matched nothing; what it matched does not count."""
    near, far = np.full((1, 1000), 16 * 5), np.full((1, 1000), 16 * 5)
    far[0, :200] = 16 * 500 * side
    near[0, :revealed] = UNKNOWN
    estimates = {
        360: RangeEstimate(Span(3, 7), bands_in_sixteenths(near), False),
        800: RangeEstimate(Span(-510, 510), bands_in_sixteenths(far), False),
    }
    asked = []

    def look(pair: Pair, span: Span, width: int, margin: int) -> RangeEstimate | None:
        asked.append(span)
        return estimates[span.high] if width == FIRST_WIDTH else None

    monkeypatch.setattr(module, "_range_of_bands", look)
    assert find_range(WIDE_PAIR) is estimates[800 if wider else 360]


@pytest.mark.parametrize("share", [0.4, 0.62])
@pytest.mark.parametrize("exchanged", [False, True])
def test_thing_at_half_the_width_of_disparity_is_found(share: float, exchanged: bool):
    random = np.random.default_rng(0)
    left = random.integers(0, 128, (120, 240), np.uint8)
    right = np.roll(left, -4, axis=1)
    away = round(share * 240)
    left[30:90, 180:220] = right[30:90, 180 - away : 220 - away] = random.integers(128, 256, (60, 40), np.uint8)
    views = (right, left) if exchanged else (left, right)
    found = SemiGlobal(rectify="never").estimate(Views(*views)).disparity_px
    if exchanged:
        assert np.median(found[35:85, 185 - away : 215 - away]) == pytest.approx(-away, abs=0.5)
    else:
        assert np.median(found[35:85, 185:215]) == pytest.approx(away, abs=0.5)
    assert abs(np.median(found[5:25])) == pytest.approx(4, abs=0.5)


@pytest.mark.parametrize(("loss", "span", "swapped"), [(0.59, Span(0, 20), True), (0.6, Span(-10, 20), False)])
def test_first_copy_counts_as_well_where_the_fine_one_is_noisy(loss: float, span: Span, swapped: bool, monkeypatch):
    fine = RangeEstimate(Span(0, 20), bands_in_sixteenths(np.zeros((1, 1)), loss=loss), True)
    first = RangeEstimate(Span(-10, 9), bands_in_sixteenths(np.zeros((1, 1))), False)
    found, _ = find(first, fine, monkeypatch)
    assert (found.span, found.is_swapped, found.bands) == (span, swapped, fine.bands)


def noise(*shape: int) -> Pair:
    """Return a pair without any structure."""
    return Pair.of(*np.random.default_rng(0).integers(0, 256, (2, *shape), np.uint8))


@pytest.mark.parametrize(("width", "span", "factor"), [(100, 256, 1), (100, 257, 2), (1280, 64, 1), (1281, 64, 2)])
def test_columns_are_averaged_until_width_and_range_are_small_enough(width: int, span: int, factor: int):
    found = match_bands(noise(16, width), Span(0, span - 1))
    assert (found.factor, found.disparity.shape) == (factor, (COUNT, -(-width // factor)))


@pytest.mark.parametrize("factor", [1, 2, 3])
@pytest.mark.parametrize("middle", [-9, 0, 5, 18, 30])
def test_rows_of_a_band_are_means_with_the_edge_repeated(factor: int, middle: int):
    view = np.random.default_rng(1).integers(0, 256, (20, 37), np.uint8)
    columns = -(-37 // factor)
    means = np.zeros(columns + -columns % BLOCK + 2 * RADIUS, np.uint8)
    bands._average_rows(view, middle, factor, columns, np.empty(columns * factor, np.int32), means)
    rows = view[np.clip(np.arange(middle - 1, middle + 2), 0, 19)].astype(int)
    whole = np.pad(rows, ((0, 0), (0, columns * factor - 37)), mode="edge").reshape(HIGH_PX, columns, factor)
    expected = np.floor(whole.sum(axis=(0, 2)) / (HIGH_PX * factor) + 0.5)
    assert np.array_equal(means, np.pad(expected, (RADIUS, means.size - columns - RADIUS), mode="edge"))


def test_specks_and_flat_columns_are_counted(monkeypatch: pytest.MonkeyPatch):
    random = np.random.default_rng(2)
    for _ in range(20):
        band = np.repeat(random.integers(0, 3, (TALL, 12)), 6, axis=1).astype(np.uint8)
        band[random.integers(0, TALL), random.integers(0, 72)] += 1
        flat = np.empty(72 - 2 * RADIUS, np.bool_)
        bands._find_flat_columns(band, flat)
        assert np.array_equal(flat, flat_pixels(band)[RADIUS, RADIUS:-RADIUS])
    left = np.random.default_rng(0).integers(0, 256, (64, 90), np.uint8)
    pair = Pair.of(left, np.roll(left, -3, axis=1))
    monkeypatch.setattr(bands, "remove_speckles", lambda *_: 0)
    whole = match_bands(pair, Span(0, 15))
    assert whole.loss == 0
    monkeypatch.setattr(bands, "remove_speckles", lambda *_: 300)
    found = match_bands(pair, Span(0, 15))
    assert (found.match_count, found.loss) == (whole.match_count - 300, 300 / whole.match_count)


@pytest.mark.parametrize("factor", [2, 3])
@pytest.mark.parametrize("shape", [(8, 12), (7, 11), (1, 5), (9, 2)])
def test_smaller_pair_has_means_with_the_edge_repeated(factor: int, shape: tuple[int, int]):
    left, right = np.random.default_rng(0).integers(0, 256, (2, *shape), np.uint8)
    found = Pair.of(left, right).downsample(factor)
    for one, other in zip(found, (left, right), strict=True):
        whole = np.pad(other, [(0, -side % factor) for side in shape], mode="edge").astype(float)
        means = whole.reshape(len(whole) // factor, factor, -1, factor).mean(axis=(1, 3))
        assert np.abs(one - means).max() <= 0.5


def test_exchanged_or_brightened_pair_has_the_same_disparity():
    """A place is at 3 in the left view and at 1 in the right one; mirrored in five columns, at 3 in the first."""
    left, right = np.zeros((2, 1, 5), np.uint8)
    left[0, 3] = right[0, 1] = 9
    found = Pair.of(left, right).exchange()
    assert (found.left.tolist(), found.right.tolist()) == ([[0, 0, 0, 9, 0]], [[0, 9, 0, 0, 0]])
    assert found.left.flags.c_contiguous
    left, right = np.array([[0.0, 1 / 3]]), np.array([[1 / 9, 0.0]])
    found = grey_pair(Views(left, right), "test")
    assert (found.left.tolist(), found.right.tolist()) == ([[0, 170]], [[57, 0]])
    found = grey_pair(Views(np.array([[-0.5, 0.5]]), np.array([[-0.25, 0.25]])), "test")
    assert (found.left.tolist(), found.right.tolist()) == ([[0, 255]], [[64, 191]])


def pair(kind: str, shape: tuple[int, int]) -> tuple[np.ndarray, np.ndarray]:
    """Return a scene of two surfaces, or noise of few greys, so that sums are often equal."""
    if kind == "noise":
        left, right = np.random.default_rng(1).choice([0, 90, 255], (2, *shape)).astype(np.uint8)
        return left, right
    views, _, _ = step(shape=shape, back=2, front=7, box=(3, shape[0] - 2, 14, shape[1] - 20))
    return np.asarray(views.left), np.asarray(views.right)


@pytest.mark.parametrize("kind", ["scene", "noise"])
@pytest.mark.parametrize("stride", [1, 3])
@pytest.mark.parametrize(("shape", "span"), [((9, 80), Span(-9, 40)), ((8, 71), Span(0, 63)), ((5, 40), Span(-30, -2))])
def test_swept_columns_equal_plain_semi_global_matching(kind: str, stride: int, shape: tuple[int, int], span: Span):
    left, right = pair(kind, shape)
    out = np.full(shape, np.int16(7))
    codes = census(left), census(right)
    sweep_columns(*codes, np.ascontiguousarray(left[:, ::stride]), span, SHARP.penalties, stride, out)
    tried = Span(span.low, span.low + FEWEST_LANES - 1)
    sums = plain_sums(left, right, tried, SHARP.penalties, stride)
    assert np.array_equal(out, plain_disparity(sums, tried, 1.0, stride, shape[1]))
    assert (out != UNKNOWN).any()
