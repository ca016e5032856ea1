"""Gaps filled from eight sides."""

import numpy as np

from tangible_depth.dense.filling.eight_directions import fill_from_eight_directions
from tangible_depth.dense.span import UNKNOWN


def test_known_pixels_stay_and_unknown_ones_are_filled():
    rng = np.random.default_rng(0)
    disparity = rng.integers(0, 500, (30, 40)).astype(np.int16)
    known = rng.random(disparity.shape) < 0.3
    filled = fill_from_eight_directions(np.where(known, disparity, UNKNOWN), rng.integers(0, 255, (30, 40), np.uint8))
    assert np.array_equal(filled[known], disparity[known])
    assert np.isin(filled, disparity[known]).all()


def test_maps_without_matches_or_without_gaps_stay_unchanged():
    grey = np.zeros((7, 9), np.uint8)
    for value in (UNKNOWN, np.int16(48)):
        disparity = np.full((7, 9), value)
        assert np.array_equal(fill_from_eight_directions(disparity, grey), disparity)


def test_single_match_fills_the_map():
    disparity = np.full((9, 11), UNKNOWN)
    disparity[2, 7] = 80
    assert (fill_from_eight_directions(disparity, np.zeros((9, 11), np.uint8)) == 80).all()


def test_gap_takes_the_surface_of_its_grey_from_a_diagonal():
    disparity = np.full((21, 21), np.int16(160))
    grey = np.full((21, 21), 200, np.uint8)
    diagonal = np.eye(21, dtype=bool) | np.eye(21, k=1, dtype=bool) | np.eye(21, k=-1, dtype=bool)
    disparity[diagonal], grey[diagonal] = 32, 20  # a rod across the picture
    hole = (slice(8, 13), slice(8, 13))
    disparity[hole] = UNKNOWN
    filled = fill_from_eight_directions(disparity, grey)
    assert (filled[10, 10], filled[9, 9], filled[11, 11]) == (32, 32, 32)
    assert (filled[12, 8], filled[8, 12]) == (160, 160)


def walk(disparity: np.ndarray, grey: np.ndarray, place: tuple[int, int], step: tuple[int, int]) -> tuple[int, int]:
    """Return the first known disparity on the way, UNKNOWN without one, and the grey steps up to it."""
    (y, x), path = place, 0
    while True:
        v, u = y + step[0], x + step[1]
        if not (0 <= v < disparity.shape[0] and 0 <= u < disparity.shape[1]):
            return int(UNKNOWN), 0
        path += abs(int(grey[v, u]) - int(grey[y, x]))
        if disparity[v, u] != UNKNOWN:
            return int(disparity[v, u]), path
        y, x = v, u


def scores(disparity: np.ndarray, grey: np.ndarray, y: int, x: int, steps: list[tuple[int, int]]) -> dict[int, float]:
    """Score the candidates of a pixel by the docstring of `candidates`, each disparity by its best way."""
    w = disparity.shape[1]
    ways = {step: walk(disparity, grey, (y, x), step) for step in steps}
    known = [value for value, _ in ways.values() if value != UNKNOWN]
    row = [ways[step][0] for step in ((0, -1), (0, 1)) if ways[step][0] != UNKNOWN]
    found: dict[int, float] = {}
    for (down, across), (value, path) in ways.items():
        if value == UNKNOWN:
            continue
        column = x - (value + 8) // 16
        there = [int(each) for u, each in enumerate(disparity[y]) if each != UNKNOWN and u - (each + 8) // 16 == column]
        if not 0 <= column < w:
            seen = 0.75
        elif not there:
            seen = -1.4
        else:
            seen = -3.4 * (max(there) < value - 24)
        rated = seen - 0.18 * np.sqrt(path) - 0.3 * (value - min(known)) / 160 - 0.9 * (down != 0 and across != 0)
        rated += 0.7 * (not row or value <= min(row) + 8)
        found[value] = max(rated, found.get(value, -np.inf))
    return found


def test_each_gap_takes_the_candidate_of_the_best_score():
    """Away from the left border, and nothing said where two are nearly as good."""
    random = np.random.default_rng(1)
    steps = [(v, u) for v in (-1, 0, 1) for u in (-1, 0, 1) if (v, u) != (0, 0)]
    disparity = random.choice([-40, 16, 64, 200, 330], (24, 30)).astype(np.int16)
    disparity[:, 2:][random.random((24, 28)) < 0.75] = UNKNOWN
    grey = random.choice([0, 30, 90], disparity.shape).astype(np.uint8)
    filled = fill_from_eight_directions(disparity, grey)
    told = set()
    for y, x in zip(*np.nonzero(disparity == UNKNOWN), strict=True):
        found = scores(disparity, grey, y, x, steps)
        best, *others = sorted(found, key=found.__getitem__, reverse=True)
        if not others or found[best] - found[others[0]] > 1e-3:
            assert filled[y, x] == best, (y, x)
            told.add((y, x))
    assert len(told) > 400


def test_path_of_more_steps_than_16_bits_hold_is_the_longest():
    """On the left a far surface behind 65540 levels, which would wrap to 4; on the right a near one without a step."""
    disparity = np.full((1, 800), UNKNOWN)
    disparity[0, :200], disparity[0, 500:] = 16, 160
    grey = np.full((1, 800), 250, np.uint8)
    grey[0, :200], grey[0, 200:458] = 0, np.arange(258) % 2 * 255
    assert (fill_from_eight_directions(disparity, grey)[0, 460:500] == 160).all()


def test_gap_in_a_uniform_row_takes_the_farther_side():
    disparity = np.full((1, 40), np.int16(16))
    disparity[0, 24:] = 160
    disparity[0, 14:24] = UNKNOWN
    assert (fill_from_eight_directions(disparity, np.zeros((1, 40), np.uint8))[0, 14:24] == 16).all()
