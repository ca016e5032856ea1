"""Calibrations of two cameras, in the formats of OpenCV, Kalibr, ROS, Middlebury and KITTI."""

import re
from collections.abc import Mapping, Sequence
from contextlib import suppress
from math import isfinite
from pathlib import Path
from typing import Any, NamedTuple, cast

import numpy as np
from jaxtyping import Float64

from ...errors import ConfigError, GeometryError, quoted
from ...files.yaml.source import parse_source, plain, read_text
from ..rig import Camera, Distortion, StereoRig

OPENCV: Mapping[str, tuple[str, ...]] = {
    "left matrix": ("M1", "K1", "cameraMatrix1", "camera_matrix_1", "left_camera_matrix"),
    "left distortion": ("D1", "distCoeffs1", "dist_coeffs_1", "left_distortion_coefficients"),
    "right matrix": ("M2", "K2", "cameraMatrix2", "camera_matrix_2", "right_camera_matrix"),
    "right distortion": ("D2", "distCoeffs2", "dist_coeffs_2", "right_distortion_coefficients"),
    "rotation": ("R", "rotation"),
    "translation": ("T", "translation"),
}
"""Keys of each part in files of OpenCV's stereoCalibrate."""
LENSES: Mapping[str, Distortion] = {
    **dict[str, Distortion].fromkeys(("radtan", "plumb_bob", "rational_polynomial", "none"), "radial-tangential"),
    **dict[str, Distortion].fromkeys(("equidistant", "equi", "fisheye"), "equidistant"),
}
"""Lens models of Kalibr and ROS."""
# Words in the names of two files that belong together: the first is named, the other one lies next to it.
PARTNERS = {"left": "right", "intrinsics": "extrinsics", "intrinsic": "extrinsic"}
NAMES = (
    *("rig.yaml", "rig.yml", "calib.txt", "calib_cam_to_cam.txt", "camchain.yaml", "stereo.yaml", "stereo.yml"),
    *("stereo.xml", "calibration.yaml", "calibration.yml", "calibration.xml", "intrinsics.yml", "left.yaml"),
)
"""Names under which the calibration of a pair lies next to its pictures."""
MM = 0.001


class RigFile(NamedTuple):
    """Two cameras, and the width and height of the pictures that they were calibrated with, if the file states them."""

    cameras: StereoRig
    size: tuple[int, int] | None


def find_rig(left: Path, right: Path, shape: tuple[int, int]) -> Path | None:
    """Find a calibration for pictures of (h, w) next to them, or above the two folders of these."""
    folders = dict.fromkeys((left.parent, *((left.parent.parent,) if left.parent != right.parent else ())))
    for path in (folder / name for folder in folders for name in NAMES):
        with suppress(ConfigError, GeometryError):
            if path.is_file() and read_rig(path).size in (None, shape[::-1]):
                return path
    return None


def read_rig(path: Path, unit_m: float | None = None) -> RigFile:
    """Read the cameras of a file: of OpenCV (M1, D1, M2, D2, R and T or the like; YAML, JSON or XML), Kalibr (cam0 and
    cam1), ROS (left.yaml, next to right.yaml), Middlebury (calib.txt) or KITTI (P0 to P3).

    unit_m: metres in one unit of the translation, 0.001 if the chessboard was measured in millimetres; None for 1, and
    for Middlebury's millimetres.
    Raises: ConfigError if the file cannot be read or lacks a part, GeometryError for numbers that no camera has.
    """
    text = read_text(path).removeprefix("\ufeff")
    try:
        lines = dict(re.findall(r"^(\w+)[ \t]*[=:][ \t]*(.*)$", text, re.MULTILINE))
        if lines.get("cam0", "").startswith("["):
            return _of_middlebury(path, lines, unit_m or MM)
        if names := _kitti_names(lines):
            return _of_kitti(path, lines, names, unit_m or 1.0)
        tree, other = _tree(path, text), _partner(path)
        if other is not None and not ("cam0" in tree or "T" in tree):
            second = _tree(other, read_text(other))
            if "camera_matrix" in tree or "K" in tree or "k" in tree:
                return _of_ros(path, tree, second, unit_m or 1.0)
            tree = {**second, **tree}
        if "cam0" in tree and "cam1" in tree:
            return _of_kalibr(path, tree["cam0"], tree["cam1"], unit_m or 1.0)
        return RigFile(_of_opencv(path, tree, unit_m or 1.0), None)
    except GeometryError as error:
        raise GeometryError(f"{path}: {error}") from error


def _tree(path: Path, text: str) -> Mapping[str, Any]:
    if text.lstrip().startswith("<"):
        return _of_xml(path, text)
    text = re.sub(r"\A%YAML[: ]1\.0\s*\n", "", text)  # OpenCV's head, which is not YAML
    return parse_source(text, path, "a calibration of two cameras is a mapping, as OpenCV or Kalibr write it").tree


