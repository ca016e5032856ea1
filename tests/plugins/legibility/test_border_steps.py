"""Borders felt as steps: if a case fails, a surface is judged by steps that a finger does not feel."""

from math import isnan
from statistics import NormalDist

import numpy as np
import pytest

from tangible_core.data import Relief
from tangible_core.errors import PictureError
from tangible_legibility.neighbours import border_steps, felt_steps

PITCH_M = 0.0001
SKIN_M = 0.0005


def steps_at(*places_m: float, height_m: float, width_m: float = 0.04, rows: int = 60) -> Relief:
    """Terraces, each so much higher than the one left of it."""
    columns = round(width_m / PITCH_M)
    x_m = (np.arange(columns) + 0.5) * PITCH_M
    profile = height_m * (x_m[:, None] > np.asarray(places_m)).sum(axis=1)
    return Relief(np.tile(profile, (rows, 1)).astype(np.float32), (width_m, rows * PITCH_M))


def halves(relief: Relief, at_m: float) -> np.ndarray:
    """Two parts with a border from top to bottom."""
    columns = relief.height_m.shape[1]
    return np.broadcast_to((np.arange(columns) + 0.5) * PITCH_M > at_m, relief.height_m.shape).astype(np.int32)


def half_width_m(height_m: float) -> float:
    """Return the distance from a step within which it is found: the blurred step rises by 0.5 mm within 2 mm there."""
    skin = NormalDist(0, SKIN_M)
    x_m = np.linspace(0, 0.004, 4001)
    rise = [height_m * (skin.cdf(x + 0.001) - skin.cdf(x - 0.001)) for x in x_m]
    return float(x_m[np.flatnonzero(np.asarray(rise) >= 0.0005)[-1]])


@pytest.mark.parametrize("height_m", [0.00055, 0.002])
def test_step_at_a_border_is_found_at_that_border(height_m):
    relief = steps_at(0.02, height_m=height_m)
    found = border_steps(relief, halves(relief, 0.02))
    assert found["borders_found"] == 1
    assert found["area_stepped"] == pytest.approx(2 * half_width_m(height_m) / 0.04, abs=2 * PITCH_M / 0.04)
    assert found["steps_at_borders"] == 1


def test_low_step_is_not_found():
    relief = steps_at(0.02, height_m=0.00049)
    found = border_steps(relief, halves(relief, 0.02))
    assert (found["borders_found"], found["area_stepped"]) == (0, 0)
    assert isnan(found["steps_at_borders"])


def test_steep_slope_is_a_step_and_a_gentle_one_is_not():
    ramp = np.tile(np.arange(400) * PITCH_M, (60, 1))
    felt, gentle = (felt_steps(Relief((ramp * slope).astype(np.float32), (0.04, 0.006))) for slope in (0.26, 0.24))
    assert felt[:, 50:-50].all()
    assert not gentle.any()


def test_step_further_than_2_mm_from_a_border_does_not_belong_to_it():
    relief = steps_at(0.02, height_m=0.001)
    reach = half_width_m(0.001)
    assert border_steps(relief, halves(relief, 0.02 + 0.002 + reach + 0.0002))["steps_at_borders"] == 0
    assert border_steps(relief, halves(relief, 0.02 + 0.002 - reach - 0.0002))["steps_at_borders"] == 1
    assert border_steps(relief, halves(relief, 0.02 + 0.002))["steps_at_borders"] == pytest.approx(0.5, abs=0.06)


@pytest.mark.parametrize("tall", [1, 10])
def test_borders_are_counted_by_their_length(tall):
    """A border at a step is 60 cells high and 200 wide, one without a step 100 cells high; cells are not squares."""
    height_m = np.zeros((100, 400), np.float32)
    height_m[:60, 200:] = 0.002
    labels = np.zeros(height_m.shape, np.int32)
    labels[:60, 200:] = 1
    labels[:, :30] = 2
    found = border_steps(Relief(height_m, (0.04, 0.01 * tall)), labels)
    assert found["borders_found"] == pytest.approx((60 * tall + 200) / (60 * tall + 200 + 100 * tall))


@pytest.mark.parametrize("turned", [False, True])
@pytest.mark.parametrize("times", [(1, 4), (4, 1)])
def test_shares_depend_on_metres_and_not_on_pixels(times: tuple[int, int], turned: bool):
    relief = steps_at(0.01, 0.03, height_m=0.001)
    labels = halves(relief, 0.01)
    if turned:
        relief, labels = Relief(np.ascontiguousarray(relief.height_m.T), relief.extent_m[::-1]), labels.T
    finer = Relief(relief.height_m.repeat(times[0], axis=0).repeat(times[1], axis=1), relief.extent_m)
    found = border_steps(finer, np.ascontiguousarray(labels.repeat(times[0], axis=0).repeat(times[1], axis=1)))
    assert found == pytest.approx(border_steps(relief, np.ascontiguousarray(labels)), abs=0.01)


def test_labels_of_another_size_are_refused():
    with pytest.raises(PictureError, match=r"\(1, 2\)"):
        border_steps(Relief(np.zeros((1, 3), np.float32), (0.08, 0.08)), np.zeros((1, 2), np.int32))
