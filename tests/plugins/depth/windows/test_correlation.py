"""Windows compared at every disparity, against numpy written out plainly."""

from functools import cache

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from stereo_scenes import slanted, step
from tangible_core import load_method
from tangible_core.data import Views
from tangible_core.errors import PictureError
from tangible_depth.dense.span import UNKNOWN, Span
from tangible_depth.matching.window_matching import LEAST_VARIANCE
from tangible_depth.search.pairs import Pair
from tangible_depth.sgm.strips import unknown_matches
from tangible_depth.simd.lanes import Lanes
from tangible_depth.windows.correlation import correlate_strip
from tangible_depth.windows.odd import WindowSide
from window_similarity import matching_value, squared_difference

WINDOWS = arrays(np.float64, (5, 5), elements=st.integers(0, 255).map(float))


@given(WINDOWS, WINDOWS, st.floats(0.1, 9), st.floats(-50, 50))
def test_matching_value_ignores_gain_and_offset(one, other, gain, offset):
    value = matching_value(one, other)
    if np.ptp(one) == 0 or np.ptp(other) == 0:
        assert np.isnan(value)
        return
    assert -1 <= value <= 1
    assert matching_value(other, one) == pytest.approx(value)
    assert matching_value(one, gain * other + offset) == pytest.approx(value, abs=1e-6)
    assert matching_value(one, one) == pytest.approx(1)
    assert matching_value(one, -one) == pytest.approx(-1)


def test_matching_value_is_the_correlation_coefficient():
    one, other = np.random.default_rng(0).normal(size=(2, 7, 7))
    assert matching_value(one, other) == pytest.approx(np.corrcoef(one.ravel(), other.ravel())[0, 1])


def test_squared_differences_of_bytes_do_not_wrap():
    assert squared_difference(np.array([0, 255], np.uint8), np.array([255, 0], np.uint8)) == 2 * 255**2


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
                    scores[y, x, i] = -squared_difference(a, b) if squared else matching_value(a, b)
    return scores


@pytest.mark.parametrize("squared", [None, True])
@pytest.mark.parametrize("span", [Span(0, 12), Span(-4, 9), Span(-9, -2), Span(-3, 40)])
@pytest.mark.parametrize("side", [3, 5])
def test_scores_are_exact_and_mutual_best_are_accepted(squared, span, side):
    pair = small_pair()
    disparity, _ = unknown_matches(pair.left.shape)
    tops = np.full(pair.left.shape, -1e30, np.float32)
    how = (side // 2, span, np.float32(-1e29 if squared else 0.0), LEAST_VARIANCE)
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
def test_step_is_matched_and_filled(name):
    views, truth, hidden = step()
    method = load_method("depth", name)
    found = method(max_disparity_px=32).estimate(views)
    assert np.mean(np.abs(found.disparity_px - truth) <= 1) >= 0.95
    unfilled = method(max_disparity_px=32, fill=False).estimate(views)
    assert np.isnan(unfilled.disparity_px[hidden]).mean() >= 0.8


def test_zncc_ignores_exposure_and_ssd_does_not():
    views, truth = slanted()
    darker = Views(views.left, np.rint(0.6 * views.right + 30).astype(np.uint8))
    right = {
        name: np.mean(
            np.abs(load_method("depth", name)(max_disparity_px=32).estimate(darker).disparity_px - truth) <= 1
        )
        for name in ("zncc", "ssd")
    }
    assert right["zncc"] >= 0.98


@pytest.mark.parametrize("name", ["zncc", "ssd"])
@pytest.mark.parametrize("shape", [(1, 1), (1, 50), (50, 1), (6, 6), (7, 7), (8, 30)])
def test_small_and_flat_pairs_are_answered(name, shape):
    method = load_method("depth", name)()
    noise = np.random.default_rng(0).integers(0, 255, (2, *shape), np.uint8)
    assert method.estimate(Views(*noise)).disparity_px.shape == shape
    flat = np.full(shape, 9, np.uint8)
    found = method.estimate(Views(flat, flat))
    assert not (np.isfinite(found.disparity_px) & (found.confidence > 0)).any()


@pytest.mark.parametrize("name", ["zncc", "ssd"])
def test_even_windows_and_single_views_are_refused(name):
    method = load_method("depth", name)
    with pytest.raises(ValueError, match="must be odd"):
        method(window_px=6)
    with pytest.raises(PictureError, match="two views"):
        method().estimate(Views(np.zeros((9, 9), np.uint8)))
    assert WindowSide is not None
