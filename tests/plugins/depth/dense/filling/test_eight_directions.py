"""Gaps filled from eight sides."""

import numpy as np

from tangible_depth.dense.filling.eight_directions import fill_from_eight_directions
from tangible_depth.dense.span import UNKNOWN


def test_what_is_known_stays_and_what_is_not_is_filled():
    rng = np.random.default_rng(0)
    disparity = rng.integers(0, 500, (30, 40)).astype(np.int16)
    known = rng.random(disparity.shape) < 0.3
    filled = fill_from_eight_directions(np.where(known, disparity, UNKNOWN), rng.integers(0, 255, (30, 40), np.uint8))
    assert np.array_equal(filled[known], disparity[known])
    assert np.isin(filled, disparity[known]).all()


def test_a_map_without_any_match_and_one_without_a_gap_stay_as_they_are():
    grey = np.zeros((7, 9), np.uint8)
    for value in (UNKNOWN, np.int16(48)):
        disparity = np.full((7, 9), value)
        assert np.array_equal(fill_from_eight_directions(disparity, grey), disparity)


def test_one_match_fills_everything():
    disparity = np.full((9, 11), UNKNOWN)
    disparity[2, 7] = 80
    assert (fill_from_eight_directions(disparity, np.zeros((9, 11), np.uint8)) == 80).all()


def test_a_gap_takes_the_surface_that_the_picture_shows_there_though_only_a_diagonal_sees_it():
    disparity = np.full((21, 21), np.int16(160))
    grey = np.full((21, 21), 200, np.uint8)
    diagonal = np.eye(21, dtype=bool) | np.eye(21, k=1, dtype=bool) | np.eye(21, k=-1, dtype=bool)
    disparity[diagonal], grey[diagonal] = 32, 20  # a rod across the picture
    hole = (slice(8, 13), slice(8, 13))
    disparity[hole] = UNKNOWN
    filled = fill_from_eight_directions(disparity, grey)
    assert (filled[10, 10], filled[9, 9], filled[11, 11]) == (32, 32, 32)
    assert (filled[12, 8], filled[8, 12]) == (160, 160)


def test_the_farther_side_wins_in_a_row_where_the_picture_says_nothing():
    disparity = np.full((1, 40), np.int16(16))
    disparity[0, 24:] = 160
    disparity[0, 14:24] = UNKNOWN
    assert (fill_from_eight_directions(disparity, np.zeros((1, 40), np.uint8))[0, 14:24] == 16).all()
