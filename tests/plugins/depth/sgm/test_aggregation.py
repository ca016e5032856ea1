"""The compiled sweep against semi-global matching written out plainly, to the last bit."""

import os

import numpy as np
import pytest

from stereo_scenes import step
from tangible_core.compiled.threads import thread_count
from tangible_depth.dense.span import UNKNOWN, Span
from tangible_depth.sgm import strips
from tangible_depth.sgm.census import census, census_with_levels
from tangible_depth.sgm.costs import LEVELS, SHARP, p2_by_grey_step
from tangible_depth.sgm.strips import sweep, unknown_matches


def plain_census(grey):
    """Bits of the 5 x 5 window, in any order: whether a neighbour is darker."""
    padded = np.pad(grey, 2, mode="edge")
    h, w = grey.shape
    around = [padded[dy : dy + h, dx : dx + w] for dy in range(5) for dx in range(5) if (dy, dx) != (2, 2)]
    return np.stack([each < grey for each in around], axis=-1)


def plain_costs(left, right, span, neutral):
    """Differing bits by row, column and disparity low..high."""
    a, b = plain_census(left), plain_census(right)
    h, w = left.shape
    costs = np.full((h, w, span.high - span.low + 1), neutral, int)
    for i, d in enumerate(range(span.low, span.high + 1)):
        for x in range(w):
            if 0 <= x - d < w:
                costs[:, x, i] = (a[:, x] != b[:, x - d]).sum(axis=-1)
    return costs


def plain_path(costs, steps, penalties):
    """Costs (n, ..., d) summed along the first axis, each kept relative to the minimum before it."""
    before = np.zeros(costs.shape[1:], int)
    out = []
    for cost, step_here in zip(costs, steps, strict=True):
        least = before.min(axis=-1, keepdims=True)
        wall = np.full((*before.shape[:-1], 1), 255)
        up = np.concatenate([wall, before[..., :-1]], axis=-1)
        down = np.concatenate([before[..., 1:], wall], axis=-1)
        jumped = least + penalties.p2_by_step.astype(int)[step_here][..., None]
        best = np.minimum(np.minimum(before, jumped), np.minimum(up, down) + int(penalties.p1))
        before = np.minimum(cost + best - least, 255)
        out.append(before)
    return np.stack(out)


def plain_sums(left, right, span, penalties):
    costs = plain_costs(left, right, span, int(penalties.neutral))
    grey = left.astype(int)
    total = np.zeros_like(costs)
    for axis in (0, 1):
        c, g = np.moveaxis(costs, axis, 0), np.moveaxis(grey, axis, 0)
        steps = np.abs(np.diff(g, axis=0, prepend=g[:1]))
        back = np.abs(np.diff(g[::-1], axis=0, prepend=g[-1:]))
        total += np.moveaxis(plain_path(c, steps, penalties) + plain_path(c[::-1], back, penalties)[::-1], 0, axis)
    return np.minimum(total, 255)


def plain_disparity(sums, span, tolerance):
    h, w, count = sums.shape
    out = np.full((h, w), UNKNOWN, np.int16)
    right_best = np.full((h, w), 255)
    for i, d in enumerate(range(span.low, span.high + 1)):
        for x in range(max(0, d), min(w, w + d)):
            right_best[:, x - d] = np.minimum(right_best[:, x - d], sums[:, x, i])
    for y, x in np.ndindex(h, w):
        s = sums[y, x]
        i = count - 1 - int(np.argmin(s[::-1]))  # of equals the largest disparity
        d = span.low + i
        if not 0 <= x - d < w or s[i] == 255 or s[i] > np.float32(tolerance) * np.float32(right_best[y, x - d]):
            continue
        offset = 0.0
        if 0 < i < count - 1:
            before, after = float(s[i + 1]), float(s[i - 1])  # lanes run downwards
            if before == after == s[i]:
                continue
            offset = (before - after) / (2 * (max(before, after) - s[i]))
        out[y, x] = np.floor(16 * (d - offset) + 0.5)
    return out


@pytest.mark.parametrize("span", [Span(0, 15), Span(0, 10), Span(-5, 6), Span(3, 20), Span(-9, -2)])
@pytest.mark.parametrize("tolerance", [1.0, 1.08])
def test_sweep_equals_plain_semi_global_matching(span, tolerance):
    views, _, _ = step(shape=(22, 41), back=2, front=6, box=(5, 16, 14, 30))
    left, right = np.asarray(views.left), np.asarray(views.right)
    out = unknown_matches(left.shape)
    rows = [(0, left.shape[0])]
    sweep((census(left), census(right)), left, span, SHARP.penalties, tolerance, rows, out)
    sums = plain_sums(left, right, span, SHARP.penalties)
    assert np.array_equal(out.sums, sums.min(axis=-1))
    assert np.array_equal(out.disparity, plain_disparity(sums, span, tolerance))


