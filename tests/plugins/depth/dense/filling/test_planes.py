"""Gaps that go on as the surfaces round them lie."""

import numpy as np
import pytest

from tangible_depth.dense.filling.eight_directions import fill_from_eight_directions
from tangible_depth.dense.filling.planes import fit_planes
from tangible_depth.dense.span import UNKNOWN

SHAPE = (80, 96)
Y, X = np.indices(SHAPE)


def completed(disparity: np.ndarray, grey: np.ndarray) -> np.ndarray:
    """Filled, and laid on planes."""
    return fit_planes(disparity, fill_from_eight_directions(disparity, grey), grey)


def plane(across: float, down: float, offset: float = 400.0) -> np.ndarray:
    """Disparity in sixteenths of a pixel, with these slopes, in sixteenths a pixel."""
    return np.rint(offset + across * X + down * Y).astype(np.int16)


@pytest.mark.parametrize(("across", "down"), [(1.0, 0.0), (0.0, -1.2), (0.7, 0.9), (-1.1, 0.4)])
@pytest.mark.parametrize("gap", [np.s_[30:50, 40:60], np.s_[:, 84:], np.s_[:12, :12]])
def test_a_gap_in_a_slanted_plane_is_slanted(across: float, down: float, gap: tuple[slice, slice]):
    """Inside, along a border and in a corner, beyond what is known: a third of a pixel off, not one."""
    truth, grey = plane(across, down), np.full(SHAPE, 90, np.uint8)
    disparity = truth.copy()
    disparity[gap] = UNKNOWN
    found = completed(disparity, grey)
    assert np.abs(found.astype(int) - truth)[gap].max() <= 5
    known = disparity != UNKNOWN
    assert np.array_equal(found[known], truth[known])


def test_a_flat_surface_stays_flat_to_the_sixteenth():
    disparity = np.full(SHAPE, np.int16(160))
    disparity[20:60, 30:70] = UNKNOWN
    assert (completed(disparity, np.zeros(SHAPE, np.uint8)) == 160).all()


def test_either_surface_goes_on_by_itself():
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
def test_no_value_is_out_of_bounds(value: int):
    """Neither at the ends of 16 bits, where UNKNOWN is near, nor in a picture smaller than the samples' step."""
    for shape in ((1, 1), (1, 9), (3, 2), (30, 40)):
        disparity = np.full(shape, UNKNOWN)
        disparity[0, 0] = value
        filled = np.full(shape, np.int16(value))
        assert np.array_equal(fit_planes(disparity, filled, np.zeros(shape, np.uint8)), filled)


def test_what_stays_unknown_stays_so():
    unknown = np.full((9, 9), UNKNOWN)
    assert (fit_planes(unknown, unknown, np.zeros((9, 9), np.uint8)) == UNKNOWN).all()
