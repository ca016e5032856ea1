"""Steps between matches and a map, against plain formulas: else edges are felt beside where they are seen."""

import numpy as np
import pytest

from tangible_depth.dense.confidence import OF_FILLED, OF_MATCHED, probability
from tangible_depth.dense.refinement import reconcile, sharpen_edges
from tangible_depth.dense.span import UNKNOWN
from tangible_depth.opencv_sgbm import left_right_confidence


def written_out(disparity: np.ndarray, grey: np.ndarray) -> np.ndarray:
    """Let every second pixel within 4 px vote by its grey for one of the two sides; of a tie nothing comes."""
    h, w = disparity.shape
    values, greys = disparity.astype(int), grey.astype(int)
    out = disparity.copy()
    for y, x in np.ndindex(h, w):
        near = values[max(y - 1, 0) : y + 2, max(x - 1, 0) : x + 2]
        if np.ptp(near) < 24:
            continue
        middle = (near.min() + near.max()) // 2
        voters = [(v, u) for v in range(y - 4, y + 5, 2) for u in range(x - 4, x + 5, 2) if 0 <= v < h and 0 <= u < w]
        weights = np.array([max(24 - abs(greys[voter] - greys[y, x]), 0) for voter in voters])
        theirs = np.array([values[voter] for voter in voters])
        front = theirs > middle
        ahead = weights[front].sum() - weights[~front].sum()
        if ahead != 0 and (ahead > 0) != (values[y, x] > middle):
            side = front == (ahead > 0)
            out[y, x] = (weights * theirs)[side].sum() // weights[side].sum()
    return out


@pytest.mark.parametrize("greys", [[90], [0, 7, 20], [0, 10, 40, 255]])
@pytest.mark.parametrize("disparities", [[-31, 0, 24, 331], [-720, -413, -400, -376], [-32000, 31999]])
def test_edges_of_any_map_move_as_the_votes_say(disparities: list[int], greys: list[int]):
    random = np.random.default_rng(2)
    for shape in ((11, 14), (9, 3), (1, 8)):
        disparity = random.choice(disparities, shape).astype(np.int16)
        grey = random.choice(greys, shape).astype(np.uint8)
        assert np.array_equal(sharpen_edges(disparity, grey), written_out(disparity, grey))


PX = 16
"""A pixel, in the units of a map."""


def of(*disparities_px: float | None) -> np.ndarray:
    """Return a row of a map; None is UNKNOWN."""
    return np.array([[UNKNOWN if each is None else round(each * PX) for each in disparities_px]], np.int16)


def test_what_the_right_view_strikes_is_known_by_a_pixel_and_not_closed():
    """A left pixel at 5, 2 px of disparity: the right view has its own at 3."""
    for right_px, kept in ((3, True), (3.0625, False), (2, True), (1, True), (0.9375, False)):
        left, right = of(*[None] * 8), of(*[None] * 8)
        left[0, 5], right[0, 3] = 2 * PX, round(right_px * PX)
        found = reconcile(left, right)
        assert left[0, 5] == found[0, 5] == (2 * PX if kept else UNKNOWN)
    for disparity_px, at in ((1.4375, 4), (1.5, 3), (-0.5, 5), (-0.5625, 6)):
        for place in range(8):
            left, right = of(*[None] * 8), of(*[None] * 8)
            left[0, 5], right[0, place] = round(disparity_px * PX), 90 * PX
            reconcile(left, right)
            assert (left[0, 5] == UNKNOWN) == (place == at)
    left, right = np.full((3, 12), 2 * PX, np.int16), np.full((3, 12), 2 * PX, np.int16)
    left[1, 8] = 5 * PX
    found = reconcile(left, right)
    assert found[1, 8] == left[1, 8] == UNKNOWN
    assert np.count_nonzero(found == UNKNOWN) == 1


def test_gaps_take_the_nearest_surface_and_confidence_falls_to_a_pixel():
    """Right pixels 1 and 0 both see left pixel 4, at 3 and at 4 px; where the left one has a match it stays."""
    right = of(4, 3, 3, 1, None, 3)
    left = of(None, None, None, None, None, 2.5)
    found = reconcile(left, right)
    assert np.array_equal(found, of(None, None, None, None, 4, 2.5))
    assert np.array_equal(left, of(None, None, None, None, None, 2.5))
    for disparity_px, at in ((1.4375, 2), (1.5, 3), (-0.5, 1), (-0.5625, 0)):
        found = reconcile(of(None, None, None, None), of(None, disparity_px, None, None))
        assert np.flatnonzero(found[0] != UNKNOWN).tolist() == [at]
    left = np.float32([[0, 0, 2, 2, 2, 2]])
    right = np.float32([[2, 2.25, 3, 1.5, 0, 0]])
    assert left_right_confidence(left, right).tolist() == [[0, 0, 1, 0.75, 0, 0.5]]
    beyond = np.float32([[0, 0, 0, -0.5]])
    assert left_right_confidence(beyond, beyond).tolist() == [[1, 1, 1, 0]]
    left = np.float32([[1, np.nan, 3, -2, -1]])
    right = np.float32([[1, 1, np.nan, 1, -1]])
    assert left_right_confidence(left, right).tolist() == [[0, 0, 0, 0, 0]]
    assert left_right_confidence(np.float32([[0, 1]]), np.float32([[np.nan, 1]])).tolist() == [[0, 0]]


@pytest.mark.parametrize("table", [OF_FILLED, OF_MATCHED])
def test_probability_is_read_between_the_places_of_its_table(table):
    places, probabilities = (np.array(each) for each in table)
    assert np.allclose(probability(places.astype(np.float32)), probabilities, atol=1e-6)
    between = (places[1:] + places[:-1]) / 2
    assert np.allclose(probability(between.astype(np.float32)), np.convolve(probabilities, [0.5, 0.5])[1:-1], atol=1e-4)
