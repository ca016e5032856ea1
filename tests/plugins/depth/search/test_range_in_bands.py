"""The range of two copies of a pair, from bands whose disparities are known."""

import numpy as np
import pytest

from tangible_core.data import Views
from tangible_depth import SemiGlobal
from tangible_depth.dense.span import UNKNOWN, Span
from tangible_depth.search import range_in_bands as module
from tangible_depth.search.bands import FINE_WIDTH, Bands
from tangible_depth.search.pairs import Pair
from tangible_depth.search.range_in_bands import FIRST_WIDTH, RangeEstimate, find_range

PAIR = Pair.of(*np.zeros((2, 8, 1000), np.uint8))


def bands(sixteenths: np.ndarray, factor: int = 1, loss: float = 0.0) -> Bands:
    """Return bands of these disparities."""
    known = np.count_nonzero(sixteenths != UNKNOWN)
    return Bands(np.arange(len(sixteenths)), sixteenths.astype(np.int16), factor, known, loss)


@pytest.mark.parametrize("count", [1, 2, 7])
def test_extremes_are_the_lowest_and_highest_known_values_with_equal_ones(count: int):
    random = np.random.default_rng(0)
    for _ in range(50):
        values = random.integers(-4, 5, (5, 9)).astype(np.int16)
        values[random.random((5, 9)) < 0.3] = UNKNOWN
        known = np.sort(values[values != UNKNOWN])
        lowest, highest = np.empty((2, count), np.int16)
        module._find_extremes(values, lowest, highest)
        assert lowest.tolist() == known[:count].tolist()
        assert highest.tolist() == known[::-1][:count].tolist()


@pytest.mark.parametrize(("factor", "span"), [(1, Span(1 - 2, 7 + 2)), (3, Span(3 - 6, 19 + 6))])
def test_range_leaves_out_stray_matches_and_has_a_margin_in_pixels_of_the_copy(factor: int, span: Span, monkeypatch):
    """Of 4000 matches two at either end; those left are at 1.0625 to 6.25 px of the copy."""
    values = np.full(4000, 50)
    values[:6], values[-6:] = [-900, -800, 17, 17, 17, 18], [99, 100, 100, 100, 3000, 4000]
    monkeypatch.setattr(module, "match_bands", lambda *_: bands(values.reshape(40, 100), factor))
    assert module._range_of_bands(PAIR, Span(0, 9), 80, 2).span == span


@pytest.mark.parametrize(
    ("low_px", "high_px", "swapped"), [(-2.0, 1, False), (-2.1, 1, True), (-2.1, 1.1, False), (-9, -5, True)]
)
def test_views_are_exchanged_where_no_disparity_is_above_one(low_px: float, high_px: float, swapped: bool, monkeypatch):
    values = np.rint(16 * np.array([[low_px, high_px]]))
    monkeypatch.setattr(module, "match_bands", lambda *_: bands(values))
    assert module._range_of_bands(PAIR, Span(-9, 9), 80, 2).swapped == swapped


def find(first: RangeEstimate | None, fine: RangeEstimate | None, monkeypatch: pytest.MonkeyPatch):
    """Find the range of two copies; return it, and what each was asked."""
    asked = []

    def look(pair: Pair, span: Span, width: int, margin: int) -> RangeEstimate | None:
        asked.append((span, width, margin))
        return first if width == FIRST_WIDTH else fine

    monkeypatch.setattr(module, "_range_of_bands", look)
    return find_range(PAIR), asked


def test_fine_copy_tries_an_eighth_of_the_width_at_least(monkeypatch: pytest.MonkeyPatch):
    nothing = bands(np.zeros((1, 1)))
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
        360: RangeEstimate(Span(3, 7), bands(near), False),
        800: RangeEstimate(Span(-510, 510), bands(far), False),
    }
    asked = []

    def look(pair: Pair, span: Span, width: int, margin: int) -> RangeEstimate | None:
        asked.append(span)
        return estimates[span.high] if width == FIRST_WIDTH else None

    monkeypatch.setattr(module, "_range_of_bands", look)
    assert find_range(PAIR) is estimates[800 if wider else 360]


@pytest.mark.parametrize("share", [0.4, 0.5, 0.62])
@pytest.mark.parametrize("exchanged", [False, True])
def test_thing_at_half_the_width_of_disparity_is_found(share: float, exchanged: bool):
    """A tenth of a textured picture is so near that the two views show it at opposite ends."""
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
    fine = RangeEstimate(Span(0, 20), bands(np.zeros((1, 1)), loss=loss), True)
    first = RangeEstimate(Span(-10, 9), bands(np.zeros((1, 1))), False)
    found, _ = find(first, fine, monkeypatch)
    assert (found.span, found.swapped, found.bands) == (span, swapped, fine.bands)


def test_first_copy_alone_counts_where_the_fine_one_matches_nothing(monkeypatch: pytest.MonkeyPatch):
    first = RangeEstimate(Span(-10, 9), bands(np.zeros((1, 1))), False)
    assert find(first, None, monkeypatch)[0] is first
    found, asked = find(None, first, monkeypatch)
    assert (found, len(asked)) == (None, 2)
