"""The size at which a pair is matched, and what is spent on it."""

import numpy as np
import pytest

from tangible_core.plugins.notes import collected
from tangible_depth.dense.span import UNKNOWN, Span
from tangible_depth.matching import scaling as module
from tangible_depth.matching.adaptive import Matched, MatchedView
from tangible_depth.matching.scaling import CHECK_TOLERANCE, Scaling
from tangible_depth.search.pairs import Pair
from tangible_depth.sgm.costs import SHARP
from tangible_depth.sgm.strips import StripMatches

OPTIONS = Scaling("auto", "balanced", "auto", "soft", realign_rows=True, skip_flat=True)


@pytest.mark.parametrize(
    ("resolution", "disparities", "factor"),
    [("auto", 256, 1), ("auto", 257, 2), ("auto", 600, 4), ("full", 512, 1), ("full", 513, 2), ("half", 20, 2)],
)
def test_pictures_are_smaller_where_more_disparities_are_tried_than_fit(resolution, disparities: int, factor: int):
    with collected() as notes:
        found = module._factor(Span(0, disparities - 1), OPTIONS._replace(resolution=resolution))
    assert found == factor
    assert notes == [f"skipped: full resolution, matched at 1/{factor}"] * (factor > 1)


def test_strip_has_texture_if_a_window_of_its_rows_has():
    grey = np.full((40, 30), 90, np.uint8)
    grey[20, 7] = 91
    assert [module._has_texture(grey, y, y + 4) for y in (14, 15, 20, 22, 23)] == [False, True, True, True, False]


def test_strict_check_accepts_mutual_best_matches_alone():
    assert CHECK_TOLERANCE == {"soft": 1.08, "strict": 1.0}


def test_confidence_of_a_match_falls_from_one_to_that_of_the_worst_with_its_cost(monkeypatch: pytest.MonkeyPatch):
    """In a picture without steps or gaps: of 96 bits on four paths."""
    grey = np.random.default_rng(0).integers(0, 256, (20, 60), np.uint8)
    sums = np.tile(np.repeat([0, 24, 48, 96, 255], 12), (20, 1)).astype(np.uint8)
    disparity = np.full(grey.shape, np.int16(64))
    assert (disparity != UNKNOWN).all()
    view = MatchedView(StripMatches(disparity.copy(), sums), grey)
    monkeypatch.setattr(module, "match", lambda *_: Matched(view, None, SHARP))
    found = module.match_scaled(Pair.of(grey, grey), Span(0, 15), OPTIONS)
    np.testing.assert_allclose(found.confidence[0], np.repeat([1, 0.75, 0.5, 0.2, 0.2], 12), atol=1e-6)


def test_right_view_is_completed_by_the_picture_that_was_matched(monkeypatch):
    """The given one before its rows were realigned would put its edges on other rows than the matches have."""
    left, right, moved = np.random.default_rng(0).integers(0, 256, (3, 20, 60), np.uint8)
    known, other = (StripMatches(np.full((20, 60), np.int16(each)), np.zeros((20, 60), np.uint8)) for each in (64, 80))
    views = MatchedView(known, left), MatchedView(other, np.ascontiguousarray(moved[:, ::-1]))
    monkeypatch.setattr(module, "match", lambda *_: Matched(*views, SHARP))
    seen = {}

    def complete(disparity, sums, by_sum, grey, *more):
        seen[int(disparity[0, 0])] = grey
        return module_complete(disparity, sums, by_sum, grey, *more)

    module_complete = module.complete
    monkeypatch.setattr(module, "complete", complete)
    module.match_scaled(Pair.of(left, right), Span(0, 15), OPTIONS._replace(effort="best"))
    assert np.array_equal(seen[64], left)
    assert np.array_equal(seen[80], moved[:, ::-1])
