"""Calibrations of two cameras, in the formats of OpenCV and Kalibr."""

import re
from collections.abc import Mapping, Sequence
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
    "radtan": "radial-tangential",
    "plumb_bob": "radial-tangential",
    "equidistant": "equidistant",
    "equi": "equidistant",
    "none": "radial-tangential",
}
"""Kalibr's lens models."""


class RigFile(NamedTuple):
    """Two cameras, and the width and height of the pictures that they were calibrated with, if the file states them."""

    cameras: StereoRig
    size: tuple[int, int] | None


def read_rig(path: Path, unit_m: float = 1.0) -> RigFile:
    """Read the cameras of a file: M1, D1, M2, D2, R and T (or the like) by OpenCV, cam0 and cam1 by Kalibr.

    unit_m: metres in one unit of the translation, 0.001 if the chessboard was measured in millimetres.
    Raises: ConfigError if the file cannot be read or lacks a part, GeometryError for numbers that no camera has.
    """
    text = re.sub(r"\A%YAML[: ]1\.0\s*\n", "", read_text(path))  # OpenCV's head, which is not YAML
    tree = parse_source(text, path, "a calibration of two cameras is a mapping, as OpenCV or Kalibr write it").tree
    try:
        if "cam0" in tree and "cam1" in tree:
            return _of_kalibr(path, tree["cam0"], tree["cam1"], unit_m)
        return RigFile(_of_opencv(path, tree, unit_m), None)
    except GeometryError as error:
        raise GeometryError(f"{path}: {error}") from error


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
            "parts lie in two files, put both into one"
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
