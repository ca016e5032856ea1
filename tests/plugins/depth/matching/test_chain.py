"""The steps after matching, one by one: else specks are felt as needles, and edges and gaps at wrong depths."""

from collections import deque

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays

from tangible_core.compiled import threads
from tangible_depth.dense.confidence import confidence, flat_pixels
from tangible_depth.dense.filling.eight_directions import fill_from_eight_directions
from tangible_depth.dense.filling.four_directions import GEODESIC, choose_of_four, fill_from_four_directions
from tangible_depth.dense.refinement import DenseMatches, enlarge, median, to_disparity_map
from tangible_depth.dense.span import UNKNOWN
from tangible_depth.dense.speckles import Specks, remove_speckles, remove_specks
from tangible_depth.sgm.strips import equiangular
from tangible_depth.windows.correlation import parabola

MAPS = arrays(
    np.int16, st.tuples(st.integers(1, 40), st.integers(1, 12)), elements=st.sampled_from([-32768, 0, 16, 40, 48])
)


@given(st.floats(-0.5, 0.5), st.floats(0.1, 100), st.floats(-100, 100))
def test_parabola_and_v_through_samples_give_their_vertex_and_tip(vertex, bend, level):
    samples = [bend * (x - vertex) ** 2 + level for x in (-1, 0, 1)]
    assert parabola(*samples) == pytest.approx(vertex, abs=1e-6)
    assert parabola(*[-sample for sample in samples]) == pytest.approx(vertex, abs=1e-6)
    assert equiangular(*[bend * abs(x - vertex) + level for x in (-1, 0, 1)]) == pytest.approx(vertex, abs=1e-6)


def islands(disparity, step):
    """Connected regions by plain flooding: a label for each pixel, -1 where unknown."""
    label = np.full(disparity.shape, -1)
    for seed in np.ndindex(disparity.shape):
        if disparity[seed] == UNKNOWN or label[seed] >= 0:
            continue
        label[seed] = label.max() + 1
        queue = deque([seed])
        while queue:
            y, x = queue.popleft()
            for v, u in ((y - 1, x), (y + 1, x), (y, x - 1), (y, x + 1)):
                inside = 0 <= v < disparity.shape[0] and 0 <= u < disparity.shape[1]
                if not inside or label[v, u] >= 0 or disparity[v, u] == UNKNOWN:
                    continue
                if abs(int(disparity[v, u]) - int(disparity[y, x])) <= step:
                    label[v, u] = label[y, x]
                    queue.append((v, u))
    return label


@given(MAPS, st.integers(0, 9))
def test_speckle_filter_removes_small_islands(disparity, largest):
    label = islands(disparity, 16)
    small = [i for i in range(label.max() + 1) if (label == i).sum() <= largest]
    expected = np.where(np.isin(label, small), UNKNOWN, disparity)
    cleaned = disparity.copy()
    assert remove_speckles(cleaned, largest, 16) == np.isin(label, small).sum()
    assert np.array_equal(cleaned, expected)


@pytest.mark.parametrize("turned", [False, True])
def test_island_of_steps_of_a_whole_pixel_is_one(turned: bool):
    for apart, left in ((16, 12), (17, 0)):
        disparity = np.arange(0, 12 * apart, apart, dtype=np.int16)[None]
        disparity = np.ascontiguousarray(disparity.T if turned else disparity)
        remove_speckles(disparity, 11)
        assert np.count_nonzero(disparity != UNKNOWN) == left


