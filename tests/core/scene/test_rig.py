"""Raw pairs of known cameras: points of space that two lenses saw lie on one row, at the disparity of their depth."""

from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from ruamel.yaml import YAML

from tangible_core.data import Views
from tangible_core.errors import ConfigError, GeometryError, PictureError
from tangible_core.scene.formats.rigs import read_rig
from tangible_core.scene.rig import Camera, StereoRig, rectify_views, undistort_points
from tangible_core.scene.scene import Scene
from tangible_core.scene.scene_source import source_of_arguments

SHAPE = 90, 120
BLANK = np.zeros(SHAPE, np.uint8)
RADIAL = (-0.2, 0.05, 0.001, -0.002)
FISHEYE = (0.02, -0.01, 0.003, -0.001)
LENSES = {
    "none": ((), "radial-tangential"),
    "radial": (RADIAL, "radial-tangential"),
    "fisheye": (FISHEYE, "equidistant"),
}


def turn_of(*radians: float) -> np.ndarray:
    return cv2.Rodrigues(np.array(radians, float))[0]


def rig(turn=(0.02, -0.05, 0.01), move=(-0.1, 0.01, 0.005), lens: str = "none") -> StereoRig:
    coefficients, model = LENSES[lens]
    left, right = (
        Camera(np.array([[focal, 0, 60.0], [0, focal + 3, 44.0], [0, 0, 1]]), np.array(coefficients, float), model)
        for focal in (110.0, 115.0)
    )
    return StereoRig(left, right, turn_of(*turn), np.array(move))


def seen(points_m: np.ndarray, camera: Camera) -> np.ndarray:
    """Where a camera sees points of its own frame, by OpenCV's projection."""
    coefficients = camera.distortion if camera.distortion.size else np.zeros(4)
    project = cv2.fisheye.projectPoints if camera.model == "equidistant" else cv2.projectPoints
    if camera.model == "equidistant":
        projected = project(points_m[None], np.zeros(3), np.zeros(3), camera.matrix, coefficients)[0]
    else:
        projected = project(points_m, np.zeros(3), np.zeros(3), camera.matrix, coefficients)[0]
    return projected.reshape(-1, 2)


def axes_of(cameras: StereoRig) -> np.ndarray:
    x = np.array(cameras.centre_m) / np.linalg.norm(cameras.centre_m)
    y = np.cross(cameras.rotation[2] + [0, 0, 1], x)
    y /= np.linalg.norm(y)
    return np.stack([x, y, np.cross(x, y)])


@pytest.mark.parametrize("lens", LENSES)
@given(
    turn=st.tuples(*[st.floats(-0.08, 0.08)] * 3),
    move=st.tuples(st.floats(-0.3, -0.05), st.floats(-0.03, 0.03), st.floats(-0.03, 0.03)),
)
def test_rectified_points_share_rows_and_give_exact_depth(lens, turn, move):
    cameras = rig(turn, move, lens)
    calibration = rectify_views(Views(BLANK, BLANK), cameras).views.calibration
    assert calibration is not None
    points = np.random.default_rng(0).uniform([-0.3, -0.25, 1], [0.3, 0.25, 3], (50, 3))
    axes, camera = axes_of(cameras), np.diag([calibration.focal_px, calibration.focal_px, 1.0])
    left = undistort_points(seen(points, cameras.left), cameras.left, axes, camera)
    theirs = points @ cameras.rotation.T + cameras.translation_m
    right = undistort_points(seen(theirs, cameras.right), cameras.right, axes @ cameras.rotation.T, camera)
    assert left[:, 1] == pytest.approx(right[:, 1], abs=1e-3)
    disparity = (left - right)[:, 0]
    assert calibration.focal_px * calibration.baseline_m / disparity == pytest.approx(points @ axes[2], rel=1e-3)
    assert calibration.baseline_m == pytest.approx(np.linalg.norm(move))


