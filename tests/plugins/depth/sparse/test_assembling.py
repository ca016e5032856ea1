"""Dense maps from scattered matches: else `report` smears disparities over edges."""

import numpy as np
import pytest

from tangible_depth.sparse.assembling import assemble, erase_speckles, fill_nearest

SHAPE = (30, 40)


def scatter(values, every=4):
    found = np.full(SHAPE, np.nan, np.float32)
    found[::every, ::every] = values[::every, ::every]
    return found, np.where(np.isfinite(found), 0.9, 0).astype(np.float32)


@pytest.mark.parametrize(("off_px", "agrees"), [(-2.1, False), (-1.9, True), (1.9, True), (2.1, False)])
def test_match_over_two_pixels_off_is_stray(off_px, agrees):
    """A match of hardly any weight, so that the mean is that of the others; one that counts keeps its score."""
    found, score = scatter(np.full(SHAPE, 7.0))
    found[16, 20], score[16, 20] = 7 + off_px, 1e-4
    confidence = assemble(found, score, np.zeros(SHAPE, np.uint8)).confidence
    assert (confidence[16, 20] == np.float32(1e-4)) == agrees


def test_matches_are_weighted_by_their_scores():
    """Both sums do, of disparities and of weights: of each match by itself the confidence says how much it counts."""

    def one(column, disparity, score):
        found = np.full(SHAPE, np.nan, np.float32), np.zeros(SHAPE, np.float32)
        found[0][15, column], found[1][15, column] = disparity, score
        return found

    blank, elsewhere = np.zeros(SHAPE, np.uint8), np.abs(np.arange(40) - 20) < 8
    (near, good), (far, poor) = one(8, 5.0, 0.9), one(32, 6.0, 0.3)
    counts, less = (assemble(*each, blank).confidence for each in ((near, good), (far, poor)))
    np.testing.assert_allclose(
        assemble(near, good / 2, blank).confidence[:, elsewhere], counts[:, elsewhere] / 2, rtol=1e-5
    )
    both = assemble(np.fmax(near, far), good + poor, blank)
    expected = (5 * counts + 6 * less) / (counts + less)
    np.testing.assert_allclose(both.disparity_px[:, elsewhere], expected[:, elsewhere], atol=0.01)
    np.testing.assert_allclose(both.confidence[:, elsewhere], (counts + less)[:, elsewhere], rtol=1e-4)
    assert np.ptp(expected[15, elsewhere]) > 0.05


@pytest.mark.parametrize(("grey", "least", "most"), [(1, 0.6, 0.95), (20, 0.005, 0.3), (200, 0.0, 1e-12)])
def test_colour_change_counts_as_distance(grey, least, most):
    """A change of 8 % of white counts as the reach: the remaining share of a match's weight behind it."""
    found, score = np.full(SHAPE, np.nan, np.float32), np.zeros(SHAPE, np.float32)
    found[15, 10], score[15, 10] = 5, 0.9
    edged = np.where(np.arange(40) < 20, 0, grey).astype(np.uint8) * np.ones((30, 1), np.uint8)
    behind, plain = (assemble(found, score, each).confidence[15, 30] for each in (edged, 0 * edged))
    assert least <= behind / plain <= most


def test_pixel_out_of_reach_takes_the_nearest_reached_value():
    """Behind an edge from black to white sums of weights are rounding, and their ratio is no disparity."""
    picture = np.where(np.arange(40) < 20, 0, 255).astype(np.uint8) * np.ones((30, 1), np.uint8)
    found, score = np.full(SHAPE, np.nan, np.float32), np.zeros(SHAPE, np.float32)
    found[15, [2, 18]], score[15, [2, 18]] = (5, 6), 0.9
    filled = assemble(found, score, picture)
    beside = filled.disparity_px[:, 17:18]
    assert np.ptp(filled.disparity_px[15, :20]) > 0.01
    np.testing.assert_allclose(filled.disparity_px[:, 20:], np.broadcast_to(beside, (30, 20)), atol=0.02)
    assert filled.confidence[:, 20:].max() < 1e-12


def test_nan_takes_the_nearest_known_value():
    values = np.array([[np.nan, 1, np.nan, np.nan, 5]], np.float32)
    assert fill_nearest(values).tolist() == [[1, 1, 1, 5, 5]]
    assert fill_nearest(np.ones((2, 2), np.float32)).tolist() == [[1, 1], [1, 1]]


def test_island_of_just_the_size_is_erased():
    disparity = np.full(SHAPE, np.nan, np.float32)
    disparity[5:10, 5:10] = disparity[20:25, 20:25] = 3
    disparity[25, 20] = 3.5
    left = erase_speckles(disparity, 25)
    assert (np.isfinite(left).sum(), np.isfinite(left[20:26, 20:25]).sum()) == (26, 26)
