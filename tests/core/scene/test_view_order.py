"""If one of these fails, a pair that is exchanged or hardly matches is felt, and nobody is warned."""

import numpy as np
import pytest

from tangible_core import Pipeline, Scene
from tangible_core.data import DisparityMap, Views
from tangible_core.plugins import DepthEstimator
from tangible_core.scene import pair_checks
from tangible_core.scene.pair_checks import correct_exchanged, few_matches, identical_views, view_order

SHAPE = 120, 200
BOX = slice(80, 130)
"""Columns of a light box that stands before a dark wall."""


def box_and_wall(box_px: float, wall_px: float) -> tuple[DisparityMap, np.ndarray]:
    """Return the map of a box before a wall, unknown where the other view does not show the wall, and its picture."""
    width = round(abs(box_px - wall_px))
    hidden = slice(BOX.start - width, BOX.start) if box_px > wall_px else slice(BOX.stop, BOX.stop + width)
    values, picture = np.full(SHAPE, wall_px, np.float32), np.full(SHAPE, 40, np.uint8)
    values[:, hidden], values[:, BOX], picture[:, BOX] = np.nan, box_px, 200
    return DisparityMap(values), picture


@pytest.mark.parametrize(
    ("box_px", "wall_px", "exchanged", "message"),
    [
        (40, 10, False, ""),
        (10, -20, False, ""),
        (-10, -40, False, "every disparity is negative, and yet left and right are in order: 120 of 120 contours"),
        (-40, -10, True, "left and right seem to be exchanged: every disparity is negative, and 120 of 120 contours"),
        (-20, 10, True, "left and right seem to be exchanged: 120 of 120 contours occlude"),
        (10, 40, True, "left and right seem to be exchanged: 120 of 120 contours occlude"),
    ],
)
def test_view_order_follows_occlusion(box_px: float, wall_px: float, exchanged: bool, message: str):
    order = view_order(*box_and_wall(box_px, wall_px))
    assert order.exchanged == exchanged
    assert order.message.startswith(message) and bool(order.message) == bool(message)


def test_view_order_without_occlusion_is_open_unless_cameras_explain_the_signs():
    flat, picture = DisparityMap(np.full(SHAPE, -8, np.float32)), np.zeros(SHAPE, np.uint8)
    order = view_order(flat, picture)
    assert order.open and not order.exchanged
    assert order.message.startswith("it is open whether left and right are exchanged: every disparity is negative")
    assert view_order(flat, picture, offset_px=31.0) == pair_checks.IN_ORDER
    assert view_order(*box_and_wall(-40, -10), offset_px=31.0).exchanged


@pytest.mark.parametrize(
    ("low_px", "votes", "exchanged", "is_open"),
    [
        (-40, (18, 10), False, False),
        (-40, (17, 10), False, True),
        (-40, (10, 17), False, True),
        (-40, (10, 18), True, False),
        (-40, (19, 0), False, True),
        (-40, (0, 19), False, True),
        (-40, (20, 0), False, False),
        (20, (0, 49), False, False),
        (20, (0, 50), True, False),
        (20, (24, 48), True, False),
        (40, (17, 50), False, False),
        (40, (17, 51), True, False),
    ],
)
def test_order_follows_a_clear_majority_of_contours(low_px, votes, exchanged: bool, is_open: bool, monkeypatch):
    """Disparities are -40 to -10 px, or have both signs, -20 to 20 px, or are 10 to 40 px."""
    monkeypatch.setattr(pair_checks, "_votes", lambda *_: pair_checks._Votes(*votes))
    disparity, picture = box_and_wall(low_px, {-40: -10, 20: -20, 40: 10}[low_px])
    order = view_order(disparity, picture)
    assert (order.exchanged, order.open) == (exchanged, is_open)
    assert ("is open" in order.message) == is_open
    if low_px == 40:
        assert view_order(disparity, picture, offset_px=0.0) == pair_checks.IN_ORDER