@pytest.mark.parametrize("span", [Span(0, 46), Span(-1, 69), Span(-3, 104)])
def test_lanes_in_vectors_of_several_widths_are_exact(span):
    """48, 80 and 112 of them, some not asked for; in the middle of the picture none leads out of it."""
    assert span.lanes & (span.lanes - 1)
    views, _, _ = step(shape=(9, 150), back=2, front=40, box=(2, 7, 70, 120))
    left, right = np.asarray(views.left), np.asarray(views.right)
    out = unknown_matches(left.shape)
    sweep((census(left), census(right)), left, span, SHARP.penalties, 1.08, [(0, len(left))], out)
    sums = plain_sums(left, right, span, SHARP.penalties)
    assert np.array_equal(out.sums, sums.min(axis=-1))
    assert np.array_equal(out.disparity, plain_disparity(sums, span, 1.08))


def test_levels_cost_their_difference_up_to_a_bound():
    span = Span(0, 0)
    left = np.tile(np.arange(0, 120, 2, dtype=np.uint8), (9, 1))
    for darker, cost in ((0, 0), (4, 2), (8, 4), (100, 4)):
        right = left + np.uint8(darker)  # in the same order: the census sees no difference
        out = unknown_matches(left.shape)
        codes = census_with_levels(left), census_with_levels(right)
        sweep(codes, left, span, LEVELS.penalties, 1.0, [(0, 9)], out, most_level=LEVELS.most_level)
        assert (out.sums == 4 * cost).all()


@pytest.mark.parametrize("cost", [SHARP, LEVELS])
def test_strips_are_independent_with_hardly_visible_seams(cost, monkeypatch):
    views, _, _ = step(shape=(300, 160), box=(60, 240, 60, 120))
    left, right = np.asarray(views.left), np.asarray(views.right)
    codes = cost.codes(left), cost.codes(right)
    maps = []
    for rows in (300, 128):
        monkeypatch.setattr(strips, "ROWS", rows)
        out = unknown_matches(left.shape)
        for each in strips.strips(left.shape, Span(0, 31)):
            sweep(codes, left, Span(0, 31), cost.penalties, 1.08, [each], out, most_level=cost.most_level)
        maps.append(out.disparity.astype(int))
    near = [y for y in range(300) if min(abs(y - 128), abs(y - 256)) <= 8]
    assert np.mean(np.abs(maps[0] - maps[1])[near] > 16) <= 0.005


@pytest.mark.parametrize(
    ("shape", "span"), [((4000, 6000), Span(0, 255)), ((500, 741), Span(0, 63)), ((9, 90000), Span(0, 511))]
)
def test_volumes_stay_within_their_bound(shape, span):
    rows = strips.strips(shape, span)
    highest = max(b - a for a, b in rows)
    assert [a for a, _ in rows] == [0, *[b for _, b in rows][:-1]]
    assert rows[-1][1] == shape[0]
    volumes = strips.AT_ONCE * highest * shape[1] * span.lanes
    assert highest <= 8 or volumes <= strips.VOLUME_BYTES


@pytest.mark.parametrize("processors", [1, 3, 64])
def test_strips_with_any_number_of_threads_are_the_same(processors, monkeypatch):
    expected = strips.strips((3000, 4500), Span(0, 511))
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(processors)), raising=False)
    assert thread_count() == processors
    assert strips.strips((3000, 4500), Span(0, 511)) == expected


def test_threads_are_limited_by_memory(monkeypatch):
    monkeypatch.setattr(strips, "VOLUME_BYTES", 3 * 16 * 64 * 32)
    at_work = []
    monkeypatch.setattr(strips, "in_turns", lambda tasks, work, most: at_work.append(most))
    rows = [(y, y + 16) for y in range(0, 160, 16)]
    codes = np.empty((160, 3, 64), np.uint8)
    sweep((codes, codes), codes[:, 0], Span(0, 31), SHARP.penalties, 1.0, rows, unknown_matches((160, 64)))
    assert at_work == [3]


def test_highest_strips_are_matched_first(monkeypatch):
    """Threads then end at about the same time."""
    taken = []
    monkeypatch.setattr(strips, "in_turns", lambda tasks, work, most: taken.extend(tasks))
    codes = np.empty((160, 3, 64), np.uint8)
    rows = [(0, 20), (20, 84), (84, 94), (94, 160)]
    sweep((codes, codes), codes[:, 0], Span(0, 31), SHARP.penalties, 1.0, rows, unknown_matches((160, 64)))
    assert taken == [(94, 160), (20, 84), (0, 20), (84, 94)]


def test_jump_at_a_grey_step_is_cheaper():
    penalties = p2_by_grey_step(50, 12, 1.5)
    assert (penalties[0], penalties[10], penalties[255]) == (50, 35, 12)


def test_span_fits_lanes_and_pictures():
    assert Span(0, 63).lanes == 64
    assert Span(0, 64).lanes == 80
    assert Span(2, 68).fill_lanes() == Span(2, 81)
    assert Span(2, 68).widen() == Span(2, 129)
    assert Span(-3, 3).lanes == 16
    assert Span(0, 3).widen() == Span(0, 15)
    assert Span(-50, 500).clip(100) == Span(-50, 99)
    assert Span(-500, 50).clip(100) == Span(-99, 50)
    assert Span(500, 900).clip(1) == Span(0, 0)
    assert Span(-5, 5).downsample(2) == Span(-3, 3)