@pytest.mark.parametrize(("far_px", "alone_px", "left"), [(50, 60, 0), (50, 100, 0), (80, 60, 80), (80, 100, 0)])
def test_island_is_removed_by_size_and_share_of_matches_near_it(far_px: int, alone_px: int, left: int):
    disparity = np.full((100, 300), UNKNOWN)
    disparity[:, :150] = 100
    island = np.s_[40:50, : far_px // 10]
    for x0, here in ((60, 300), (230, 300)):
        disparity[:, x0 : x0 + 150][island] = here
    remove_specks(disparity, Specks(20, 60, alone_px))
    assert np.count_nonzero(disparity[:, :150] == 300) == far_px
    assert np.count_nonzero(disparity[:, 200:] == 300) == left


@pytest.mark.parametrize("fill", [fill_from_four_directions, fill_from_eight_directions])
def test_filling_with_any_number_of_threads_is_the_same(fill, monkeypatch):
    rng = np.random.default_rng(3)
    disparity = np.where(rng.random((130, 70)) < 0.6, UNKNOWN, rng.integers(0, 900, (130, 70))).astype(np.int16)
    disparity[40:80] = UNKNOWN
    grey = rng.integers(0, 255, disparity.shape, np.uint8)
    maps = []
    for count in (1, 2, 7):
        monkeypatch.setattr(threads, "thread_count", lambda count=count: count)
        maps.append(fill(disparity, grey))
    assert np.array_equal(maps[0], maps[1])
    assert np.array_equal(maps[0], maps[2])


def score(value, path, farthest, row_farthest, there):
    """Score a candidate by the docstring of `candidates`; disparities and `there` in sixteenths of a pixel."""
    seen = -1.4 if there is None else 0.75 if there == 32767 else -3.4 * (there < value - 24)
    return 0.7 * (value <= row_farthest + 8) + seen - 0.18 * np.sqrt(path) - 0.3 * (value - farthest) / 160


def test_gap_takes_the_candidate_of_the_best_score():
    """Behind which every weight stands: drawn at random, and nothing said where two are as good as alike."""
    random = np.random.default_rng(6)
    width, told = 60, 0
    for _ in range(3000):
        x = int(random.integers(20, 40))
        values = random.choice([16, 32, 64, 70, 72, 96, 120, 200, 320], 5).astype(np.int16)
        values[random.random(5) < 0.2] = UNKNOWN
        paths = random.integers(0, 150, 5).astype(np.int32) * random.integers(0, 2, 5).astype(np.int32)
        seen = random.choice([UNKNOWN, 16, 96, 100, 200, 330, 32767], width + 2).astype(np.int16)
        seen[0] = seen[-1] = 32767
        chosen = choose_of_four(values[:, None].repeat(width, 1), paths[:, None].repeat(width, 1), x, seen)
        known = values[values != UNKNOWN].astype(int)
        if known.size == 0:
            assert chosen == UNKNOWN
            continue
        row = values[:2][values[:2] != UNKNOWN].astype(int)
        if np.ptp(known) <= 24:
            assert chosen == (row if row.size else known).min()
            continue
        row_farthest = row.min() if row.size else 32767
        scores = {}
        for side, (value, path) in enumerate(zip(values.tolist(), paths.tolist(), strict=True)):
            if value != UNKNOWN:
                there = seen[min(max(x + 1 - (value + 8) // 16, 0), width + 1)]
                found = score(value, path, known.min(), row_farthest, None if there == UNKNOWN else int(there))
                found -= 1.0 * (side == GEODESIC)
                scores[value] = max(found, scores.get(value, -np.inf))
        best, *others = sorted(scores, key=scores.__getitem__, reverse=True)
        if others and scores[best] - scores[others[0]] > 1e-3:
            assert chosen == best
            told += 1
    assert told > 2000


@pytest.mark.parametrize("mirrored", [False, True])
@pytest.mark.parametrize(("gap", "filled_in"), [(1, 64), (2, 64), (3, 0)])
def test_short_gap_between_similar_ends_takes_the_farther(gap, filled_in, mirrored):
    disparity = np.zeros((9, 40), np.int16)
    disparity[4] = 80
    disparity[4, :20] = 64
    disparity[4, 20 : 20 + gap] = UNKNOWN
    grey = np.full(disparity.shape, 100, np.uint8)
    grey[4, 20 + gap :] = 200  # the right end lies behind an edge
    grey[4, :20] = 0
    row = np.s_[4, 20 : 20 + gap]
    if mirrored:
        disparity, grey, row = disparity[:, ::-1].copy(), grey[:, ::-1].copy(), np.s_[4, 20 - gap : 20]
    assert (fill_from_four_directions(disparity, grey)[row] == filled_in).all()


@pytest.mark.parametrize(("left", "right", "levels", "near"), [(320, 64, 60, [0, 1, 2, 3]), (64, 320, 120, [11])])
def test_grey_steps_on_a_path_add_up(left, right, levels, near):
    """A gap of twelve columns over stripes: beside it alone the nearer end is believed in."""
    disparity = np.full((1, 90), right, np.int16)
    disparity[:, :40], disparity[:, 40:52] = left, UNKNOWN
    grey = np.where(np.arange(90) % 2, 100, 100 + levels).astype(np.uint8)[None]
    assert np.flatnonzero(fill_from_four_directions(disparity, grey)[0, 40:52] == 320).tolist() == near


def test_median_and_flat_pixels_are_of_the_nearest_values():
    disparity = np.random.default_rng(0).integers(0, 900, (40, 30)).astype(np.int16)
    windows = np.lib.stride_tricks.sliding_window_view(np.pad(disparity, 2, mode="edge"), (5, 5))
    assert np.array_equal(median(disparity), np.median(windows, axis=(2, 3)).astype(np.int16))
    grey = np.full((12, 12), 7, np.uint8)
    grey[6, 6] = 8
    assert np.array_equal(flat_pixels(grey), np.maximum(*np.abs(np.indices(grey.shape) - 6)) > 2)
    grey = np.full((9, 12), 40, np.uint8)
    grey[:, 8:] = np.arange(4) * 20
    dense = DenseMatches(np.full(grey.shape, np.int16(40)), np.full(grey.shape, np.float32(0.7)))
    for fill in (True, False):
        found = to_disparity_map(dense, grey, fill)
        assert np.array_equal(found.confidence > 0, ~flat_pixels(grey))
        assert np.array_equal(np.isnan(found.disparity_px), flat_pixels(grey) & (not fill))


def test_confidence_is_of_the_table_and_falls_next_to_steps():
    matched = np.full((1, 60), 160, np.int16)
    table = 1 - np.arange(256) / 255
    quality = np.tile(np.array([0, 51, 255], np.uint8), 20)[None]
    assert np.allclose(confidence(matched, matched + np.int16(10), quality, table), np.tile([1, 0.8, 0], 20))
    assert np.allclose(confidence(matched, matched - np.int16(16), quality, table), np.tile([1, 0.8, 0], 20))
    assert np.allclose(confidence(matched, matched + np.int16(17), quality, table), 0.1)
    nothing = np.full((1, 60), UNKNOWN)
    assert confidence(nothing, nothing, quality, table).max() <= 0.1
    matched = np.full((40, 90), 160, np.int16)
    matched[:, 60:] = 160 + 16 * 8
    final = matched.copy()
    matched[:, :20] = UNKNOWN
    found = confidence(matched, final, np.zeros(matched.shape, np.uint8), np.ones(256))
    column = found[20]
    assert np.array_equal(found, np.tile(column, (40, 1)))
    missing = np.clip((25 - np.arange(90)) / 11, 0, 1)
    expected = np.where(np.arange(90) < 20, 0.1, 0.8) * (1 - 0.6 * missing) + np.where(np.arange(90) < 20, 0, 0.2)
    expected[57:63] = 0.2 + 0.8 / 3  # the step of 8 px is seen from here
    assert np.allclose(column, expected, atol=0.003)


def test_plane_is_enlarged_and_turned_into_pixels_exactly():
    y, x = np.indices((20, 30))
    small = (4 * x + 2 * y + 100).astype(np.int16)
    large = enlarge(DenseMatches(small, np.ones(small.shape, np.float32)), np.full((39, 60), 9, np.uint8))
    rows, columns = np.indices((39, 60))
    exact = 2 * (4 * (columns - 0.5) / 2 + 2 * (rows - 0.5) / 2 + 100)
    assert np.abs(large.disparity - exact)[1:-1, 1:-1].max() <= 1
    assert large.confidence.shape == (39, 60)
    for apart, beside in ((16, [208, 216, 232, 240]), (17, [208, 208, 242, 242])):
        small = np.full((4, 6), np.int16(104))
        small[:, 3:] += np.int16(apart)
        large = enlarge(DenseMatches(small, np.ones(small.shape, np.float32)), np.full((8, 12), 9, np.uint8))
        assert large.disparity[4, 4:8].tolist() == beside
    for value, largest in ((20000, 32767), (-20000, -32767), (-16384, -32767), (-16383, -32766)):
        small = DenseMatches(np.full((4, 6), np.int16(value)), np.ones((4, 6), np.float32))
        assert (enlarge(small, np.full((8, 12), 9, np.uint8)).disparity == largest).all()
    grey = np.random.default_rng(0).integers(0, 255, (6, 6), np.uint8)
    disparity = np.full((6, 6), 40, np.int16)
    disparity[0] = UNKNOWN
    trust = np.full((6, 6), 0.7, np.float32)
    trust[1] = 0.1
    filled, bare = (to_disparity_map(DenseMatches(disparity, trust), grey, fill) for fill in (True, False))
    assert np.isnan(filled.disparity_px[0]).all()
    assert (filled.disparity_px[1:] == 2.5).all()
    assert np.isnan(bare.disparity_px[:2]).all()
    assert (bare.confidence[:2] == 0).all()
