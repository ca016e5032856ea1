"""The measures by which rows are aligned, against plain formulas."""

import numpy as np
import pytest

from stereo_scenes import texture
from tangible_core.plugins.notes import collected
from tangible_depth.dense.span import UNKNOWN
from tangible_depth.row_alignment import common_rows, corner_check, profile_check
from tangible_depth.row_alignment.common_rows import align_rows
from tangible_depth.row_alignment.corner_check import corners_correspond
from tangible_depth.row_alignment.row_offset import row_votes, shift_rows
from tangible_depth.search.bands import Bands
from tangible_depth.search.pairs import Pair

Y, X = np.indices((160, 240), float)


@pytest.mark.parametrize(
    ("agreed", "lost", "offset"), [(20, 20, 0.4), (19, 0, None), (45, 55, 0.4), (44, 56, None), (100, 0, 0.4)]
)
def test_offset_is_common_if_twenty_edges_and_45_of_100_have_one(agreed: int, lost: int, offset: float | None):
    votes = np.r_[np.full(agreed, 0.4), np.full(lost, np.nan)].astype(np.float32)
    assert common_rows._agreed_offset_px(votes, 0.45, 0.3) == (offset and pytest.approx(offset))


def test_offset_that_varies_is_not_common():
    for apart, common in ((0.29, True), (0.31, False)):
        votes = np.repeat([0.4 - apart, 0.4, 0.4 + apart], [33, 34, 33]).astype(np.float32)
        assert (common_rows._agreed_offset_px(votes, 0.45, 0.3) is not None) == common


@pytest.mark.parametrize(("most_px", "offset_px", "moved"), [(0, 0.5, True), (0, 0.3, False), (1, 0.5, False)])
def test_rows_are_moved_where_the_method_does_not_do_it(most_px: float, offset_px: float, moved: bool, monkeypatch):
    pair = Pair.of(*np.random.default_rng(0).integers(0, 256, (2, 40, 60), np.uint8))
    monkeypatch.setattr(common_rows, "rows_match_elsewhere", lambda _: False)
    monkeypatch.setattr(common_rows, "common_row_offset", lambda *_: offset_px)
    with collected() as notes:
        found = align_rows(pair, Bands(np.arange(1), np.zeros((1, 60), np.int16), 1, 60, 0.0), most_px)
    assert (found is not pair) == moved
    assert notes == [f"rows realigned by {offset_px:.2f} px"] * moved


@pytest.mark.parametrize("rows", [-1.0, 1.0])
@pytest.mark.parametrize("most_px", [0.0, 0.9, 1.1])
def test_corners_of_a_higher_or_lower_view_are_corrected_up_to_the_most(rows: float, most_px: float, monkeypatch):
    pair = Pair.of(*np.zeros((2, 160, 240), np.uint8))
    monkeypatch.setattr(corner_check, "_row_offsets", lambda *_: np.full(20, 1.4 * rows))
    assert corners_correspond(pair, most_px) == (most_px >= 0.9)


@pytest.mark.parametrize("reach", [1, 7])
def test_profiles_correlate_over_the_rows_that_both_have(reach: int):
    """At each shift, over the energy of these rows alone."""
    left, right = np.random.default_rng(0).normal(size=(2, 30))
    expected = []
    for shift in range(-reach, reach + 1):
        ours, theirs = left[max(-shift, 0) : 30 - max(shift, 0)], right[max(shift, 0) : 30 - max(-shift, 0)]
        expected.append(ours @ theirs / np.sqrt((ours @ ours) * (theirs @ theirs)))
    assert profile_check._correlations(left, right, reach) == pytest.approx(expected)


@pytest.mark.parametrize("factor", [1, 2, 4])
def test_edges_are_sought_at_disparities_of_a_smaller_picture(factor: int):
    """The surface is 20 px before the right view's place, which is 5 px of a picture of a quarter of the size."""
    pair = Pair.of(texture(X, Y), texture(X + 20, Y - 0.5))
    rows = np.arange(6, 160, 12)
    disparity = np.full((len(rows), 240 // factor), np.int16(16 * 20 // factor))
    votes = row_votes(pair, rows, disparity, factor)
    assert np.isfinite(votes).mean() > 0.6
    assert np.nanmedian(votes) == pytest.approx(0.5, abs=0.1)
    assert not len(row_votes(pair, rows, np.full_like(disparity, UNKNOWN), factor))


@pytest.mark.parametrize(("offset_px", "whole"), [(1.14, True), (-0.9, True), (0.14, True), (1.16, False)])
def test_offset_near_a_whole_number_moves_whole_rows(offset_px: float, whole: bool):
    right = np.random.default_rng(0).integers(0, 256, (30, 40), np.uint8)
    moved = shift_rows(Pair.of(right, right), offset_px).right
    expected = right[np.clip(np.arange(30) + round(offset_px), 0, 29)]
    assert np.array_equal(moved, expected) == whole
