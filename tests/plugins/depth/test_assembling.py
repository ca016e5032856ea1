import numpy as np
import pytest

from tangible_depth.assembling import assemble, fill_nearest, without_speckles

SHAPE = (30, 40)


def scattered(values, every=4):
    found = np.full(SHAPE, np.nan, np.float32)
    found[::every, ::every] = values[::every, ::every]
    return found, np.where(np.isfinite(found), 0.9, 0).astype(np.float32)


def test_one_disparity_everywhere_is_found_everywhere():
    filled = assemble(*scattered(np.full(SHAPE, 7.25)), np.zeros(SHAPE, np.uint8))
    assert filled.disparity_px == pytest.approx(7.25, abs=1e-4)


def test_colour_edges_divide_and_rows_and_columns_fill():
    step = np.where(np.arange(40) < 20, 5.0, 15.0) * np.ones((30, 1))
    picture = np.where(step == 5, 30, 220).astype(np.uint8)
    filled = assemble(*scattered(step), picture)
    assert np.abs(filled.disparity_px - step).max() < 0.1


def test_a_stray_match_is_left_out():
    found, score = scattered(np.full(SHAPE, 7.0))
    found[16, 20] = 30
    filled = assemble(found, score, np.zeros(SHAPE, np.uint8))
    assert filled.disparity_px == pytest.approx(7, abs=1e-4)


def test_confidence_is_the_score_at_a_match_and_less_elsewhere():
    found, score = scattered(np.full(SHAPE, 7.0), every=10)
    confidence = assemble(found, score, np.zeros(SHAPE, np.uint8)).confidence
    assert confidence[10, 10] == pytest.approx(0.9)
    assert confidence[0, 0] == pytest.approx(0.9)
    assert 0 < confidence[15, 15] < 0.9
    assert confidence.min() >= 0


def test_without_any_match_all_is_unknown():
    nothing = assemble(np.full(SHAPE, np.nan, np.float32), np.zeros(SHAPE, np.float32), np.zeros(SHAPE, np.uint8))
    assert np.isnan(nothing.disparity_px).all()
    assert not nothing.confidence.any()


@pytest.mark.parametrize("shape", [(1, 1), (1, 7), (7, 1), (2, 2)])
def test_the_smallest_pictures(shape):
    filled = assemble(np.full(shape, 3, np.float32), np.ones(shape, np.float32), np.zeros((*shape, 4), np.uint16))
    assert np.all(filled.disparity_px == 3)


def test_fill_nearest():
    values = np.array([[np.nan, 1, np.nan, np.nan, 5]], np.float32)
    assert fill_nearest(values).tolist() == [[1, 1, 1, 5, 5]]
    assert fill_nearest(np.ones((2, 2), np.float32)).tolist() == [[1, 1], [1, 1]]


def test_small_islands_go_and_large_ones_stay():
    disparity = np.full(SHAPE, np.nan, np.float32)
    disparity[:10, :10] = 5.5
    disparity[20:22, 20:22] = -3.5
    left = without_speckles(disparity)
    assert np.all(left[:10, :10] == 5.5)
    assert np.isnan(left[10:]).all()
