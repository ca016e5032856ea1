"""The compiled sweep against semi-global matching written out plainly: else the default's depths are wrong."""

import cv2
import numpy as np
import pytest

from semi_global_plainly import plain_disparity, plain_sums
from stereo_scenes import step
from tangible_depth.dense.span import Span
from tangible_depth.sgm import strips
from tangible_depth.sgm.costs import COSTS, LEVELS, SHARP, census, census_with_levels, p2_by_grey_step, two_scale_census
from tangible_depth.sgm.strips import sweep, unknown_matches


@pytest.mark.parametrize("span", [Span(0, 10), Span(-5, 6), Span(3, 20), Span(-9, -2)])
@pytest.mark.parametrize("tolerance", [1.0, 1.08])
def test_sweep_equals_plain_semi_global_matching(span, tolerance):
    """Of a scene, and of noise at penalties as they are and dear."""
    views, _, _ = step(shape=(22, 41), back=2, front=6, box=(5, 16, 14, 30))
    assert_sweep_is_plain(np.asarray(views.left), np.asarray(views.right), span, tolerance)
    left, right = np.random.default_rng(1).choice([0, 90, 255], (2, 14, 37)).astype(np.uint8)
    dear = SHARP.penalties._replace(p1=np.uint8(200), p2_by_step=p2_by_grey_step(230, 200, 0.1))
    for penalties in (SHARP.penalties, dear):
        assert_sweep_is_plain(left, right, span, tolerance, penalties)


def assert_sweep_is_plain(left, right, span, tolerance, penalties=SHARP.penalties):
    out = unknown_matches(left.shape)
    sweep((census(left), census(right)), left, span, penalties, tolerance, [(0, len(left))], out)
    sums = plain_sums(left, right, span, penalties)
    assert np.array_equal(out.sums, sums.min(axis=-1))
    assert np.array_equal(out.disparity, plain_disparity(sums, span, tolerance))


@pytest.mark.parametrize("span", [Span(0, 46), Span(-3, 104)])
def test_lanes_in_vectors_of_several_widths_are_exact(span):
    """48 and 112 of them, some not asked for; in the middle of the picture none leads out of it."""
    assert span.lanes & (span.lanes - 1)
    views, _, _ = step(shape=(9, 150), back=2, front=40, box=(2, 7, 70, 120))
    assert_sweep_is_plain(np.asarray(views.left), np.asarray(views.right), span, 1.08)


def test_levels_and_strips_have_their_bounds():
    span = Span(0, 0)
    left = np.tile(np.arange(0, 120, 2, dtype=np.uint8), (9, 1))
    for darker, cost in ((0, 0), (4, 2), (8, 4), (100, 4)):
        right = left + np.uint8(darker)  # in the same order: the census sees no difference
        out = unknown_matches(left.shape)
        codes = census_with_levels(left), census_with_levels(right)
        sweep(codes, left, span, LEVELS.penalties, 1.0, [(0, 9)], out, most_level=LEVELS.most_level)
        assert (out.sums == 4 * cost).all()
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


def test_spans_and_codes_fit_pictures_at_two_scales():
    assert (Span(0, 63).lanes, Span(0, 64).lanes) == (64, 80)
    assert Span(2, 68).fill_lanes() == Span(2, 81)
    assert Span(2, 68).widen() == Span(2, 129)
    assert Span(-3, 3).lanes == 16
    assert Span(0, 3).widen() == Span(0, 15)
    assert Span(-50, 500).within(100) == Span(-50, 99)
    assert Span(-500, 50).within(100) == Span(-99, 50)
    assert Span(500, 900).within(1) == Span(0, 0)
    assert Span(5, 2).within(9) == Span(5, 5)
    assert Span(-5, 5).downsample(2) == Span(-3, 3)
    grey = np.random.default_rng(0).integers(0, 256, (20, 70), np.uint8)
    found = two_scale_census(grey, 0.5, 1.5)
    for planes, sigma in ((slice(0, 3), 0.5), (slice(3, 6), 1.5)):
        blurred = cv2.GaussianBlur(grey, (0, 0), sigma)
        assert np.array_equal(found[:, planes, :70], census(blurred)[..., :70])
    found = census_with_levels(grey)
    assert np.array_equal(found[:, :3], census(grey))
    assert np.array_equal(found[:, 3, :70], grey // 2)


@pytest.mark.parametrize("name", COSTS)
def test_bits_of_a_cost_are_the_most_that_a_pixel_can_differ_by(name: str):
    """The confidence of a match is relative to them."""
    cost = COSTS[name]
    planes = cost.codes(np.zeros((5, 9), np.uint8)).shape[1]
    assert cost.bits == (8 * (planes - 1) + cost.most_level if cost.most_level else 8 * planes)


def test_penalty_of_a_jump_falls_with_the_step_of_grey_down_to_its_least():
    assert p2_by_grey_step(50, 12, 1.5)[[0, 1, 2, 25, 26, 255]].tolist() == [50, 48, 47, 12, 12, 12]
