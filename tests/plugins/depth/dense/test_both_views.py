"""Matches of both views, each as the reference."""

import numpy as np
import pytest

from tangible_depth.dense.both_views import reconcile
from tangible_depth.dense.span import UNKNOWN

PX = 16
"""A pixel, in the units of a map."""


def of(*disparities_px: float | None) -> np.ndarray:
    """Return a row of a map; None is UNKNOWN."""
    return np.array([[UNKNOWN if each is None else round(each * PX) for each in disparities_px]], np.int16)


@pytest.mark.parametrize(("right_px", "kept"), [(3, True), (3.0625, False), (2, True), (1, True), (0.9375, False)])
def test_match_is_struck_where_the_right_view_differs_by_more_than_a_pixel(right_px: float, kept: bool):
    """A left pixel at 5, 2 px of disparity: the right view has its own at 3."""
    left, right = of(*[None] * 8), of(*[None] * 8)
    left[0, 5], right[0, 3] = 2 * PX, round(right_px * PX)
    found = reconcile(left, right)
    assert left[0, 5] == found[0, 5] == (2 * PX if kept else UNKNOWN)


@pytest.mark.parametrize(("disparity_px", "at"), [(1.4375, 4), (1.5, 3), (-0.5, 5), (-0.5625, 6)])
def test_match_is_held_against_the_nearest_pixel(disparity_px: float, at: int):
    for place in range(8):
        left, right = of(*[None] * 8), of(*[None] * 8)
        left[0, 5], right[0, place] = round(disparity_px * PX), 90 * PX
        reconcile(left, right)
        assert (left[0, 5] == UNKNOWN) == (place == at)


def test_match_stays_where_the_right_view_has_none_or_ends():
    left = of(2, 2, None, 3, 1)
    right = of(None, None, None, None, None)
    assert np.array_equal(reconcile(left, right), of(2, 2, None, 3, 1))
    assert np.array_equal(left, of(2, 2, None, 3, 1))


def test_gap_takes_the_nearest_surface_that_the_right_view_has_there():
    """Right pixels 1 and 0 both see left pixel 4, at 3 and at 4 px; where the left one has a match it stays."""
    right = of(4, 3, 3, 1, None, 3)
    left = of(None, None, None, None, None, 2.5)
    found = reconcile(left, right)
    assert np.array_equal(found, of(None, None, None, None, 4, 2.5))
    assert np.array_equal(left, of(None, None, None, None, None, 2.5))


@pytest.mark.parametrize(("disparity_px", "at"), [(1.4375, 2), (1.5, 3), (-0.5, 1), (-0.5625, 0)])
def test_place_in_the_other_view_is_rounded(disparity_px: float, at: int):
    right = of(None, disparity_px, None, None)
    found = reconcile(of(None, None, None, None), right)
    assert np.flatnonzero(found[0] != UNKNOWN).tolist() == [at]


def test_what_the_right_view_strikes_is_not_closed_from_it():
    """A surface at 2 px, by both views but for one left pixel, which says 5 px: it is filled, and does not spread."""
    left, right = np.full((3, 12), 2 * PX, np.int16), np.full((3, 12), 2 * PX, np.int16)
    left[1, 8] = 5 * PX
    found = reconcile(left, right)
    assert found[1, 8] == left[1, 8] == UNKNOWN
    assert np.count_nonzero(found == UNKNOWN) == 1
