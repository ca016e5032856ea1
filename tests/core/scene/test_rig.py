"""If one of these fails, a raw pair of known cameras is felt at wrong depths, or a wrong calibration is not refused."""

import re
from pathlib import Path

import cv2
import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from PIL import Image

import file_readers
from tangible_core import Pipeline, Workspace, load_pipeline
from tangible_core.data import Calibration, Views
from tangible_core.errors import ConfigError, GeometryError, PictureError
from tangible_core.pipeline.starter import starter
from tangible_core.scene.formats.rigs import read_rig
from tangible_core.scene.rig import Camera, StereoRig, rectify_views, undistort_points
from tangible_core.scene.scene import Scene
from tangible_core.scene.scene_source import make_source
from tangible_depth import SemiGlobal

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


def assert_shared_rows_and_exact_depth(cameras: StereoRig, calibration: Calibration) -> None:
    points = np.random.default_rng(0).uniform([-0.3, -0.25, 1], [0.3, 0.25, 3], (50, 3))
    axes, camera = axes_of(cameras), np.diag([calibration.focal_px, calibration.focal_px, 1.0])
    left = undistort_points(seen(points, cameras.left), cameras.left, axes, camera)
    theirs = points @ cameras.rotation.T + cameras.translation_m
    right = undistort_points(seen(theirs, cameras.right), cameras.right, axes @ cameras.rotation.T, camera)
    assert left[:, 1] == pytest.approx(right[:, 1], abs=1e-3)
    disparity = (left - right)[:, 0]
    assert calibration.focal_px * calibration.baseline_m / disparity == pytest.approx(points @ axes[2], rel=1e-3)


@pytest.mark.parametrize("vertical", [False, True])
@pytest.mark.parametrize("lens", LENSES)
@given(
    turn=st.tuples(*[st.floats(-0.08, 0.08)] * 3),
    along=st.floats(-0.3, -0.05),
    aside=st.tuples(*[st.floats(-0.03, 0.03)] * 2),
)
def test_rectified_points_share_rows_and_give_exact_depth(lens, vertical, turn, along, aside):
    """Cameras above each other: the canvas lies on its side, its rows along the baseline."""
    move = (aside[0], along, aside[1]) if vertical else (along, *aside)
    cameras = rig(turn, move, lens)
    calibration = rectify_views(Views(BLANK, BLANK), cameras).views.calibration
    assert calibration is not None and calibration.vertical == vertical
    assert_shared_rows_and_exact_depth(cameras, calibration)
    assert calibration.baseline_m == pytest.approx(np.linalg.norm(move))


