"""Codes at two scales, and what they cost."""

import cv2
import numpy as np
import pytest

from tangible_depth.sgm.census import census, census_with_levels, two_scale_census
from tangible_depth.sgm.costs import COSTS, p2_by_grey_step


def test_codes_at_two_scales_are_those_of_a_fine_and_of_a_coarse_picture():
    grey = np.random.default_rng(0).integers(0, 256, (20, 70), np.uint8)
    found = two_scale_census(grey, 0.5, 1.5)
    for planes, sigma in ((slice(0, 3), 0.5), (slice(3, 6), 1.5)):
        blurred = cv2.GaussianBlur(grey, (0, 0), sigma)
        assert np.array_equal(found[:, planes, :70], census(blurred)[..., :70])


def test_levels_follow_the_census_at_half_depth():
    grey = np.random.default_rng(0).integers(0, 256, (9, 70), np.uint8)
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
