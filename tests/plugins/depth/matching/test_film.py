import numpy as np
import pytest

from films import layered
from stereo_scenes import slanted, step
from tangible_core.data import Calibration, Views
from tangible_core.errors import PictureError
from tangible_core.plugins.interfaces import Following
from tangible_core.plugins.notes import collected, silently
from tangible_depth import Auto, SemiGlobal, Ssd, Zncc
from tangible_depth.dense.span import Span
from tangible_depth.matching import film
from tangible_depth.matching.film import LOOK_EVERY, FollowedPair
from tangible_depth.rectify import rectification
from tangible_depth.search import disparity_range

METHODS = [SemiGlobal(), SemiGlobal(resolution="half"), Zncc(), Ssd()]


@pytest.fixture
def looks(monkeypatch):
    """How often the range of a pair is looked for."""
    counted = []
    found = disparity_range.find_range
    monkeypatch.setattr(disparity_range, "find_range", lambda pair: counted.append(pair) or found(pair))
    return counted


def wrong(found, true, hidden):
    return np.mean(np.abs(found.disparity_px - true)[~hidden] > 1)


@pytest.mark.parametrize("method", METHODS, ids=repr)
def test_each_frame_is_matched_as_well_as_alone_and_the_range_is_looked_for_once(method, looks):
    assert isinstance(method, Following)
    views, true, hidden = step()
    alone = wrong(method.estimate(views), true, hidden)
    looks.clear()
    estimate = method.follow(views)
    for _ in range(3):
        assert wrong(estimate(views), true, hidden) <= alone + 0.01
    assert len(looks) == 1


def test_what_comes_nearer_is_let_in_at_the_next_look():
    far, near = slanted(offset=6.0)[0], slanted(offset=60.0)
    estimate = SemiGlobal(resolution="half").follow(far)
    assert isinstance(estimate, FollowedPair)
    errors = [np.median(np.abs(estimate(near[0]).disparity_px - near[1])[:, 70:]) for _ in range(LOOK_EVERY + 1)]
    assert errors[-1] < 0.5 < errors[0]


def test_a_look_that_shows_nothing_teaches_nothing_and_old_ones_are_forgotten(monkeypatch):
    monkeypatch.setattr(film, "LOOK_EVERY", 1)
    near, far, dark = slanted(offset=40.0)[0], slanted(offset=6.0)[0], np.zeros((96, 160), np.uint8)
    estimate = SemiGlobal(resolution="half", skip_identical=False).follow(near)
    wide = estimate._span
    estimate(Views(dark, dark))
    assert estimate._span == wide
    for _ in range(film.LOOKS):
        estimate(far)
    assert estimate._span.high < wide.high


def test_a_range_that_changes_a_little_needs_no_other_kernel():
    estimate = Zncc().follow(slanted(offset=6.0)[0])
    sizes = set()
    for high in (66, 83, 101):
        estimate._spans.append(Span(-3, high))
        sizes.add(estimate._span.lanes)
    assert sizes == {128}


def test_a_range_that_is_told_is_kept_and_nothing_is_looked_for(looks):
    views = step()[0]
    estimate = SemiGlobal(min_disparity_px=0, max_disparity_px=24, rectify="never").follow(views)
    for _ in range(LOOK_EVERY + 1):
        estimate(views)
    assert looks == []


def test_cameras_that_look_elsewhere_are_turned_by_the_first_frame_alone(monkeypatch):
    import cv2

    generator = np.random.default_rng(6)
    frames = [layered(number, 1.0, generator, (180, 240)) for number in range(3)]
    roll = cv2.getRotationMatrix2D((120, 90), 3, 1)
    rolled = [
        Views(each.left, cv2.warpAffine(each.right, roll, (240, 180), borderMode=cv2.BORDER_REFLECT)) for each in frames
    ]
    counted = []
    rectify = rectification.rectify
    monkeypatch.setattr(film, "rectify", lambda *given, **named: counted.append(1) or rectify(*given, **named))
    estimate = SemiGlobal().follow(rolled[0])
    for each in rolled:
        alone = SemiGlobal().estimate(each).disparity_px
        apart = np.abs(estimate(each).disparity_px - alone)
        assert np.nanmedian(apart) < 1
    assert counted == [1]


def test_rows_that_miss_each_other_by_a_constant_are_put_right_in_each_frame():
    views, true, hidden = step((120, 200))
    lower = Views(views.left, np.roll(views.right, 1, axis=0))
    estimate = SemiGlobal(resolution="half").follow(lower)
    assert wrong(estimate(lower), true, hidden) < 0.1


def test_a_calibrated_pair_is_not_turned(monkeypatch):
    monkeypatch.setattr(film, "with_common_rows", None)
    views, true, hidden = step()
    views = Views(views.left, views.right, Calibration(100.0, 0.1))
    assert wrong(SemiGlobal(resolution="half").follow(views)(views), true, hidden) < 0.1


def test_identical_views_are_skipped_frame_by_frame():
    views, _true, _hidden = step()
    same = Views(views.left, views.left)
    estimate = SemiGlobal(resolution="half").follow(same)
    assert not estimate(same).disparity_px[~np.isnan(estimate(same).disparity_px)].any()


def test_one_view_is_refused():
    with pytest.raises(PictureError, match="two views"):
        SemiGlobal().follow(Views(step()[0].left))


def test_auto_follows_a_pair_and_one_picture():
    views, _true, _hidden = step()
    assert isinstance(Auto().follow(views), FollowedPair)
    with collected() as notes:
        assert Auto().follow(Views(views.left))(Views(views.left)).unit == "relative"
    assert any("no depth" in each for each in notes)


def test_what_is_noted_silently_is_neither_said_nor_kept(caplog):
    caplog.set_level("INFO")
    with collected() as notes, silently():
        SemiGlobal().estimate(Views(step()[0].left, step()[0].left))
    assert notes == [] and "identical" not in caplog.text