@pytest.mark.parametrize("lens", LENSES)
def test_rectified_pictures_follow_their_points(lens: str):
    """Bright dots of a scene at one depth are found on one row in both turned pictures."""
    cameras = rig(lens=lens)
    dots = np.array([[x, y, 1.5] for x in (-0.4, 0.0, 0.4) for y in (-0.25, 0.25)])
    views = []
    for points, camera in ((dots, cameras.left), (dots @ cameras.rotation.T + cameras.translation_m, cameras.right)):
        picture = np.zeros(SHAPE, np.float32)
        columns, rows = np.meshgrid(np.arange(SHAPE[1]), np.arange(SHAPE[0]))
        for x, y in seen(points, camera):
            picture += np.exp(-((columns - x) ** 2 + (rows - y) ** 2) / 8).astype(np.float32)
        views.append(np.clip(picture, 0, 1))
    rectified = rectify_views(Views(*views), cameras)
    assert rectified.known.shape == rectified.views.shape and rectified.known.mean() > 0.5
    assert rectified.views.right is not None and rectified.views.right.shape == rectified.views.shape
    rows_lit = [np.sort(peaks(each)[:, 0]) for each in (rectified.views.left, rectified.views.right)]
    np.testing.assert_allclose(*rows_lit, atol=0.3)


def peaks(picture: np.ndarray) -> np.ndarray:
    """Rows and columns of the six brightest blobs, to a fraction of a pixel."""
    rest, peaks_px = picture.copy(), []
    for _ in range(6):
        row, column = np.unravel_index(np.argmax(rest), rest.shape)
        rows, columns = np.s_[max(0, row - 5) : row + 6], np.s_[max(0, column - 5) : column + 6]
        part = rest[rows, columns]
        inner = np.indices(part.shape).reshape(2, -1)
        peaks_px.append((inner * part.ravel()).sum(axis=1) / part.sum() + [rows.start, columns.start])
        rest[rows, columns] = 0
    return np.array(peaks_px)


@pytest.mark.parametrize("dtype", [np.uint8, np.uint16, bool, np.float32])
@pytest.mark.parametrize("channels", [(), (3,), (4,)])
def test_rectified_pictures_keep_dtype_and_channels(dtype, channels):
    picture = (np.random.default_rng(0).random((*SHAPE, *channels)) > 0.5).astype(dtype)
    rectified = rectify_views(Views(picture, picture), rig(lens="radial")).views
    assert rectified.left.shape[2:] == channels
    assert rectified.left.max() <= picture.max()


def test_rectifying_one_view_raises():
    with pytest.raises(PictureError, match="two views"):
        rectify_views(Views(BLANK), rig())


@pytest.mark.parametrize("move", [(0.1, 0, 0), (0.0, 0.0, -0.5), (-0.01, 0.2, 0.0)])
def test_rig_with_the_right_camera_elsewhere_raises(move):
    with pytest.raises(GeometryError, match="exchange left and right, or check the translation"):
        rig((0, 0, 0), move)


@pytest.mark.parametrize(
    ("part", "value", "words"),
    [
        ("rotation", np.diag([1.0, 1, -1]), "determinant"),
        ("rotation", 2 * np.eye(3), "orthogonal"),
        ("translation_m", np.zeros(3), "metres"),
        ("translation_m", np.array([np.inf, 0, 0]), "metres"),
    ],
)
def test_rig_refuses_wrong_rotation_and_translation(part, value, words):
    good = rig()
    parts = {name: getattr(good, name) for name in ("left", "right", "rotation", "translation_m")}
    with pytest.raises(GeometryError, match=words):
        StereoRig(**{**parts, part: value})


@pytest.mark.parametrize(
    ("matrix", "distortion", "words"),
    [
        (np.zeros((3, 3)), np.zeros(0), "focal"),
        (np.full((3, 3), np.nan), np.zeros(0), "focal"),
        (np.eye(3), np.zeros(3), "coefficients"),
        (np.eye(3), np.full(4, np.nan), "coefficients"),
    ],
)
def test_camera_refuses_wrong_matrix_and_distortion(matrix, distortion, words):
    with pytest.raises(GeometryError, match=words):
        Camera(matrix, distortion)


