"""Views that were exchanged, told by signs and by what hides what."""

import numpy as np
import pytest

from tangible_core import Pipeline, Scene
from tangible_core.data import DisparityMap
from tangible_core.scene.pair_checks import put_right, view_order
from tangible_depth import SemiGlobal

SHAPE = 120, 200
BOX = slice(80, 130)
"""Columns of a light box that stands before a dark wall."""


def seen(box_px: float, wall_px: float) -> tuple[DisparityMap, np.ndarray]:
    """The map of a box before a wall, unknown where the other view does not show the wall, and its picture."""
    width = round(abs(box_px - wall_px))
    hidden = slice(BOX.start - width, BOX.start) if box_px > wall_px else slice(BOX.stop, BOX.stop + width)
    values, picture = np.full(SHAPE, wall_px, np.float32), np.full(SHAPE, 40, np.uint8)
    values[:, hidden], values[:, BOX], picture[:, BOX] = np.nan, box_px, 200
    return DisparityMap(values), picture


@pytest.mark.parametrize(
    ("box_px", "wall_px", "exchanged", "said"),
    [
        (40, 10, False, ""),
        (10, -20, False, ""),
        (-10, -40, False, "every disparity is negative, and yet left and right are in order: 120 of 120 contours"),
        (-40, -10, True, "left and right seem to be exchanged: every disparity is negative. The depth was put right"),
        (-20, 10, True, "left and right seem to be exchanged: 120 of 120 contours hide"),
    ],
    ids=["in order", "converging", "shifted", "exchanged", "exchanged and converging"],
)
def test_what_hides_what_tells_the_order(box_px: float, wall_px: float, exchanged: bool, said: str):
    found = view_order(*seen(box_px, wall_px))
    assert found.exchanged == exchanged
    assert found.said.startswith(said) and bool(found.said) == bool(said)


def test_where_nothing_hides_the_signs_tell_it_unless_the_cameras_explain_them():
    flat, picture = DisparityMap(np.full(SHAPE, -8, np.float32)), np.zeros(SHAPE, np.uint8)
    assert view_order(flat, picture).exchanged
    assert not view_order(flat, picture, offset_px=31.0).exchanged
    assert view_order(*seen(-40, -10), offset_px=31.0).exchanged


def test_neither_a_map_without_unit_nor_one_of_noise_says_anything():
    values = np.full(SHAPE, -8, np.float32)
    relative = DisparityMap(values, unit="relative")
    unsure = DisparityMap(values, np.full(SHAPE, 0.1, np.float32))
    assert not any(view_order(each, np.zeros(SHAPE, np.uint8)).said for each in (relative, unsure))


def test_what_was_put_right_has_the_other_signs():
    found = put_right(seen(-40, -10)[0])
    assert np.nanmax(found.disparity_px) == 40 and np.isnan(found.disparity_px).any()


def test_exchanged_views_are_felt_as_the_others_and_it_is_said():
    views = Scene.builtin("motorcycle").views
    assert views is not None and views.right is not None
    truth = np.nan_to_num(Scene.builtin("motorcycle").truth, posinf=0)
    for left, right, said in ((views.left, views.right, False), (views.right, views.left, True)):
        pipeline = Pipeline(Scene.of(left=left, right=right), depth=SemiGlobal(), cached=False)
        assert np.corrcoef(pipeline.relief.height_m.ravel(), truth.ravel())[0, 1] > 0.5
        [outcome] = [each for each in pipeline.outcomes if each.product == "disparity"]
        assert ("left and right seem to be exchanged" in outcome.why) == said
        assert any(each.kind == "warning" for each in outcome.notes) == said