def test_correct_exchanged_changes_the_signs():
    corrected = correct_exchanged(box_and_wall(-40, -10)[0])
    assert np.nanmax(corrected.disparity_px) == 40 and np.isnan(corrected.disparity_px).any()


def strip(step_px: float, width: int, before: float, after: float) -> tuple[np.ndarray, np.ndarray]:
    """Return a row of disparities with a strip that nothing matched, and grey levels with an edge at both its ends."""
    values, grey = np.full(60, 20 + step_px, np.float32), np.full(60, before + after, np.float32)
    values[:20], values[20 : 20 + width] = 20, np.nan
    grey[:20], grey[20 : 20 + width] = 0, before
    return values, grey


@pytest.mark.parametrize(
    ("rows", "in_order", "exchanged"),
    [
        ([(10, 10, 0.2, 0.33), (10, 10, 0.2, 0.31), (10, 10, 0.33, 0.2), (10, 10, 0.34, 0.2)], 1, 2),
        ([(10, 10, 0, 0.022), (10, 10, 0, 0.018), (10, 10, 0.022, 0)], 1, 1),
        ([(10, 14, 0, 1), (10, 15, 0, 1), (10, 6, 0, 1), (10, 5, 0, 1)], 2, 0),
        ([(4, 6, 0, 1), (4, 7, 0, 1), (4, 2, 0, 1), (4, 1, 0, 1)], 2, 0),
        ([(3, 3, 0, 1), (2.9, 3, 0, 1), (-10, 10, 0, 1)], 1, 0),
    ],
)
def test_strips_vote_by_the_clearer_of_their_edges(rows: list[tuple], in_order: int, exchanged: int):
    """One edge is half as strong again, or by a hundredth of white; as wide as the step, or by 2 px; the least step."""
    values, grey = (np.stack(each) for each in zip(*(strip(*row) for row in rows), strict=True))
    for first in (0, 16):
        assert pair_checks._votes(values[:, first:], grey[:, first:]) == (in_order, exchanged)
    assert pair_checks._votes(values[:, 17:], grey[:, 17:]) == (0, 0), "too near to the rim"


SMALL_SHAPE = 10, 20


def matched(share: float, **kind: str) -> DisparityMap:
    """Return a map of which this share, from the top, was matched."""
    confidence = np.full(SMALL_SHAPE, 0.1, np.float32)
    confidence[: round(share * SMALL_SHAPE[0])] = 0.9
    return DisparityMap(np.full(SMALL_SHAPE, 5, np.float32), confidence, **kind)  # pyright: ignore[reportArgumentType]


def test_few_matches_warns_where_most_known_pixels_are_filled_in():
    assert "found for 20% of the left one" in few_matches(matched(0.2))
    assert (few_matches(matched(0.3)), few_matches(matched(0.2, unit="relative"))) == ("", "")
    known = np.zeros(SMALL_SHAPE, bool)
    assert few_matches(matched(0.2), known) == ""
    known[:4] = True
    assert few_matches(matched(0.2), known) == ""
    known[:] = True
    assert few_matches(matched(0.2), known)


def test_identical_views_are_reported():
    left, right = np.random.default_rng(1).random((2, *SMALL_SHAPE))
    twice = Scene.pair(left=left, right=left.copy()).views
    two = Scene.pair(left, right).views
    assert twice is not None and two is not None
    assert "one and the same picture: " in identical_views(twice, matched(1))
    assert identical_views(two, matched(1)) == ""
    assert identical_views(twice, matched(1, unit="relative")) == ""
    same = Pipeline(Scene.pair(left=left, right=left), depth=Guesses(), cached=False)
    same.make("disparity")
    [doubt] = same.outcomes.doubts
    assert doubt.text.startswith("left and right are one and the same picture: ")


class Guesses(DepthEstimator):
    """A method that matches nothing."""

    def estimate(self, views: Views) -> DisparityMap:
        return DisparityMap(np.ones(views.shape, np.float32), np.zeros(views.shape, np.float32))
