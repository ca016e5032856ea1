"""Frames of a film: else each is searched and rectified anew, or the range goes stale."""

import numpy as np
import pytest

from films import layered
from stereo_scenes import slanted, step
from tangible_core.data import Views
from tangible_core.plugins.interfaces import Following
from tangible_depth import SemiGlobal, Ssd, Zncc
from tangible_depth.matching import chain
from tangible_depth.matching.chain import SEARCH_EVERY, FilmMatcher
from tangible_depth.rectify import rectification
from tangible_depth.search import disparity_range

METHODS = [SemiGlobal(), SemiGlobal(resolution="half"), Zncc(), Ssd()]


@pytest.fixture
def searches(monkeypatch):
    """Count the range searches."""
    counted = []
    found = disparity_range.find_range
    monkeypatch.setattr(disparity_range, "find_range", lambda pair: counted.append(pair) or found(pair))
    return counted


def share_wrong(found, true, hidden):
    return np.mean(np.abs(found.disparity_px - true)[~hidden] > 1)


@pytest.mark.parametrize("method", METHODS, ids=repr)
def test_frames_of_a_film_match_as_well_as_single_pairs_with_one_range_search(method, searches):
    assert isinstance(method, Following)
    views, true, hidden = step()
    alone = share_wrong(method.estimate(views), true, hidden)
    searches.clear()
    estimate = method.follow(views)
    for _ in range(3):
        assert share_wrong(estimate(views), true, hidden) <= alone + 0.01
    assert len(searches) == 1


def test_range_follows_the_latest_searches_without_empty_frames(monkeypatch):
    far, near = slanted(offset=6.0)[0], slanted(offset=60.0)
    estimate = SemiGlobal(resolution="half").follow(far)
    assert isinstance(estimate, FilmMatcher)
    errors = [np.median(np.abs(estimate(near[0]).disparity_px - near[1])[:, 70:]) for _ in range(SEARCH_EVERY + 1)]
    assert errors[-1] < 0.5 < errors[0]
    monkeypatch.setattr(chain, "SEARCH_EVERY", 1)
    near, far, dark = slanted(offset=40.0)[0], slanted(offset=6.0)[0], np.zeros((96, 160), np.uint8)
    estimate = SemiGlobal(resolution="half", skip_identical=False).follow(near)
    wide = estimate._span
    estimate(Views(dark, dark))
    assert estimate._span == wide
    for _ in range(chain.SEARCHES):
        estimate(far)
    assert estimate._span.high < wide.high


def test_given_range_is_kept_without_a_search(searches):
    views = step()[0]
    estimate = SemiGlobal(min_disparity_px=0, max_disparity_px=24, rectify="never").follow(views)
    for _ in range(SEARCH_EVERY + 1):
        estimate(views)
    assert searches == []


def test_film_is_rectified_and_its_rows_corrected_once(monkeypatch):
    import cv2

    generator = np.random.default_rng(6)
    frames = [layered(number, 1.0, generator, (180, 240)) for number in range(3)]
    roll = cv2.getRotationMatrix2D((120, 90), 3, 1)
    rolled = [
        Views(frame.left, cv2.warpAffine(frame.right, roll, (240, 180), borderMode=cv2.BORDER_REFLECT))
        for frame in frames
    ]
    alone = [SemiGlobal().estimate(each).disparity_px for each in rolled]
    counted = []
    rectify = rectification.rectify
    monkeypatch.setattr(chain, "rectify", lambda *given, **named: counted.append(1) or rectify(*given, **named))
    estimate = SemiGlobal().follow(rolled[0])
    for each, expected in zip(rolled, alone, strict=True):
        apart = np.abs(estimate(each).disparity_px - expected)
        assert np.mean(apart < 0.5) > 0.98
    assert counted == [1]
    views, true, hidden = step((120, 200))
    lower = Views(views.left, np.roll(views.right, 1, axis=0))
    estimate = SemiGlobal(resolution="half", min_disparity_px=0, max_disparity_px=24).follow(lower)
    assert share_wrong(estimate(lower), true, hidden) < 0.1
