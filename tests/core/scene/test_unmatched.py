"""If one of these fails, nobody is warned of a pair that hardly matches, or of one picture taken twice."""

import numpy as np

from tangible_core import Pipeline, Scene
from tangible_core.data import DisparityMap, Views
from tangible_core.plugins import DepthEstimator
from tangible_core.scene.pair_checks import few_matches, identical_views

SHAPE = 10, 20


def matched(share: float, **kind: str) -> DisparityMap:
    """Return a map of which this share, from the top, was matched."""
    confidence = np.full(SHAPE, 0.1, np.float32)
    confidence[: round(share * SHAPE[0])] = 0.9
    return DisparityMap(np.full(SHAPE, 5, np.float32), confidence, **kind)  # pyright: ignore[reportArgumentType]


def test_few_matches_warns_where_most_of_the_map_is_filled_in():
    assert "found for 20% of the left one" in few_matches(matched(0.2))
    assert (few_matches(matched(0.3)), few_matches(matched(0.2, unit="relative"))) == ("", "")


def test_few_matches_ignores_unknown_pixels():
    known = np.zeros(SHAPE, bool)
    assert few_matches(matched(0.2), known) == ""
    known[:4] = True
    assert few_matches(matched(0.2), known) == ""
    known[:] = True
    assert few_matches(matched(0.2), known)


def test_identical_views_are_reported():
    left, right = np.random.default_rng(1).random((2, *SHAPE))
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
