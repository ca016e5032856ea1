"""The compiled sweep against semi-global matching written out plainly, to the last bit."""

import os

import numpy as np
import pytest

from semi_global_plainly import plain_disparity, plain_sums
from stereo_scenes import step
from tangible_core.compiled.threads import thread_count
from tangible_depth.dense.span import Span
from tangible_depth.sgm import strips
from tangible_depth.sgm.census import census, census_with_levels
from tangible_depth.sgm.costs import LEVELS, SHARP, p2_by_grey_step
from tangible_depth.sgm.strips import sweep, unknown_matches


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


@pytest.mark.parametrize("span", [Span(0, 15), Span(-6, 9)])
def test_sweep_of_noise_equals_plain_semi_global_matching(span):
    """Few greys, so that sums are often equal, and as large as they can be."""
    left, right = np.random.default_rng(1).choice([0, 90, 255], (2, 14, 37)).astype(np.uint8)
    dear = SHARP.penalties._replace(p1=np.uint8(200), p2_by_step=p2_by_grey_step(230, 200, 0.1))
    for penalties in (SHARP.penalties, dear):
        out = unknown_matches(left.shape)
        sweep((census(left), census(right)), left, span, penalties, 1.08, [(0, 14)], out)
        sums = plain_sums(left, right, span, penalties)
        assert np.array_equal(out.sums, sums.min(axis=-1))
        assert np.array_equal(out.disparity, plain_disparity(sums, span, 1.08))


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


def test_strips_of_a_very_wide_picture_have_eight_rows():
    assert strips.strips((17, 90000), Span(0, 511)) == [(0, 8), (8, 16), (16, 17)]
    assert strips.strips((130, 90), Span(0, 15)) == [(0, 128), (128, 130)]


@pytest.mark.parametrize("rows", [(0, 20), (21, 38), (40, 59)])
def test_strip_whose_paths_begin_at_the_ends_of_the_picture_is_part_of_the_whole(rows):
    """Its own rows alone would be matched otherwise."""
    left, right = np.random.default_rng(2).choice([0, 90, 255], (2, 59, 41)).astype(np.uint8)
    found = []
    for only, warm in (((0, 59), 0), (rows, 59), (rows, 0)):
        out = unknown_matches(left.shape)
        sweep((census(left), census(right)), left, Span(0, 15), SHARP.penalties, 1.0, [only], out, warm)
        found.append(out)
    part = slice(*rows)
    assert np.array_equal(found[0].sums[part], found[1].sums[part])
    assert np.array_equal(found[0].disparity[part], found[1].disparity[part])
    assert not np.array_equal(found[0].sums[part], found[2].sums[part])


@pytest.mark.parametrize("processors", [1, 3, 64])
def test_strips_with_any_number_of_threads_are_the_same(processors, monkeypatch):
    expected = strips.strips((3000, 4500), Span(0, 511))
    monkeypatch.setattr(os, "sched_getaffinity", lambda _: set(range(processors)), raising=False)
    assert thread_count() == processors
    assert strips.strips((3000, 4500), Span(0, 511)) == expected


@pytest.mark.parametrize(("volumes", "most"), [(3, 3), (3.9, 3), (1, 1), (0.5, 1)])
def test_threads_are_limited_by_memory(volumes, most, monkeypatch):
    monkeypatch.setattr(strips, "VOLUME_BYTES", int(volumes * 16 * 64 * 32))
    at_work = []
    monkeypatch.setattr(strips, "in_turns", lambda tasks, work, most: at_work.append(most))
    rows = [(y, y + 16) for y in range(0, 160, 16)]
    codes = np.empty((160, 3, 64), np.uint8)
    sweep((codes, codes), codes[:, 0], Span(0, 31), SHARP.penalties, 1.0, rows, unknown_matches((160, 64)))
    assert at_work == [most]


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