@pytest.mark.parametrize("lens", LENSES)
def test_rectified_pictures_show_the_points_of_their_pixels(lens: str):
    """Rectify pictures of the pixels' own columns and rows: each number is the place that a pixel shows."""
    cameras = rig(lens=lens)
    axes = axes_of(cameras)
    rows, columns = np.indices(SHAPE, np.float32)
    of_columns, of_rows = (rectify_views(Views(each, each), cameras) for each in (columns, rows))
    focal_px, offsets = of_rows.views.calibration.focal_px, []
    for side, camera, turn in (("left", cameras.left, axes), ("right", cameras.right, axes @ cameras.rotation.T)):
        shown = np.dstack([getattr(each.views, side) for each in (of_columns, of_rows)])
        found = undistort_points(shown.reshape(-1, 2), camera, turn, np.diag([focal_px, focal_px, 1.0]))
        canvas_rows, canvas_columns = np.indices(shown.shape[:2])
        shift = found.reshape(shown.shape) - np.dstack([canvas_columns, canvas_rows])
        middle = shift[shift.shape[0] // 4 : -shift.shape[0] // 4, shift.shape[1] // 4 : -shift.shape[1] // 4]
        assert np.ptp(middle, axis=(0, 1)).max() < 0.2
        offsets.append(middle.mean(axis=(0, 1)))
    assert offsets[0] == pytest.approx(offsets[1], abs=0.02)
    assert of_rows.known.mean() > 0.5


@pytest.mark.parametrize("finest_m", [0, 8e-4])
def test_vertical_pair_is_felt_upright_at_the_disparity_of_its_depths(finest_m: float):
    """A box at 1 m stands before a wall at 4 m; the second camera stands 10 cm below the first one."""
    random = np.random.default_rng(0)
    left = random.integers(0, 100, (120, 200), np.uint8)
    right = np.roll(left, -4, axis=0)
    box = random.integers(120, 255, (30, 40), np.uint8)
    left[60:90, 130:170] = right[44:74, 130:170] = box
    camera = Camera(np.array([[160.0, 0, 100], [0, 160, 60], [0, 0, 1]]), np.zeros(0))
    scene = Scene.pair(left, right, rig=StereoRig(camera, camera, np.eye(3), np.array([0, -0.1, 0])))
    assert scene.views is not None and scene.views.right is not None
    np.testing.assert_array_equal(scene.views.left, left)
    np.testing.assert_array_equal(scene.views.right, right)
    workspace = Workspace(width_m=0.08, finest_m=finest_m)
    pipeline = Pipeline(scene, depth=SemiGlobal(), workspace=workspace, cached=False)
    disparity = pipeline.disparity.disparity_px
    assert disparity.shape == left.shape
    assert np.median(disparity[65:85, 135:165]) == pytest.approx(16, abs=0.5)
    assert np.median(disparity[:, :100]) == pytest.approx(4, abs=0.5)
    assert pipeline.relief.height_m.shape == ((120, 200) if not finest_m else (60, 100))


def test_rotation_of_four_decimals_becomes_the_nearest_rotation():
    """The nearest rotation is U V of the singular vectors (Higham, Functions of Matrices, theorem 8.4)."""
    exact = turn_of(0.02, -0.05, 0.3)
    rounded = np.round(exact, 4)
    good = rig()
    found = StereoRig(good.left, good.right, rounded, good.translation_m).rotation
    left, _, right = np.linalg.svd(rounded)
    np.testing.assert_allclose(found, left @ right, atol=1e-14)
    np.testing.assert_allclose(found, exact, atol=1e-4)
    np.testing.assert_allclose(found @ found.T, np.eye(3), atol=1e-14)
    assert rounded.flags.writeable
    np.testing.assert_array_equal(StereoRig(good.left, good.right, exact, good.translation_m).rotation, exact)
    with pytest.raises(GeometryError, match="orthogonal"):
        StereoRig(good.left, good.right, np.round(exact, 2), good.translation_m)


@pytest.mark.parametrize("move", [(0.1, 0, 0), (0.0, 0.0, -0.5), (-0.01, 0.2, 0.0)])
def test_rig_with_the_right_camera_elsewhere_raises(move):
    with pytest.raises(GeometryError, match="translation"):
        rig((0, 0, 0), move)
    with pytest.raises(PictureError, match="two views"):
        rectify_views(Views(BLANK), rig())


@pytest.mark.parametrize(
    ("part", "value"),
    [
        ("rotation", np.diag([1.0, 1, -1])),
        ("rotation", 2 * np.eye(3)),
        *(("translation_m", np.array([x, 0, 0])) for x in (0, np.inf)),
    ],
)
def test_rig_refuses_wrong_rotation_and_translation(part, value):
    good = rig()
    parts = {name: getattr(good, name) for name in ("left", "right", "rotation", "translation_m")}
    with pytest.raises(GeometryError):
        StereoRig(**{**parts, part: value})


@pytest.mark.parametrize(
    ("matrix", "distortion", "word"),
    [
        (np.zeros((3, 3)), np.zeros(0), "focal"),
        (np.full((3, 3), np.nan), np.zeros(0), "focal"),
        (np.eye(3), np.zeros(3), "coefficients"),
        (np.eye(3), np.full(4, np.nan), "coefficients"),
    ],
)
def test_camera_refuses_wrong_matrix_and_distortion(matrix, distortion, word):
    with pytest.raises(GeometryError, match=word):
        Camera(matrix, distortion)


KALIBR = re.sub(r"(distortion_model: ).*", r"\1{model}", file_readers.KALIBR.replace("[16, 12]", "[120, 90]"))
KALIBR = re.sub(r"(distortion_coeffs: ).*", r"\1{coefficients}", KALIBR)
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
    @pytest.mark.parametrize(("suffix", "unit_m"), [("yml", 1.0), ("yml", 0.001), ("xml", 1.0), ("json", 1.0)])
    def test_opencv_file_gives_the_same_rig(self, tmp_path: Path, suffix: str, unit_m: float):
        cameras = rig(lens="radial")
        write_opencv(tmp_path / f"rig.{suffix}", cameras, unit_m)
        found, size = read_rig(tmp_path / f"rig.{suffix}", unit_m)
        assert size is None
        for side in ("left", "right"):
            np.testing.assert_array_equal(getattr(found, side).matrix, getattr(cameras, side).matrix)
            np.testing.assert_array_equal(getattr(found, side).distortion, getattr(cameras, side).distortion)
        np.testing.assert_allclose(found.rotation, cameras.rotation, atol=1e-15)
        np.testing.assert_allclose(found.translation_m, cameras.translation_m, atol=1e-12)

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
        pose = [[0.6, 0, -0.8, -0.064], [0, 1.0, 0, -0.01], [0.8, 0, 0.6, -0.077], [0, 0, 0, 1.0]]
        before = KALIBR[KALIBR.index("  - [1.0") : KALIBR.index("  camera_model: pinhole\n  intrinsics: [115")]
        text = KALIBR.replace(before, "".join(f"  - {row}\n" for row in pose))
        (tmp_path / "camchain.yaml").write_text(text.format(model="none", coefficients=[]))
        found, _ = read_rig(tmp_path / "camchain.yaml")
        seen_m = np.einsum("ij,j->i", found.rotation, [0.0, 0.0, 1.0]) + found.translation_m
        assert seen_m == pytest.approx([-0.864, -0.01, 0.523])
        assert found.centre_m == pytest.approx((0.1, 0.01, -0.005))

    @pytest.mark.parametrize(
        ("text", "message"),
        [
            ("M1: 3\n", "left matrix"),
            ("a: [1\n", "rig.yml:2:1"),
            ("- 1\n", "mapping"),
            ("cam0: 5\ncam1: {}\n", "camera_model pinhole"),
            ("cam0: {camera_model: omni}\ncam1: {}\n", "camera_model pinhole"),
            (KALIBR.format(model="fov", coefficients=[]), "distortion_model"),
            (KALIBR.format(model="radtan", coefficients=["x"]), "distortion_coeffs"),
            (KALIBR.format(model="radtan", coefficients=[1]), "0 or 4"),
            (KALIBR_NONE.replace("110.0, ", ""), "is [fu, fv, pu, pv]"),
            (KALIBR_NONE.replace("T_cn_cnm1", "T"), "4 x 4 pose of cam1"),
            *(
                (KALIBR_NONE.replace("[120, 90]", size), "resolution")
                for size in ("[.nan, 48]", "[120]", "[9, -9]", "1")
            ),
            *((KALIBR_NONE.replace("110.0", number), "cam0.intrinsics") for number in ("true", "1e999")),
            (KALIBR_NONE.replace("0.0, 1.0, 0.0, 0.01", "0.0"), "cam1.T_cn_cnm1"),
            ("M1: {rows: 3, cols: 3, data: [1, 2]}\n", "not 2 numbers"),
            ("M1: {rows: 1, cols: 1, data: 5}\n", "left matrix"),
            ("M1: {rows: -3, cols: -3, data: [1,2,3,4,5,6,7,8,9]}\n", "not 9 numbers"),
            ("M1: {rows: true, cols: 1, data: [1]}\n", "True rows"),
            ("M1: {rows: 1, cols: 1, data: [[1, 2]]}\n", "not 2 numbers"),
        ],
    )
    def test_wrong_calibration_file_raises(self, tmp_path: Path, text: str, message: str):
        (tmp_path / "rig.yml").write_text(text)
        with pytest.raises((ConfigError, GeometryError)) as caught:
            read_rig(tmp_path / "rig.yml")
        assert message in str(caught.value)


MIDDLEBURY = """\
cam0=[994.978 0 60.5; 0 994.978 44; 0 0 1]
cam1=[994.978 0 91.5; 0 994.978 44; 0 0 1]
doffs=31
baseline=193.001
width=120
height=90
ndisp=64
isint=0
"""
KITTI = """\
P0: 7.2e+02 0 6.0e+01 0 0 7.2e+02 4.4e+01 0 0 0 1 0
P1: 7.2e+02 0 6.0e+01 -3.6e+02 0 7.2e+02 4.4e+01 0 0 0 1 0
P2: 7.2e+02 0 6.0e+01 4.5e+01 0 7.2e+02 4.4e+01 2.2e-01 0 0 1 2.7e-03
P3: 7.2e+02 0 6.0e+01 -3.4e+02 0 7.2e+02 4.4e+01 2.2e-01 0 0 1 2.7e-03
Tr: 4.3e-04 -1 0 0 0 0 -1 0 1 0 0 -0.3
"""
KITTI_RAW = """\
calib_time: 09-Jan-2012 13:57:47
S_02: 1.392000e+03 5.120000e+02
K_02: 9.6e+02 0 6.9e+02 0 9.5e+02 2.2e+02 0 0 1
S_rect_02: 1.242000e+03 3.750000e+02
P_rect_02: 7.2e+02 0 6.0e+01 4.5e+01 0 7.2e+02 4.4e+01 0 0 0 1 0
P_rect_03: 7.2e+02 0 6.0e+01 -3.4e+02 0 7.2e+02 4.4e+01 0 0 0 1 0
"""


def ros(side: str, matrix: np.ndarray, turn: np.ndarray, projection: np.ndarray, short: bool = False) -> str:
    """Return a camera as ROS's camera_calibration writes it; short: as `rostopic echo camera_info` prints it."""
    parts = {"camera_matrix": matrix, "rectification_matrix": turn, "projection_matrix": projection}
    if short:
        names = {"camera_matrix": "K", "rectification_matrix": "R", "projection_matrix": "P"}
        flat = "".join(f"{names[part]}: {values.ravel().tolist()}\n" for part, values in parts.items())
        return f"height: 90\nwidth: 120\ndistortion_model: plumb_bob\nD: {[*RADIAL, 0.0]}\n{flat}"
    blocks = "".join(
        f"{part}:\n  rows: {len(values)}\n  cols: {values.shape[1]}\n  data: {values.ravel().tolist()}\n"
        for part, values in parts.items()
    )
    return (
        f"image_width: 120\nimage_height: 90\ncamera_name: {side}\ndistortion_model: plumb_bob\n"
        f"distortion_coefficients:\n  rows: 1\n  cols: 5\n  data: {[*RADIAL, 0.0]}\n{blocks}"
    )


class TestMoreFormats:
    def test_middlebury_is_in_millimetres_and_its_offset_is_taken_off(self, tmp_path: Path):
        (tmp_path / "calib.txt").write_bytes(b"\xef\xbb\xbf" + MIDDLEBURY.replace("\n", "\r\n").encode())
        cameras, size = read_rig(tmp_path / "calib.txt")
        assert size == (120, 90)
        assert cameras.centre_m == pytest.approx((0.193001, 0, 0))
        right = np.random.default_rng(0).random(SHAPE).astype(np.float32)
        rectified = rectify_views(Views(right, right), cameras).views
        assert rectified.right is not None and rectified.calibration is not None
        np.testing.assert_allclose(rectified.left, right, atol=1e-5)
        np.testing.assert_allclose(rectified.right[:, :89], right[:, 31:], atol=1e-5)
        assert (rectified.calibration.focal_px, rectified.calibration.offset_px) == (994.978, 0)
        assert read_rig(tmp_path / "calib.txt", 0.01).cameras.centre_m[0] == pytest.approx(1.93001)

    @pytest.mark.parametrize(
        ("text", "size"), [(KITTI, None), (KITTI_RAW, (1242, 375)), (KITTI.replace("P2", "X").replace("P3", "Y"), None)]
    )
    def test_kitti_has_the_baseline_of_its_two_projections(self, tmp_path: Path, text: str, size):
        """(45 + 340) / 720 in colour, and 360 / 720 in grey."""
        (tmp_path / "calib.txt").write_text(text)
        cameras, found = read_rig(tmp_path / "calib.txt")
        assert found == size
        assert cameras.centre_m == pytest.approx((0.5 if "X:" in text else 385 / 720, 0, 0))
        assert cameras.left.matrix.tolist() == [[720, 0, 60], [0, 720, 44], [0, 0, 1]]

    @pytest.mark.parametrize("short", [False, True])
    def test_ros_cameras_give_the_rig_that_opencv_rectified(self, tmp_path: Path, short: bool):
        cameras = rig(lens="radial")
        matrices = [cameras.left.matrix, cameras.right.matrix]
        lens = np.array([*RADIAL, 0.0])
        turns_and_projections = cv2.stereoRectify(
            matrices[0], lens, matrices[1], lens, SHAPE[::-1], cameras.rotation, cameras.translation_m[:, None]
        )
        for number, side in enumerate(("left", "right")):
            turn, projection = turns_and_projections[number], turns_and_projections[2 + number]
            (tmp_path / f"{side}.yaml").write_text(ros(side, matrices[number], turn, projection, short))
        found, size = read_rig(tmp_path / "left.yaml")
        assert size == (120, 90)
        np.testing.assert_allclose(found.rotation, cameras.rotation, atol=1e-9)
        np.testing.assert_allclose(found.translation_m, cameras.translation_m, atol=1e-9)
        np.testing.assert_array_equal(found.right.matrix, matrices[1])
        assert found.left.distortion.tolist() == lens.tolist()

    def test_intrinsics_are_read_with_the_extrinsics_beside_them(self, tmp_path: Path):
        write_opencv(tmp_path / "rig.yml", rig())
        lines = (tmp_path / "rig.yml").read_text()
        split = lines.index("R:")
        (tmp_path / "intrinsics.yml").write_text(lines[:split])
        (tmp_path / "extrinsics.yml").write_text("%YAML:1.0\n---\n" + lines[split:])
        assert read_rig(tmp_path / "intrinsics.yml").cameras.centre_m == pytest.approx(rig().centre_m)

    @pytest.mark.parametrize(
        ("name", "text", "message"),
        [
            ("calib.txt", MIDDLEBURY.replace("baseline=193.001\n", ""), "baseline"),
            ("calib.txt", MIDDLEBURY.replace("91.5", "x"), "cam1"),
            ("calib.txt", KITTI.replace("7.2e+02", "nan"), "P2"),
            ("calib.txt", KITTI.replace("7.2e+02", "0"), "positive focal lengths"),
            ("calib.txt", KITTI_RAW.replace("1.242000e+03", "1e999"), "S_rect_02"),
            ("calib.txt", KITTI.replace("-3.4e+02", "9e+02"), "neither to its right nor below"),
            ("left.yaml", "camera_matrix: {data: [1]}\n", "left camera matrix"),
            ("rig.xml", "<opencv_storage><M1>", "not XML"),
            ("rig.xml", "<!DOCTYPE a [<!ENTITY b 'c'>]><opencv_storage/>", "document type"),
            ("rig.xml", "<opencv_storage><M1><rows>x</rows></M1></opencv_storage>", "not XML"),
            ("rig.xml", "<opencv_storage/>", "left matrix"),
        ],
    )
    def test_wrong_file_raises_with_its_part(self, tmp_path: Path, name: str, text: str, message: str):
        (tmp_path / name).write_text(text)
        (tmp_path / "right.yaml").write_text("K: [1]\n")
        with pytest.raises((ConfigError, GeometryError)) as caught:
            read_rig(tmp_path / name)
        assert str(caught.value).startswith(str(tmp_path / name)) and message in str(caught.value)


class TestFoundRig:
    @pytest.fixture
    def folder(self, tmp_path: Path) -> Path:
        for name in ("left", "right"):
            Image.fromarray(np.random.default_rng(0).integers(0, 255, SHAPE, np.uint8)).save(tmp_path / f"{name}.png")
        (tmp_path / "calib.txt").write_text(MIDDLEBURY)
        return tmp_path

    def test_run_says_that_there_is_a_rig_and_questions_its_baseline(self, folder: Path):
        (folder / "p.yaml").write_text("scene: {left: left.png, right: right.png}\n")
        scene = load_pipeline(folder / "p.yaml").scene
        assert scene.notes == ("calib.txt states the cameras of the pair; write `rig: calib.txt` to use it",)
        assert scene.views is not None and scene.views.calibration is None
        made = starter([folder / "left.png", folder / "right.png"], folder / "new.yaml")
        assert "\nscene: {left: left.png, right: right.png, rig: calib.txt}\n" in made.text
        assert made.scene.views is not None and made.scene.views.calibration is not None
        assert made.scene.notes == ()
        paths = {"left": folder / "left.png", "right": folder / "right.png"}
        write_opencv(folder / "rig.yml", rig((0, 0, 0), (-60.0, 0, 0)))
        for options, cure in (
            ({"rig": folder / "rig.yml"}, "rig_unit_m"),
            ({"calibration": Calibration(1000, 60)}, "mm"),
        ):
            scene = Scene.pair(**paths, **options)
            assert scene.views.calibration.baseline_m == 60 and cure in scene.notes[0]
        assert Scene.pair(**paths, calibration=Calibration(1000, 0.06)).notes == ()


@pytest.mark.parametrize("name", ["truth", "segments"])
def test_rig_with_incompatible_options_raises(name: str):
    with pytest.raises(ConfigError, match=f"leave out {name}"):
        Scene.pair(left=BLANK, right=BLANK, rig="rig.yml", **{name: np.ones(SHAPE, int)})
    with pytest.raises(ConfigError, match="rig needs left"):
        make_source({"photo": BLANK, "rig": "rig.yml"})