def _of_xml(path: Path, text: str) -> Mapping[str, Any]:
    """Return OpenCV's matrices as their YAML has them."""
    from xml.etree import ElementTree

    try:
        if "<!" in text.replace("<!--", ""):  # a document type, whose entities could be of any size
            raise ElementTree.ParseError("it declares a document type")
        root = ElementTree.fromstring(text)
        return {
            block.tag: {
                **{side: int(block.findtext(side, "")) for side in ("rows", "cols")},
                "data": [float(number) for number in block.findtext("data", "").split()],
            }
            for block in root
            if block.find("rows") is not None
        }
    except (ElementTree.ParseError, ValueError) as error:
        raise ConfigError(f"{path}: is not XML as OpenCV writes it: {error}") from error


def _partner(path: Path) -> Path | None:
    """Return the file that belongs to one of a left camera, or of intrinsics; None if there is none."""
    for word, other in PARTNERS.items():
        partner = path.with_name(path.name.replace(word, other))
        if word in path.name and partner.is_file():
            return partner
    return None


def _kitti_names(values: Mapping[str, str]) -> tuple[str, str] | None:
    """Return the names of the matrices of the left and the right camera in a file of KITTI: in colour, then in grey."""
    names = (("P_rect_02", "P_rect_03"), ("P2", "P3"), ("P_rect_00", "P_rect_01"), ("P0", "P1"))
    return next((pair for pair in names if all(len(values.get(name, "").split()) == 12 for name in pair)), None)


def _of_middlebury(path: Path, values: Mapping[str, str], unit_m: float) -> RigFile:
    """Source: Scharstein et al., High-resolution stereo datasets with subpixel-accurate ground truth, GCPR 2014."""
    left, right = (
        Camera(_plain_numbers(path, name, values.get(name, ""), 9).reshape(3, 3), np.zeros(0))
        for name in ("cam0", "cam1")
    )
    baseline, width, height = (
        float(_plain_numbers(path, name, values.get(name, ""), 1)[0]) for name in ("baseline", "width", "height")
    )
    return RigFile(StereoRig(left, right, np.eye(3), np.array([-unit_m * baseline, 0, 0])), (int(width), int(height)))


def _of_kitti(path: Path, values: Mapping[str, str], names: tuple[str, str], unit_m: float) -> RigFile:
    """Source: Geiger et al., Vision meets robotics: the KITTI dataset, IJRR 2013: P = K (R, t), rectified."""
    left, right = (_plain_numbers(path, name, values[name], 12).reshape(3, 4) for name in names)
    between = unit_m * (_translation(right) - _translation(left))
    cameras = Camera(left[:, :3].copy(), np.zeros(0)), Camera(right[:, :3].copy(), np.zeros(0))
    size = names[0].replace("P_rect", "S_rect")
    sides = _plain_numbers(path, size, values[size], 2).tolist() if size in values and size != names[0] else None
    return RigFile(StereoRig(*cameras, np.eye(3), between), sides and (int(sides[0]), int(sides[1])))


def _translation(projection: Float64[np.ndarray, "3 4"]) -> Float64[np.ndarray, "3"]:
    """Return t of a projection K (R, t) of an upright camera. Raises: GeometryError without a focal length."""
    (fx, _, cx, x), (_, fy, cy, y), (_, _, _, z) = projection.tolist()
    if not min(fx, fy) > 0:
        raise GeometryError(f"a projection has positive focal lengths, not {fx:g} and {fy:g} px")
    return np.array([(x - cx * z) / fx, (y - cy * z) / fy, z])


def _plain_numbers(path: Path, part: str, text: str, count: int) -> Float64[np.ndarray, "n"]:
    try:
        numbers = np.array([float(number) for number in re.sub(r"[\[\];]", " ", text).split()])
    except ValueError:
        numbers = np.empty(0)
    if numbers.size != count or not np.isfinite(numbers).all():
        raise ConfigError(f"{path}: {part} must be {count} finite numbers, not {quoted(text)}")
    return numbers


def _of_ros(path: Path, left: Mapping[str, Any], right: Mapping[str, Any], unit_m: float) -> RigFile:
    """Return two cameras of ROS's CameraInfo: each is turned by R, and then the right one stands at P of the left."""
    sides = [_ros_camera(path, side, tree) for side, tree in (("left", left), ("right", right))]
    (first, turn, _), (second, other_turn, projection) = sides
    rotation = np.einsum("ji,jk->ik", other_turn, turn)
    translation = np.einsum("ji,j->i", other_turn, unit_m * _translation(projection))
    size = plain(left.get("image_width", left.get("width"))), plain(left.get("image_height", left.get("height")))
    whole = type(size[0]) is int and type(size[1]) is int and min(size) > 0
    return RigFile(StereoRig(first, second, rotation, translation), size if whole else None)


