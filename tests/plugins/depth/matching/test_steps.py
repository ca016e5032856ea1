"""The steps round a matcher, with a matcher that says what it was asked."""

import numpy as np
import pytest

from tangible_core.data import DisparityMap, Views
from tangible_core.plugins.notes import collected
from tangible_depth.dense.refinement import DenseMatches
from tangible_depth.dense.span import Span
from tangible_depth.matching import chain
from tangible_depth.matching.chain import Search, low_confidence_share, match_in_order, zero_disparity
from tangible_depth.search.pairs import Pair

PAIR = Pair.of(*np.random.default_rng(0).integers(0, 256, (2, 6, 9), np.uint8))
SEARCH = Search("auto", "auto", "auto", fill=True)


def asked_by(span: Span) -> tuple[DisparityMap, Pair, Span]:
    """Match the pair within a span by what grows along the rows of the left picture that was given."""
    asked = []

    def match(pair: Pair, span: Span) -> DenseMatches:
        asked.append((pair, span))
        columns = np.indices(pair.left.shape)[1]
        return DenseMatches((16 * columns).astype(np.int16), (columns / 10).astype(np.float32))

    found = match_in_order(PAIR, span, True, match)
    return found, *asked[0]


@pytest.mark.parametrize("span", [Span(-9, 1), Span(0, 30)])
def test_range_with_positive_disparities_is_matched_as_it_is(span: Span):
    found, pair, asked = asked_by(span)
    assert (asked, pair is PAIR) == (span, True)
    assert found.disparity_px[0].tolist() == list(range(9))


@pytest.mark.parametrize(("span", "turned"), [(Span(-9, -2), Span(2, 9)), (Span(-30, 0), Span(0, 30))])
def test_range_without_positive_disparities_is_matched_in_a_mirror(span: Span, turned: Span):
    found, pair, asked = asked_by(span)
    assert asked == turned
    assert np.array_equal(pair.left, PAIR.left[:, ::-1])
    assert np.array_equal(pair.right, PAIR.right[:, ::-1])
    assert found.disparity_px[0].tolist() == list(range(-8, 1))
    assert found.confidence[0] == pytest.approx(np.arange(8, -1, -1) / 10)


def test_identical_views_are_unknown_where_they_are_flat_unless_filled():
    left = np.full((9, 14), 80, np.uint8)
    left[:, 9:] = np.arange(5) * 30
    for fill in (True, False):
        found = zero_disparity(Pair.of(left, left), fill)
        assert np.array_equal(np.isnan(found.disparity_px), (np.arange(14) < 7) & (not fill) & (left > -1))
        assert np.array_equal(found.confidence, (np.arange(14) >= 7) * np.ones((9, 1)))
        assert np.isnan(zero_disparity(Pair.of(left[:, :5], left[:, :5]), fill).disparity_px).all()


def test_pixel_of_just_the_least_confidence_is_not_low():
    confidence = np.float32([[0.1, 0.15, 0.2, 0.14]])
    assert chain.LOW_CONFIDENCE == 0.15
    confidence[0, 1] = 0.15000001
    assert low_confidence_share(DisparityMap(np.zeros((1, 4), np.float32), confidence)) == 0.5
    exact = np.array([[0.1, 0.125, 0.2, 0.14]], np.float32)
    assert low_confidence_share(DisparityMap(np.zeros((1, 4), np.float32), exact)) == 0.75


@pytest.mark.parametrize(("better", "worse"), [((0.2, 0.2), (0.2, 0.1)), ((0.2, 0.1), (0.2, 0.1))])
def test_first_map_stays_unless_the_rectified_one_is_better(better, worse, monkeypatch: pytest.MonkeyPatch):
    again, first = (
        DisparityMap(np.zeros((1, 2), np.float32), np.array([each], np.float32)) for each in (better, worse)
    )
    monkeypatch.setattr(chain, "_match_rectified", lambda *_: again)
    views = Views(PAIR.left, PAIR.right)
    with collected() as notes:
        found = chain._retry_rectified(views, "", SEARCH, lambda *_: None, first)
    assert found is (again if better != worse else first)
    assert notes == ["retried with rectification: 50% of the pixels have low confidence"]
