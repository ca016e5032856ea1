"""Which windows match, and where between whole pixels, against numpy written out plainly."""

import numpy as np
import pytest

from tangible_depth.dense.span import UNKNOWN, Span
from tangible_depth.search.pairs import Pair
from tangible_depth.sgm.strips import unknown_matches
from tangible_depth.simd.lanes import Lanes
from tangible_depth.windows.correlation import correlate_strip


def squared_scores(pair: Pair, span: Span, least_variance: float) -> np.ndarray:
    """Return minus the sums of squared differences of 3 x 3 windows, by row, column and disparity."""
    h, w = pair.left.shape
    pads = [np.pad(each.astype(int), ((1, 1), (0, 0)), mode="edge") for each in pair]
    scores = np.full((h, w, span.size), -np.inf)
    for y, x, i in np.ndindex(scores.shape):
        u = x - span.low - i
        if 1 <= x < w - 1 and 1 <= u < w - 1:
            a, b = pads[0][y : y + 3, x - 1 : x + 2], pads[1][y : y + 3, u - 1 : u + 2]
            if min(a.var(), b.var()) > least_variance:
                scores[y, x, i] = -np.square(a - b).sum()
    return scores


@pytest.mark.parametrize("least", [-1e29, -40.0])
@pytest.mark.parametrize("span", [Span(0, 6), Span(-5, 10), Span(-7, -3)])
def test_windows_match_where_both_are_each_others_best(span: Span, least: float):
    """Greys of three levels, so that scores are often equal, and that of some windows is just the least."""
    pair = Pair.of(*np.random.default_rng(3).integers(0, 4, (2, 9, 22), np.uint8))
    variance = 8 / 9
    found, _ = unknown_matches(pair.left.shape)
    tops = np.full(found.shape, -1e30, np.float32)
    correlate_strip(Lanes(span.lanes), True, *pair, (0, 9), 1, span, np.float32(least), variance, found, tops)
    scores = squared_scores(pair, span, variance)
    best = scores.max(axis=2)
    right = np.full((9, 22), -np.inf)
    for y, x, i in zip(*np.nonzero(np.isfinite(scores)), strict=True):
        right[y, x - span.low - i] = max(right[y, x - span.low - i], scores[y, x, i])
    for y, x in np.ndindex(best.shape):
        here = scores[y, x]
        i = span.size - 1 - int(here[::-1].argmax())  # of equals the largest disparity
        d = span.low + i
        around = here[i - 1 : i + 2] if 0 < i < span.size - 1 else np.zeros(0)
        if (
            not np.isfinite(best[y, x])
            or best[y, x] <= least
            or best[y, x] < right[y, x - d]
            or (len(around) and np.ptp(around) == 0)
        ):
            assert found[y, x] == UNKNOWN, (y, x)
            continue
        offset = 0.0
        if len(around) and np.isfinite(around).all():
            low, at, high = around
            offset = (low - high) / (2 * (low - 2 * at + high))
        assert found[y, x] == np.floor(16 * (d + offset) + 0.5), (y, x)
    assert np.count_nonzero(found != UNKNOWN) > 20
