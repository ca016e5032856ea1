import numpy as np
import pytest

from tangible_core.data import Views
from tangible_core.errors import PictureError
from tangible_depth.report import Report
from two_cameras import Scene, roll_and_tilt


def test_known_scene_gives_its_disparity():
    scene = Scene()
    found = Report().estimate(Views(scene.left(), scene.right()))
    error = np.abs(found.disparity_px - scene.disparity_px())
    assert found.unit == "px"
    assert np.mean(error[scene.visible()] <= 2) > 0.93
    assert np.median(error) < 0.15
    assert 0 <= found.confidence.min() < found.confidence.max() <= 1


def test_raw_pair_is_rectified_first():
    scene = Scene((240, 320), 8.0, 20.0)
    views = Views(scene.left(), scene.right(roll_and_tilt(scene.shape)))
    error = np.abs(Report().estimate(views).disparity_px - scene.disparity_px())
    assert np.mean(error[scene.visible()] <= 2) > 0.9


def test_disparities_of_either_sign_are_matched():
    scene = Scene(wall_px=-9.0, box_px=6.0)
    error = np.abs(Report().estimate(Views(scene.left(), scene.right())).disparity_px - scene.disparity_px())
    assert np.mean(error[scene.visible()] <= 2) > 0.9


def test_given_range_is_kept():
    scene = Scene()
    found = Report(max_disparity_px=10).estimate(Views(scene.left(), scene.right()))
    assert np.nanmax(found.disparity_px) <= 10.5


def test_exposure_and_dtype_give_the_same_map():
    scene = Scene()
    left, right = (np.rint(50000 * grey).astype(np.uint16) for grey in (scene.left(), 0.6 * scene.right() + 0.1))
    rgba = np.stack([left, left, left, np.full_like(left, 65535)], axis=2)
    error = np.abs(Report().estimate(Views(rgba, right)).disparity_px - scene.disparity_px())
    assert np.mean(error[scene.visible()] <= 2) > 0.9


def test_single_view_is_refused():
    with pytest.raises(PictureError, match="two views"):
        Report().estimate(Views(np.zeros((20, 20))))