KALIBR = """\
cam0:
  camera_model: pinhole
  intrinsics: [110.0, 113.0, 60.0, 44.0]
  distortion_model: {model}
  distortion_coeffs: {coefficients}
  resolution: [120, 90]
cam1:
  T_cn_cnm1:
  - [1.0, 0.0, 0.0, -0.1]
  - [0.0, 1.0, 0.0, 0.01]
  - [0.0, 0.0, 1.0, 0.005]
  - [0.0, 0.0, 0.0, 1.0]
  camera_model: pinhole
  intrinsics: [115.0, 118.0, 60.0, 44.0]
  distortion_model: {model}
  distortion_coeffs: {coefficients}
  resolution: [120, 90]
"""
KALIBR_NONE = KALIBR.format(model="none", coefficients=[])


def write_opencv(path: Path, cameras: StereoRig, unit_m: float = 1.0) -> None:
    """As cv2.FileStorage writes it."""
    storage = cv2.FileStorage(str(path), cv2.FILE_STORAGE_WRITE)
    for name, value in {
        "M1": cameras.left.matrix, "D1": cameras.left.distortion[None], "M2": cameras.right.matrix,
        "D2": cameras.right.distortion[None], "R": cameras.rotation, "T": cameras.translation_m[:, None] / unit_m,
    }.items():  # fmt: skip
        storage.write(name, value)
    storage.release()