def _ros_camera(path: Path, side: str, tree: Mapping[str, Any]) -> tuple[Camera, np.ndarray, np.ndarray]:
    """Return the camera of one side, its rotation to the rectified pair, and its projection there."""
    names = {
        f"{side} camera matrix": ("camera_matrix", "K", "k"),
        f"{side} distortion": ("distortion_coefficients", "D", "d"),
        f"{side} rectification": ("rectification_matrix", "R", "r"),
        f"{side} projection": ("projection_matrix", "P", "p"),
    }
    blocks = [(part, next((tree[name] for name in keys if name in tree), None)) for part, keys in names.items()]
    matrix, coefficients, turn, projection = (
        _numbers(
            path, part, cast("Mapping[str, Any]", block).get("data") if isinstance(block, Mapping) else block
        ).ravel()
        for part, block in blocks
    )
    if (matrix.size, turn.size, projection.size) != (9, 9, 12):
        raise ConfigError(f"{path}: the {side} camera lacks one of {', '.join(names)}")
    lens = LENSES.get(str(tree.get("distortion_model", "plumb_bob")), "radial-tangential")
    return Camera(matrix.reshape(3, 3), coefficients, lens), turn.reshape(3, 3), projection.reshape(3, 4)


def _of_opencv(path: Path, tree: Mapping[Any, Any], unit_m: float) -> StereoRig:
    parts = {part: _matrix(path, tree, part, names) for part, names in OPENCV.items()}
    model: Distortion = "equidistant" if str(tree.get("fisheye", "")).lower() in ("1", "true") else "radial-tangential"
    left, right = (
        Camera(parts[f"{side} matrix"], parts[f"{side} distortion"].ravel(), model) for side in ("left", "right")
    )
    return StereoRig(left, right, parts["rotation"], unit_m * parts["translation"].ravel())


def _matrix(path: Path, tree: Mapping[Any, Any], part: str, names: Sequence[str]) -> Float64[np.ndarray, "..."]:
    """Return a matrix that OpenCV wrote as rows, cols and data."""
    block = next((tree[name] for name in names if name in tree), None)
    if not isinstance(block, Mapping) or not {"rows", "cols", "data"} <= cast("Mapping[str, Any]", block).keys():
        raise ConfigError(
            f"{path}: has no {part} ({', '.join(names)}), an OpenCV matrix with rows, cols and data; where the "
            "parts lie in two files, name these intrinsics.yml and extrinsics.yml, or put both into one"
        )
    rows, columns, numbers = plain(block["rows"]), plain(block["cols"]), _numbers(path, part, block["data"])
    if {type(rows), type(columns)} != {int} or min(rows, columns) < 0 or rows * columns != numbers.size:
        raise ConfigError(
            f"{path}: {part}: {quoted(rows)} rows and {quoted(columns)} cols are not {numbers.size} numbers"
        )
    return numbers.reshape(rows, columns)


def _of_kalibr(path: Path, left: Any, right: Any, unit_m: float) -> RigFile:
    cameras = _camera(path, "cam0", left), _camera(path, "cam1", right)
    pose = _numbers(path, "cam1.T_cn_cnm1", right.get("T_cn_cnm1"))
    if pose.shape != (4, 4):
        raise ConfigError(f"{path}: cam1.T_cn_cnm1 is the 4 x 4 pose of cam1 to cam0, not {quoted(pose.tolist())}")
    size = [int(side) for side in _numbers(path, "cam0.resolution", left.get("resolution")).ravel()]
    if size and (len(size) != 2 or min(size) < 1):
        raise ConfigError(f"{path}: cam0.resolution is [width, height] in pixels, not {quoted(size)}")
    rig = StereoRig(*cameras, pose[:3, :3].copy(), unit_m * pose[:3, 3])
    return RigFile(rig, (size[0], size[1]) if size else None)


def _camera(path: Path, name: str, block: Any) -> Camera:
    keys = cast("Mapping[str, Any]", block if isinstance(block, Mapping) else {"camera_model": block})
    if keys.get("camera_model", "pinhole") != "pinhole":
        raise ConfigError(f"{path}: {name} is a camera with camera_model pinhole, not {quoted(block)}")
    lens = str(keys.get("distortion_model", "none"))
    if lens not in LENSES:
        raise ConfigError(f"{path}: {name}.distortion_model: {quoted(lens)} is not one of {', '.join(LENSES)}")
    intrinsics = _numbers(path, f"{name}.intrinsics", keys.get("intrinsics"))
    if intrinsics.shape != (4,):
        raise ConfigError(f"{path}: {name}.intrinsics is [fu, fv, pu, pv], not {quoted(intrinsics.tolist())}")
    fu, fv, pu, pv = intrinsics.tolist()
    coefficients = _numbers(path, f"{name}.distortion_coeffs", keys.get("distortion_coeffs", []))
    return Camera(np.array([[fu, 0, pu], [0, fv, pv], [0, 0, 1.0]]), coefficients, LENSES[lens])


def _numbers(path: Path, part: str, values: Any) -> Float64[np.ndarray, "..."]:
    values = [] if values is None else plain(values)
    try:
        if isinstance(values, list) and _are_finite(values):
            return np.array(values, np.float64)
    except ValueError:  # rows of different lengths
        pass
    raise ConfigError(f"{path}: {part} must be a list of finite numbers, not {quoted(values)}")


def _are_finite(values: Any) -> bool:
    if isinstance(values, list):
        return all(map(_are_finite, cast("list[Any]", values)))
    return type(values) in (int, float) and isfinite(values)
