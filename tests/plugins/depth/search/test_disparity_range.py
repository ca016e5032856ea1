"""The range to search: what was asked for, what occurs, and what is said about it."""

import logging

import numpy as np
import pytest

from tangible_depth.dense.span import UNKNOWN, Span
from tangible_depth.search import disparity_range as module
from tangible_depth.search.bands import Bands
from tangible_depth.search.disparity_range import find_disparity_range
from tangible_depth.search.pairs import Pair
from tangible_depth.search.range_in_bands import RangeEstimate

PAIR = Pair.of(*np.zeros((2, 8, 500), np.uint8))


def bands(disparity_px: np.ndarray, factor: int = 1) -> Bands:
    """Return bands of these disparities of the picture, between unknown ones."""
    sixteenths = np.rint(16 * disparity_px / factor).astype(np.int16)
    return Bands(np.arange(1), np.insert(sixteenths, 0, UNKNOWN)[None], factor, disparity_px.size, 0.0)


def estimated(monkeypatch: pytest.MonkeyPatch, span: Span | None, swapped: bool = False, found: Bands | None = None):
    """Let the bands give this range."""
    estimate = None if span is None else RangeEstimate(span, found or bands(np.zeros(1)), swapped)
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


def test_range_of_exchanged_views_ends_at_zero(monkeypatch: pytest.MonkeyPatch):
    estimated(monkeypatch, Span(-40, 3), swapped=True)
    found = find_disparity_range(PAIR, "auto", "auto")
    assert found.span == Span(-40, 0)
    (said, level), (outside, _) = found.notes
    assert said.startswith("every disparity is negative") and level == logging.WARNING
    assert outside == (
        "skipped: disparities outside -40..0 px, as none was found up to 400 px; for nearer things write "
        "`max_disparity_px`"
    )


def test_pair_without_matches_has_the_default_range_and_says_so(monkeypatch: pytest.MonkeyPatch):
    estimated(monkeypatch, None)
    found = find_disparity_range(PAIR, "auto", "auto")
    assert found.span == Span(0, 191)
    [(said, level)] = found.notes
    assert said == "skipped: disparities outside 0..180 px, the default range of a pair without matches"
    assert level == logging.INFO


@pytest.mark.parametrize("factor", [1, 2])
def test_verified_range_goes_on_by_steps_while_a_hundredth_of_the_matches_lies_there(factor: int, monkeypatch):
    """Verified are 20..52 px; steps have 8 px, and 2 of 200 matches are enough: 2 lie before 60, 68 and 76 px.

    Downwards 2 lie from 12 px on. A step lies beside these at either end; all lanes are filled.
    """
    near = np.concatenate([np.full(190, 30.0), [53, 59, 60, 67, 68, 75, 76, 13, 14, 5]])
    estimated(monkeypatch, Span(-99, 99), found=bands(near, factor))
    span = find_disparity_range(PAIR, "auto", "auto", (20, 52)).span
    assert span == Span(4, 4 + 96 - 1)


@pytest.mark.parametrize(("verified", "span"), [((-50, 190), Span(-80, 220)), ((-10, 200), Span(-36, 226))])
def test_wide_verified_range_is_not_filled_up(verified: tuple[int, int], span: Span, monkeypatch):
    """A step is an eighth of the verified range, and lies beside it even where nothing matches."""
    estimated(monkeypatch, Span(0, 0))
    assert find_disparity_range(PAIR, "auto", "auto", verified).span == span
