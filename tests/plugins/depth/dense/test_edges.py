"""Depth edges moved to the edges of the picture, against the votes written out plainly."""

import numpy as np
import pytest

from tangible_depth.dense.edges import sharpen_edges


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
        weights = np.array([max(24 - abs(greys[each] - greys[y, x]), 0) for each in voters])
        theirs = np.array([values[each] for each in voters])
        front = theirs > middle
        ahead = weights[front].sum() - weights[~front].sum()
        if ahead != 0 and (ahead > 0) != (values[y, x] > middle):
            side = front == (ahead > 0)
            out[y, x] = (weights * theirs)[side].sum() // weights[side].sum()
    return out


@pytest.mark.parametrize("greys", [[90], [0, 7, 20], [0, 10, 40, 255]])
@pytest.mark.parametrize("disparities", [[-31, 0, 24, 331], [-720, -413, -400, -376], [-32000, 31999]])
def test_edges_of_any_map_move_as_the_votes_say(disparities: list[int], greys: list[int]):
    """Of either sign, up to the border, with ties and with steps of exactly the least height."""
    random = np.random.default_rng(2)
    for shape in ((11, 14), (9, 3), (1, 8)):
        disparity = random.choice(disparities, shape).astype(np.int16)
        grey = random.choice(greys, shape).astype(np.uint8)
        assert np.array_equal(sharpen_edges(disparity, grey), written_out(disparity, grey))


def test_pixel_whose_votes_are_equal_stays_where_it_is():
    disparity = np.where(np.indices((12, 12))[0] < 3, 320, 64).astype(np.int16)
    assert np.array_equal(sharpen_edges(disparity, np.full((12, 12), 90, np.uint8))[:, 6], disparity[:, 6])