class TestFiles:
    @pytest.mark.parametrize("unit_m", [1.0, 0.001])
    def test_opencv_file_gives_the_same_rig(self, tmp_path: Path, unit_m: float):
        cameras = rig(lens="radial")
        write_opencv(tmp_path / "rig.yml", cameras, unit_m)
        found, size = read_rig(tmp_path / "rig.yml", unit_m)
        assert size is None
        for side in ("left", "right"):
            np.testing.assert_array_equal(getattr(found, side).matrix, getattr(cameras, side).matrix)
            np.testing.assert_array_equal(getattr(found, side).distortion, getattr(cameras, side).distortion)
        np.testing.assert_allclose(found.rotation, cameras.rotation, atol=1e-15)
        np.testing.assert_allclose(found.translation_m, cameras.translation_m, atol=1e-12)

    @pytest.mark.parametrize("head", ["%YAML:1.0\n---\n", "%YAML 1.0\n---\n", ""])
    def test_head_of_opencv_or_of_yaml_1_0_or_none_is_read(self, tmp_path: Path, head: str):
        write_opencv(tmp_path / "rig.yml", rig(lens="radial"))
        text = (tmp_path / "rig.yml").read_text()
        (tmp_path / "rig.yml").write_text(head + text[text.index("M1:") :])
        assert read_rig(tmp_path / "rig.yml").cameras.left.distortion.size == 4

    @pytest.mark.parametrize("model", ["radtan", "equidistant"])
    def test_kalibr_file_gives_the_same_rig(self, tmp_path: Path, model: str):
        (tmp_path / "camchain.yaml").write_text(KALIBR.format(model=model, coefficients=list(FISHEYE)))
        found, size = read_rig(tmp_path / "camchain.yaml")
        assert size == (120, 90)
        for camera, focal in ((found.left, 110), (found.right, 115)):
            assert camera.model == ("equidistant" if model == "equidistant" else "radial-tangential")
            assert camera.matrix.tolist() == [[focal, 0, 60], [0, focal + 3, 44], [0, 0, 1]]
            assert camera.distortion.tolist() == list(FISHEYE)
        assert found.translation_m.tolist() == [-0.1, 0.01, 0.005]
        in_mm, _ = read_rig(tmp_path / "camchain.yaml", 0.001)
        assert in_mm.translation_m == pytest.approx([-1e-4, 1e-5, 5e-6], rel=1e-12)

    def test_kalibr_pose_turns_points_of_the_left_camera_into_the_right_one(self, tmp_path: Path):
        """What lies ahead of the left camera lies to the left of the right one."""
        pose = [[0.6, 0, -0.8, -0.064], [0, 1.0, 0, -0.01], [0.8, 0, 0.6, -0.077], [0, 0, 0, 1.0]]
        before = KALIBR[KALIBR.index("  - [1.0") : KALIBR.index("  camera_model: pinhole\n  intrinsics: [115")]
        text = KALIBR.replace(before, "".join(f"  - {row}\n" for row in pose))
        (tmp_path / "camchain.yaml").write_text(text.format(model="none", coefficients=[]))
        found, _ = read_rig(tmp_path / "camchain.yaml")
        seen_m = np.einsum("ij,j->i", found.rotation, [0.0, 0.0, 1.0]) + found.translation_m
        assert seen_m == pytest.approx([-0.864, -0.01, 0.523])
        assert found.centre_m == pytest.approx((0.1, 0.01, -0.005))

    def test_kalibr_pose_takes_points_of_the_left_camera_to_the_right_one_in_the_unit_of_the_file(self, tmp_path: Path):
        """A right camera that is turned by 0.1 rad to its right sees what is ahead of the left one on its left."""
        cos, sin = np.cos(0.1), np.sin(0.1)
        pose = [[cos, 0, -sin, -0.1 * cos], [0, 1, 0, 0], [sin, 0, cos, -0.1 * sin], [0, 0, 0, 1]]
        chain = YAML(typ="safe").load(KALIBR_NONE)
        chain["cam1"]["T_cn_cnm1"] = np.array(pose).tolist()
        YAML(typ="safe").dump(chain, tmp_path / "camchain.yaml")
        found, _ = read_rig(tmp_path / "camchain.yaml", 0.001)
        np.testing.assert_allclose(found.centre_m, (1e-4, 0, 0), atol=1e-12)
        ahead = found.rotation @ [0, 0, 1.0] + found.translation_m
        assert ahead[0] < -0.09

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("M1: 3\n", "rig.yml: has no left matrix (M1, K1"),
            ("a: [1\n", "rig.yml:2:1"),
            ("- 1\n", "rig.yml:1:1: a calibration of two cameras is a mapping"),
            (
                "M1: !!opencv-matrix {rows: 3, cols: 3, data: [1, 2]}\n",
                "3 rows and 3 cols are not 2 numbers",
            ),
            ("cam0: 5\ncam1: {}\n", "cam0 is a camera with camera_model pinhole, not 5"),
            ("cam0: {camera_model: omni}\ncam1: {}\n", "cam0 is a camera with camera_model pinhole"),
            (KALIBR.format(model="fov", coefficients=[]), "distortion_model: 'fov' is not one of radtan"),
            (KALIBR.format(model="radtan", coefficients=["x"]), "distortion_coeffs must be a list of finite numbers"),
            (KALIBR.format(model="radtan", coefficients=[1]), "rig.yml: a radial-tangential lens has 0 or 4"),
            (KALIBR.format(model="none", coefficients=[]).replace("110.0, ", ""), "is [fu, fv, pu, pv]"),
            (KALIBR.format(model="none", coefficients=[]).replace("T_cn_cnm1", "T"), "is the 4 x 4 pose of cam1"),
            (KALIBR_NONE.replace("[120, 90]", "[.nan, 48]"), "cam0.resolution must be a list of finite numbers"),
            (KALIBR_NONE.replace("[120, 90]", "[120]"), "cam0.resolution is [width, height] in pixels, not [120]"),
            (KALIBR_NONE.replace("[120, 90]", "[120, -90]"), "cam0.resolution is [width, height] in pixels"),
            (KALIBR_NONE.replace("[120, 90]", "120"), "cam0.resolution must be a list of finite numbers, not 120"),
            (KALIBR_NONE.replace("110.0,", "true,"), "cam0.intrinsics must be a list of finite numbers"),
            (KALIBR_NONE.replace("110.0,", "1e999,"), "cam0.intrinsics must be a list of finite numbers"),
            (KALIBR_NONE.replace("0.0, 1.0, 0.0, 0.01", "0.0"), "cam1.T_cn_cnm1 must be a list of finite numbers"),
            ("M1: {rows: 1, cols: 1, data: 5}\n", "rig.yml: left matrix must be a list of finite numbers, not 5"),
            ("M1: {rows: -3, cols: -3, data: [1,2,3,4,5,6,7,8,9]}\n", "-3 rows and -3 cols are not 9 numbers"),
            ("M1: {rows: true, cols: 1, data: [1]}\n", "True rows and 1 cols are not 1 numbers"),
            ("M1: {rows: 1, cols: 1, data: [[1, 2]]}\n", "1 rows and 1 cols are not 2 numbers"),
        ],
    )
    def test_wrong_calibration_file_raises(self, tmp_path: Path, text: str, message: str):
        (tmp_path / "rig.yml").write_text(text)
        with pytest.raises((ConfigError, GeometryError)) as caught:
            read_rig(tmp_path / "rig.yml")
        assert message in str(caught.value)


