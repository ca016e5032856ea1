"""Gaps against the scores written out: else what no camera saw is felt at a wrong depth."""

import numpy as np
import pytest

from tangible_depth.dense.filling.candidates import geodesic_candidates
from tangible_depth.dense.filling.eight_directions import fill_from_eight_directions
from tangible_depth.dense.filling.four_directions import fill_from_four_directions
from tangible_depth.dense.filling.gaps import fill_gaps, fit_planes
from tangible_depth.dense.span import UNKNOWN

SHAPE = (80, 96)
Y, X = np.indices(SHAPE)


def fill_on_planes(disparity: np.ndarray, grey: np.ndarray) -> np.ndarray:
    """Fill a map and fit planes."""
    return fill_gaps(disparity, grey, "best")


def plane(across: float, down: float, offset: float = 400.0) -> np.ndarray:
    """Disparity in sixteenths of a pixel, with these slopes, in sixteenths a pixel."""
    return np.rint(offset + across * X + down * Y).astype(np.int16)


@pytest.mark.parametrize(("across", "down"), [(1.0, 0.0), (0.0, -1.2), (0.7, 0.9), (-1.1, 0.4)])
@pytest.mark.parametrize("gap", [np.s_[30:50, 40:60], np.s_[:, 84:], np.s_[:12, :12]])
def test_gap_in_a_slanted_plane_is_slanted(across: float, down: float, gap: tuple[slice, slice]):
    truth, grey = plane(across, down), np.full(SHAPE, 90, np.uint8)
    disparity = truth.copy()
    disparity[gap] = UNKNOWN
    found = fill_on_planes(disparity, grey)
    assert np.abs(found.astype(int) - truth)[gap].max() <= 5
    known = disparity != UNKNOWN
    assert np.array_equal(found[known], truth[known])


@pytest.mark.parametrize("value", [-32767, -31990, 0, 31990, 32767])
def test_values_stay_within_16_bits(value: int):
    """Test the ends of 16 bits, next to UNKNOWN, and a picture smaller than the samples' step."""
    for shape in ((1, 1), (1, 9), (3, 2), (30, 40)):
        disparity = np.full(shape, UNKNOWN)
        disparity[0, 0] = value
        filled = np.full(shape, np.int16(value))
        assert np.array_equal(fit_planes(disparity, filled, np.zeros(shape, np.uint8)), filled)


