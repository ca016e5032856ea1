"""Gaps that go on as the surfaces round them lie."""

import numpy as np
import pytest

from tangible_depth.dense.filling.gaps import fill_gaps
from tangible_depth.dense.filling.planes import fit_planes
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
    """Gaps inside, along a border and in a corner: a third of a pixel off, not one."""
    truth, grey = plane(across, down), np.full(SHAPE, 90, np.uint8)
    disparity = truth.copy()
    disparity[gap] = UNKNOWN
    found = fill_on_planes(disparity, grey)
    assert np.abs(found.astype(int) - truth)[gap].max() <= 5
    known = disparity != UNKNOWN
    assert np.array_equal(found[known], truth[known])


def test_flat_surface_stays_flat_to_the_sixteenth():
    disparity = np.full(SHAPE, np.int16(160))
    disparity[20:60, 30:70] = UNKNOWN
    assert (fill_on_planes(disparity, np.zeros(SHAPE, np.uint8)) == 160).all()


def test_each_surface_continues_on_its_own_plane():
    """Two that lie one behind the other and are told apart by their disparity; two by their grey alone."""
    for step, darker in ((80, 0), (24, 80)):
        left = X < 48
        truth = np.where(left, plane(1.0, 0.0), plane(-1.0, 0.5, 400.0 + step + 96))
        grey = np.where(left, 90, 90 + darker).astype(np.uint8)
        gap = np.zeros(SHAPE, bool)
        gap[30:46, 30:46] = gap[30:46, 50:66] = True
        nearest = np.where(left, truth[:, 29:30], truth[:, 66:67])
        filled = np.where(gap, nearest, truth).astype(np.int16)
        found = fit_planes(np.where(gap, UNKNOWN, truth), filled, grey)
        assert np.abs(found.astype(int) - truth)[gap].max() <= 5


@pytest.mark.parametrize("value", [-32767, -31990, 0, 31990, 32767])
def test_values_stay_within_16_bits(value: int):
    """Test the ends of 16 bits, next to UNKNOWN, and a picture smaller than the samples' step."""
    for shape in ((1, 1), (1, 9), (3, 2), (30, 40)):
        disparity = np.full(shape, UNKNOWN)
        disparity[0, 0] = value
        filled = np.full(shape, np.int16(value))
        assert np.array_equal(fit_planes(disparity, filled, np.zeros(shape, np.uint8)), filled)


def test_unknown_values_stay_unknown():
    unknown = np.full((9, 9), UNKNOWN)
    assert (fit_planes(unknown, unknown, np.zeros((9, 9), np.uint8)) == UNKNOWN).all()


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