class TestScene:
    @pytest.fixture
    def folder(self, tmp_path: Path) -> Path:
        for name in ("left", "right"):
            np.save(tmp_path / f"{name}.npy", np.random.default_rng(0).random(SHAPE).astype(np.float32))
        write_opencv(tmp_path / "rig.yml", rig(lens="radial"))
        return tmp_path

    def test_rig_from_a_file_equals_rig_from_arrays(self, folder: Path):
        left, right = (np.load(folder / f"{name}.npy") for name in ("left", "right"))
        of_files = Scene.pair(left=folder / "left.npy", right=folder / "right.npy", rig=folder / "rig.yml")
        of_arrays = Scene.pair(left, right, rig=rig(lens="radial"))
        assert of_files.views is not None and of_arrays.views is not None
        np.testing.assert_allclose(of_files.views.left, of_arrays.views.left, atol=1e-6)
        assert of_files.views.calibration is not None
        assert of_files.views.calibration.baseline_m == pytest.approx(np.linalg.norm((-0.1, 0.01, 0.005)))
        assert of_files.known is not None and not of_files.known.all()

    def test_pipeline_file_takes_a_rig(self, folder: Path):
        from tangible_core import load_pipeline

        (folder / "p.yaml").write_text("scene: {left: left.npy, right: right.npy, rig: rig.yml, rig_unit_m: 0.5}\n")
        views = load_pipeline(folder / "p.yaml").scene.views
        assert views is not None and views.calibration is not None
        assert views.calibration.baseline_m == pytest.approx(np.linalg.norm((-0.05, 0.005, 0.0025)))

    def test_rig_for_another_picture_size_raises(self, folder: Path):
        (folder / "rig.yml").write_text(KALIBR.format(model="none", coefficients=[]).replace("[120, 90]", "[752, 480]"))
        with pytest.raises(PictureError, match=r"left\.npy is not 752 x 480"):
            Scene.pair(left=folder / "left.npy", right=folder / "right.npy", rig=folder / "rig.yml")

    @pytest.mark.parametrize(
        ("options", "message"),
        [
            ({"truth": np.ones(SHAPE)}, "rig gives the cameras.*leave out truth"),
            ({"segments": np.ones(SHAPE, int)}, "leave out segments"),
        ],
    )
    def test_rig_with_incompatible_options_raises(self, folder: Path, options: dict, message: str):
        with pytest.raises(ConfigError, match=message):
            Scene.pair(left=BLANK, right=BLANK, rig=folder / "rig.yml", **options)

    def test_rig_without_a_pair_raises(self, folder: Path):
        with pytest.raises(ConfigError, match="rig needs left"):
            source_of_arguments({"photo": BLANK, "rig": folder / "rig.yml"})
