import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st

from tangible_core.data import DisparityMap, Views
from tangible_core.errors import GeometryError, PictureError
from tangible_depth.rectify.calibrated import StereoRig, rectify_calibrated
from tangible_depth.rectify.homographies import camera_matrix, rotation, transform
from tangible_depth.rectify.rectification import RectificationError

SHAPE = (90, 120)
BLANK = np.zeros(SHAPE, np.uint8)


def rig(turn=(0.02, -0.05, 0.01), move=(-0.1, 0.01, 0.005)):
    return StereoRig(camera_matrix(110.0, SHAPE), camera_matrix(115.0, SHAPE), rotation(*turn), np.array(move))


@given(
    turn=st.tuples(*[st.floats(-0.1, 0.1)] * 3),
    move=st.tuples(st.floats(-0.3, -0.05), st.floats(-0.03, 0.03), st.floats(-0.03, 0.03)),
)
def test_rows_and_depth_are_exact(turn, move):
    cameras = rig(turn, move)
    rectified = rectify_calibrated(Views(BLANK, BLANK), cameras)
    points = np.random.default_rng(0).uniform([-0.5, -0.4, 1], [0.5, 0.4, 3], (50, 3))
    seen = [
        points @ cameras.left_matrix.T,
        (points @ cameras.rotation.T + cameras.translation_m) @ cameras.right_matrix.T,
    ]
    left, right = (
        transform(homography, pixels[:, :2] / pixels[:, 2:])
        for homography, pixels in zip((rectified.left_homography, rectified.right_homography), seen, strict=True)
    )
    assert left[:, 1] == pytest.approx(right[:, 1], abs=1e-7)
    calibration = rectified.calibration
    centre = -cameras.rotation.T @ cameras.translation_m
    along = centre / np.linalg.norm(centre)
    across = np.cross(cameras.rotation[2] + [0, 0, 1], along)
    depth = points @ np.cross(along, across / np.linalg.norm(across))
    disparity = (left - right)[:, 0] + rectified.offset_px
    assert calibration.focal_px * calibration.baseline_m / disparity == pytest.approx(depth)
    assert calibration.baseline_m == pytest.approx(np.linalg.norm(centre))


def test_the_way_back_keeps_the_size():
    rectified = rectify_calibrated(Views(BLANK, BLANK), rig())
    found = rectified.to_original(DisparityMap(np.full(rectified.views.shape, 3, np.float32)))
    assert found.disparity_px.shape == SHAPE
    assert np.all(found.disparity_px == 3)


def test_cameras_one_behind_the_other_are_refused():
    with pytest.raises(RectificationError):
        rectify_calibrated(Views(BLANK, BLANK), rig((0, 0, 0), (0.0, 0.0, -0.5)))


def test_one_view_is_no_pair():
    with pytest.raises(PictureError, match="two views"):
        rectify_calibrated(Views(BLANK), rig())


@pytest.mark.parametrize(
    ("part", "value", "words"),
    [
        ("left_matrix", np.zeros((3, 3)), "focal"),
        ("right_matrix", np.full((3, 3), np.nan), "focal"),
        ("rotation", np.diag([1.0, 1, -1]), "determinant"),
        ("rotation", 2 * np.eye(3), "orthogonal"),
        ("translation_m", np.zeros(3), "metres"),
        ("translation_m", np.array([np.inf, 0, 0]), "metres"),
    ],
)
def test_what_is_no_rig_is_refused(part, value, words):
    good = rig()
    parts = {name: getattr(good, name) for name in ("left_matrix", "right_matrix", "rotation", "translation_m")}
    with pytest.raises(GeometryError, match=words):
        StereoRig(**{**parts, part: value})