def written_out(disparity: np.ndarray, grey: np.ndarray, y: int, x: int, value: int) -> float:
    """Return the plane at (y, x) through every fourth pixel within 12 of its cell that is like it, with a ridge."""
    found = []
    for row, column in np.ndindex(disparity[2::4, 2::4].shape):
        v, u = 4 * row + 2, 4 * column + 2
        j, i = 2 * (row - y // 4) + 1, 2 * (column - x // 4) + 1  # half samples from the middle of the samples
        alike = abs(int(disparity[v, u]) - value) <= 36 and abs(int(grey[v, u]) - int(grey[y, x])) <= 30
        if abs(j) < 12 and abs(i) < 12 and disparity[v, u] != UNKNOWN and alike:
            found.append((i, j, int(disparity[v, u]) - value))
    if len(found) < 4:
        return value
    means = np.mean(found, axis=0)
    i, j, more = (np.array(found) - means).T
    spread = np.array([[np.mean(i * i) + 1, np.mean(i * j)], [np.mean(i * j), np.mean(j * j) + 1]])
    slopes = np.linalg.solve(spread, [np.mean(i * more), np.mean(j * more)])
    return value + means[2] + slopes @ (np.array([x % 4, y % 4]) / 2 - means[:2])


@pytest.mark.parametrize("share", [0.1, 0.8])
def test_planes_are_those_of_the_formula(share: float):
    """Values of a whole and of a negative map, at the ends of what counts, and where few samples are known."""
    random = np.random.default_rng(7)
    truth = random.choice([-136, -100, -64, -63, 300], (26, 39)).astype(np.int16)
    grey = random.choice([60, 90, 120, 121], truth.shape).astype(np.uint8)
    disparity = np.where(random.random(truth.shape) < share, truth, UNKNOWN)
    filled = np.where(disparity == UNKNOWN, np.int16(-100), disparity)
    found = fit_planes(disparity, filled, grey)
    gaps = disparity == UNKNOWN
    expected = [written_out(disparity, grey, y, x, -100) for y, x in zip(*np.nonzero(gaps), strict=True)]
    assert np.abs(found[gaps] - np.array(expected)).max() <= 0.5 + 1e-6
    assert np.array_equal(found[~gaps], disparity[~gaps])


@pytest.mark.parametrize(("count", "slanted"), [(3, False), (4, True)])
def test_four_samples_make_a_plane(count: int, slanted: bool):
    disparity = np.full((24, 24), UNKNOWN)
    for place, value in list(zip([(10, 10), (10, 18), (18, 10), (18, 18)], [90, 100, 110, 120], strict=True))[:count]:
        disparity[place] = value
    filled = np.where(disparity == UNKNOWN, np.int16(100), disparity)
    found = fit_planes(disparity, filled, np.zeros((24, 24), np.uint8))
    assert (len(np.unique(found[disparity == UNKNOWN])) > 1) == slanted


def test_gaps_take_the_best_candidate_and_maps_without_any_stay():
    grey = np.zeros((7, 9), np.uint8)
    for value in (UNKNOWN, np.int16(48)):
        disparity = np.full((7, 9), value)
        assert np.array_equal(fill_from_eight_directions(disparity, grey), disparity)
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


def corner() -> tuple[np.ndarray, np.ndarray]:
    """A dark wall, known above alone, that goes on at the left border below a near, light cloth that widens."""
    grey = np.full((30, 40), 20, np.uint8)
    disparity = np.full(grey.shape, np.int16(64))
    for y in range(6, 30):
        grey[y, max(4, 14 - y // 2) :] = 200
        disparity[y, max(4, 14 - y // 2) :] = 320
    disparity[:, :14] = UNKNOWN
    disparity[:6, 8:] = 64
    return disparity, grey


def test_path_follows_the_straight_surface_of_the_least_changes_however_long():
    disparity, grey = corner()
    found = geodesic_candidates(disparity, grey)
    wall = (grey == 20)[:, :14] & (np.arange(14) < found.first[:, None])
    assert (found.values[:, :14][wall] == 64).all()
    assert found.lengths[20, 2] == 15  # as many steps as there are rows to row 5, some of them slanting
    disparity = np.array([[UNKNOWN, UNKNOWN, UNKNOWN, 80, 80]], np.int16)
    found = geodesic_candidates(disparity, np.array([[10, 40, 35, 35, 0]], np.uint8))
    assert (found.first.tolist(), found.values[:, :3].tolist()) == ([3], [[80, 80, 80]])
    assert found.lengths[:, :3].tolist() == [[3 + 35, 2 + 5, 1]]
    disparity = np.array([[UNKNOWN, 16], [UNKNOWN, 32], [UNKNOWN, 48]], np.int16)
    assert geodesic_candidates(disparity, np.zeros((3, 2), np.uint8)).values[:, 0].tolist() == [16, 32, 48]
    disparity = np.full((1, 800), UNKNOWN)
    disparity[0, :200], disparity[0, 500:] = 16, 160
    grey = np.full((1, 800), 250, np.uint8)
    grey[0, :200], grey[0, 200:458] = 0, np.arange(258) % 2 * 255
    assert (fill_from_eight_directions(disparity, grey)[0, 460:500] == 160).all()


@pytest.mark.parametrize("filled", [fill_from_four_directions, fill_from_eight_directions])
def test_left_border_takes_the_surface_of_its_grey(filled):
    disparity, grey = corner()
    found = filled(disparity, grey)
    assert (found[:, :4][grey[:, :4] == 20] == 64).all()
