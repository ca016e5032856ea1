"""The filter of a film in time: what flickers is felt as a buzz, and what moved leaves a trail."""

import numpy as np
import pytest

from tangible_core.data import DisparityMap
from tangible_core.session.film import Steady
from tangible_core.session.film.steady import GATE_PX, MAX_DOUBTS, MAX_MISSING

FLAT = np.full((6, 8), 10, np.float32)


def filter_maps(*maps, unit="px"):
    """Return the filtered maps of consecutive maps."""
    steady = Steady()
    return [steady.next(DisparityMap(np.float32(each), unit=unit)).disparity.disparity_px for each in maps]


def at(value, where=(2, 3)):
    """Return flat ground with one other pixel."""
    made = FLAT.copy()
    made[where] = value
    return made


def test_error_of_one_frame_is_filtered_out():
    felt = filter_maps(FLAT, at(40), FLAT, FLAT)
    assert all(np.array_equal(each, FLAT) for each in felt)


def test_change_is_adopted_at_the_second_frame_without_a_trail():
    felt = [filter_map[2, 3] for filter_map in filter_maps(FLAT, at(20), at(20.5), at(20.5), FLAT, FLAT, FLAT)]
    assert felt[:3] == [10, 10, 20.5]
    assert felt[4] == 20.5, "seen once"
    assert felt[5:] == [10, 10]


def test_value_that_changes_in_each_frame_is_adopted_after_a_few():
    felt = [filter_map[2, 3] for filter_map in filter_maps(*(at(10 + 5 * number) for number in range(9)))]
    assert all(abs(value - (10 + 5 * number)) <= 5 * MAX_DOUBTS for number, value in enumerate(felt))
    assert felt[-1] >= 40


def test_noise_is_averaged():
    generator = np.random.default_rng(1)
    maps = [FLAT + generator.normal(0, 0.2, FLAT.shape) for _ in range(60)]
    flicker = np.diff(np.stack(filter_maps(*maps)[10:]), axis=0).std()
    assert flicker < 0.3 * np.diff(np.stack(maps[10:]), axis=0).std()


def test_flickering_hole_is_filled_and_lasting_hole_stays():
    flickers = filter_maps(FLAT, at(np.nan), FLAT, at(np.nan), at(np.nan), FLAT)
    assert all(np.array_equal(flicker, FLAT) for flicker in flickers)
    stays = [filter_map[2, 3] for filter_map in filter_maps(FLAT, *[at(np.nan)] * (MAX_MISSING + 2))]
    assert np.isfinite(stays[: MAX_MISSING + 1]).all()
    assert np.isnan(stays[MAX_MISSING + 1 :]).all()


def test_unknown_value_must_be_seen_twice():
    felt = [filter_map[2, 3] for filter_map in filter_maps(at(np.nan), at(30), at(np.nan), at(12), at(12))]
    assert np.isnan(felt[:4]).all()
    assert felt[4] == 12


def test_cut_adopts_the_second_frame_as_a_whole():
    steady, other = Steady(), FLAT + 25
    generator = np.random.default_rng(2)
    noisy = other + generator.normal(0, 2, FLAT.shape).astype(np.float32)
    felt = [steady.next(DisparityMap(each)) for each in (FLAT, other, noisy, noisy)]
    assert [each.cut for each in felt] == [False, False, True, False]
    assert np.array_equal(felt[1].disparity.disparity_px, FLAT), "a flash of one frame is not felt"
    assert np.array_equal(felt[2].disparity.disparity_px, noisy), "no pixel of the scene before it is left"


def test_value_that_differs_by_the_gate_is_noise():
    felt = [filter_map[2, 3] for filter_map in filter_maps(FLAT, at(10 + GATE_PX), FLAT, at(10.18 + GATE_PX))]
    assert felt == pytest.approx([10, 10.2, 10.16, 10.16])


@pytest.mark.parametrize(("columns", "cut"), [(4, False), (5, True)])
def test_change_of_half_the_picture_is_no_cut(columns, cut):
    steady, other = Steady(), FLAT.copy()
    other[:, :columns] = 40
    felt = [steady.next(DisparityMap(each)) for each in (FLAT, other, other)]
    assert [each.cut for each in felt] == [False, False, cut]


def test_relative_map_has_a_gate_relative_to_its_range():
    ramp = np.linspace(0, 1, 48, dtype=np.float32).reshape(6, 8)
    felt = filter_maps(ramp, ramp + np.float32(0.02), ramp + np.float32(0.2), unit="relative")
    assert np.allclose(felt[1], ramp + 0.004, atol=1e-6), "noise is averaged"
    assert np.allclose(felt[2], felt[1]), "what is more is not believed at once"


def test_frame_of_another_size_restarts_the_filter():
    steady = Steady()
    steady.next(DisparityMap(FLAT))
    found = steady.next(DisparityMap(FLAT[:3] + 5))
    assert found.cut and np.array_equal(found.disparity.disparity_px, FLAT[:3] + 5)
