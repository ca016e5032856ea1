"""Windows compared at every disparity, against numpy written out plainly: else `zncc` and `ssd` are wrong."""

from functools import cache

import numpy as np
import pytest

from stereo_scenes import slanted, step
from tangible_core import load_method
from tangible_depth.dense.span import UNKNOWN, Span
from tangible_depth.matching.window_matching import MIN_VARIANCE
from tangible_depth.search.pairs import Pair
from tangible_depth.sgm.strips import unknown_matches
from tangible_depth.simd.lanes import Lanes
from tangible_depth.windows.correlation import correlate_strip


def small_pair():
    views, _, _ = step(shape=(12, 48), back=2, front=6, box=(3, 9, 14, 34))
    return Pair.of(np.asarray(views.left), np.asarray(views.right))


WIDEST = Span(-9, 40)


@cache
def plain_scores(side, squared):
    """Scores of the pair at each of the widest disparities: those of a span are among them."""
    (left, right), span = small_pair(), WIDEST
    h, w = left.shape
    r = side // 2
    pads = [np.pad(z.astype(float), ((r, r), (0, 0)), mode="edge") for z in (left, right)]
    scores = np.full((h, w, span.high - span.low + 1), -np.inf)
    for y, x in np.ndindex(h, w):
        for i, d in enumerate(range(span.low, span.high + 1)):
            if r <= x < w - r and r <= x - d < w - r:
                a, b = (z[y : y + side, c - r : c + r + 1] for z, c in zip(pads, (x, x - d), strict=True))
                if a.var() > 1 and b.var() > 1:
                    scores[y, x, i] = -np.square(a - b).sum() if squared else np.corrcoef(a.ravel(), b.ravel())[0, 1]
    return scores


@pytest.mark.parametrize("squared", [None, True])
@pytest.mark.parametrize("span", [Span(0, 12), Span(-4, 9), Span(-9, -2), Span(-3, 40)])
@pytest.mark.parametrize("side", [3, 5])
def test_scores_are_exact_and_mutual_best_are_accepted(squared, span, side):
    pair = small_pair()
    disparity, _ = unknown_matches(pair.left.shape)
    tops = np.full(pair.left.shape, -1e30, np.float32)
    how = (side // 2, span, np.float32(-1e29 if squared else 0.0), MIN_VARIANCE)
    correlate_strip(Lanes(span.lanes), squared, *pair, (0, 12), *how, disparity, tops)
    scores = plain_scores(side, squared)[..., span.low - WIDEST.low : span.high - WIDEST.low + 1]
    best = scores.max(axis=-1)
    seen = np.isfinite(best)
    assert np.allclose(tops[seen], best[seen], rtol=1e-4, atol=1e-4)
    r = side // 2
    for y, x in zip(*np.nonzero(disparity != UNKNOWN), strict=True):
        d = round(disparity[y, x] / 16)
        near = [scores[y, x, i] for i in (d - 1 - span.low, d - span.low, d + 1 - span.low) if 0 <= i < scores.shape[2]]
        assert max(near) == pytest.approx(best[y, x], rel=1e-4, abs=1e-4)
    assert (disparity[:, :r] == UNKNOWN).all()


@pytest.mark.parametrize("name", ["zncc", "ssd"])
@pytest.mark.parametrize("offset", [4.0, 7.25, 11.6])
def test_plane_is_matched_to_a_fraction_of_a_pixel(name, offset):
    views, truth = slanted(offset=offset)
    found = load_method("depth", name)(max_disparity_px=32).estimate(views)
    assert np.median(np.abs(found.disparity_px - truth)) <= 0.07
    assert np.mean(np.abs(found.disparity_px - truth) <= 0.5) >= 0.99


@pytest.mark.parametrize("name", ["zncc", "ssd"])
def test_even_windows_are_refused(name):
    with pytest.raises(ValueError, match="must be odd"):
        load_method("depth", name)(window_px=6)


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
