"""Rectification of a pair from two calibrated cameras, so that its rows correspond and depth comes out in metres."""

from dataclasses import dataclass
from math import sqrt
from typing import Any, Literal, NamedTuple, final

import numpy as np
from jaxtyping import Bool, Float32, Float64

from ..data import Calibration, Record, Views
from ..data.arguments import named_fields
from ..data.records import as_read_only
from ..errors import GeometryError, PictureError, quoted
from ..runtime.opencv import cv2, plain_opencv

Distortion = Literal["radial-tangential", "equidistant"]
COEFFICIENTS: dict[Distortion, tuple[int, ...]] = {"radial-tangential": (0, 4, 5, 8, 12, 14), "equidistant": (0, 4)}
"""Numbers of distortion coefficients that each lens model may have."""
# Largest deviation from a rotation that is taken for rounding, as of a matrix that is printed with 4 decimals.
NEARLY = 1e-3
# Largest width and height of a rectified picture, as a multiple of the raw one.
GROWTH = 2.0


@named_fields
@dataclass(frozen=True, eq=False)
class Camera(Record):
    """A camera: K in pixels, and OpenCV's k1, k2, p1, p2[, k3 ...], or a fisheye's k1 to k4. Raises: GeometryError."""

    matrix: Float64[np.ndarray, "3 3"]
    distortion: Float64[np.ndarray, "n"]
    model: Distortion = "radial-tangential"

    def __post_init__(self) -> None:
        super().__post_init__()
        matrix = self.matrix
        if matrix.shape != (3, 3) or not np.isfinite(matrix).all() or min(matrix[0, 0], matrix[1, 1]) <= 0:
            raise GeometryError(f"a camera matrix is K, (3, 3), with positive focal lengths, not {quoted(matrix)}")
        counts = COEFFICIENTS[self.model]
        if self.distortion.ndim != 1 or self.distortion.size not in counts or not np.isfinite(self.distortion).all():
            raise GeometryError(
                f"a {self.model} lens has {' or '.join(map(str, counts))} finite coefficients, not "
                f"{quoted(self.distortion)}"
            )


@named_fields
@dataclass(frozen=True, eq=False)
class StereoRig(Record):
    """Two cameras: X_left in metres is X_right = rotation X_left + translation_m. Raises: GeometryError."""

    left: Camera
    right: Camera
    rotation: Float64[np.ndarray, "3 3"]
    translation_m: Float64[np.ndarray, "3"]

    def __post_init__(self) -> None:
        super().__post_init__()
        if self.rotation.shape == (3, 3) and not _is_rotation(self.rotation, 1e-6) and _is_rotation(self.rotation):
            # A rounded rotation becomes the nearest exact one.
            object.__setattr__(self, "rotation", as_read_only(_nearest_rotation(self.rotation)))
        if self.rotation.shape != (3, 3) or not _is_rotation(self.rotation):
            raise GeometryError(f"a rotation is orthogonal, (3, 3), of determinant 1, not {quoted(self.rotation)}")
        if self.translation_m.shape != (3,) or not 0 < _length(self.translation_m) < np.inf:
            raise GeometryError(f"a translation is three metres, not all zero, not {quoted(self.translation_m)}")
        x, y, z = self.centre_m
        if not max(x, y) > max(-x, -y, abs(z)):
            raise GeometryError(
                f"the right camera stands at ({x:.3g}, {y:.3g}, {z:.3g}) m of the left one (right, down, ahead), and "
                "neither to its right nor below it; exchange left and right, or check the translation"
            )

    @property
    def centre_m(self) -> tuple[float, float, float]:
        """The position of the right camera in the frame of the left one."""
        x, y, z = (-np.einsum("ji,j->i", self.rotation, self.translation_m)).tolist()
        return x, y, z


class RectifiedViews(NamedTuple):
    """A pair whose rows correspond; its columns, if one camera stands below the other."""

    views: Views  # the rectified pair, with the calibration that gives Z = f B / d
    known: Bool[np.ndarray, "h w"]  # mask of the pixels at which the rectified left picture shows the raw one


def rectify_views(views: Views, rig: StereoRig) -> RectifiedViews:
    """Rectify a raw pair: no distortion, rows along the baseline. Raises: PictureError, GeometryError."""
    return Rectifier(rig, views.shape).rectify(views)


@final
class Rectifier:
    """The maps of `rectify_views` for one rig and size, computed once for many pairs."""

    def __init__(self, rig: StereoRig, shape: tuple[int, int]) -> None:
        """shape: (h, w) of each picture. Raises: GeometryError as `rectify_views`."""
        # The new axes are the baseline, and the mean viewing direction made orthogonal to it (Fusiello, Trucco & Verri,
        # 2000).
        along = np.array(rig.centre_m) / _length(np.array(rig.centre_m))
        across = np.cross(rig.rotation[2] + [0, 0, 1], along)  # orthogonal to the baseline and the view
        across /= max(_length(across), np.finfo(np.float64).tiny)
        axes = np.stack([along, across, np.cross(along, across)])
        focal = float((rig.left.matrix[1, 1] + rig.right.matrix[1, 1]) / 2)
        camera = np.array([[focal, 0, rig.left.matrix[0, 2]], [0, focal, rig.left.matrix[1, 2]], [0, 0, 1.0]])
        size = _canvas(rig.left, axes, camera, shape)
        self._left = _places(rig.left, axes, camera, size)
        self._right = _places(rig.right, np.einsum("ij,kj->ik", axes, rig.rotation), camera, size)
        x, y, _ = rig.centre_m
        self._calibration = Calibration(focal, _length(np.array(rig.centre_m)), vertical=y > x)

    def rectify(self, views: Views) -> RectifiedViews:
        """Rectify a pair of this size. Raises: PictureError if there is only one view."""
        if views.right is None:
            raise PictureError("a stereo rig takes two views; give a right one")
        left, right = _warp(views.left, *self._left), _warp(views.right, *self._right)
        columns, rows = self._left
        height, width = views.shape
        inside = (columns > -0.5) & (columns < width - 0.5) & (rows > -0.5) & (rows < height - 0.5)
        if self._calibration.vertical:  # the canvas lies on its left side
            left, right, inside = (np.ascontiguousarray(np.rot90(canvas, -1)) for canvas in (left, right, inside))
        return RectifiedViews(Views(left, right, self._calibration), inside)


def _canvas(lens: Camera, axes: np.ndarray, camera: np.ndarray, shape: tuple[int, int]) -> tuple[int, int]:
    """Return the width and height that hold the rectified left picture; move the centre in `camera` accordingly."""
    rows, columns = shape
    across, down = np.linspace(0, columns - 1, 33), np.linspace(0, rows - 1, 33)
    border = [np.column_stack([across, np.full(33, y)]) for y in (0, rows - 1)]
    border += [np.column_stack([np.full(33, x), down]) for x in (0, columns - 1)]
    corners_px = undistort_points(np.vstack(border), lens, axes, camera)
    if not np.isfinite(corners_px).all():
        raise GeometryError("the cameras look along their baseline or apart; such a pair cannot be rectified")
    corners_px = np.round(corners_px, 6)  # so that a last bit does not add a row
    low, high = np.floor(corners_px.min(axis=0)), np.ceil(corners_px.max(axis=0))
    lying = abs(axes[0, 1]) > abs(axes[0, 0])
    middle, most = (low + high) / 2, GROWTH * np.array([rows, columns] if lying else [columns, rows])
    low, high = np.maximum(low, np.floor(middle - most / 2)), np.minimum(high, np.ceil(middle + most / 2))
    camera[:2, 2] -= low
    width, height = (int(side) + 1 for side in high - low)
    return width, height


def undistort_points(
    points_px: Float64[np.ndarray, "n 2"], lens: Camera, axes: np.ndarray, camera: np.ndarray
) -> Float64[np.ndarray, "n 2"]:
    """Return points of a raw picture as the camera without distortion, with these axes, sees them; NaN behind it."""
    undo: Any = cv2.fisheye.undistortPoints if lens.model == "equidistant" else cv2.undistortPoints
    flat = undo(points_px[:, None], lens.matrix, _coefficients(lens))[:, 0]
    rays = np.einsum("nj,ij->ni", np.column_stack([flat, np.ones(len(flat))]), axes)
    with np.errstate(divide="ignore", invalid="ignore"):
        ahead = np.where(rays[:, 2:] > 1e-6, rays[:, :2] / rays[:, 2:], np.nan)
    return ahead * camera[[0, 1], [0, 1]] + camera[:2, 2]


def _places(
    lens: Camera, axes: np.ndarray, camera: np.ndarray, size: tuple[int, int]
) -> tuple[Float32[np.ndarray, "h w"], Float32[np.ndarray, "h w"]]:
    find: Any = cv2.fisheye.initUndistortRectifyMap if lens.model == "equidistant" else cv2.initUndistortRectifyMap
    with plain_opencv():
        return find(lens.matrix, _coefficients(lens), axes, camera, size, cv2.CV_32FC1)


def _warp(picture: np.ndarray, columns: np.ndarray, rows: np.ndarray) -> np.ndarray:
    if picture.dtype.name not in ("uint8", "uint16", "float32", "float64"):
        picture = picture.astype(np.float32)
    with plain_opencv():
        raw = np.ascontiguousarray(picture)
        result = cv2.remap(raw, columns, rows, cv2.INTER_CUBIC, borderMode=cv2.BORDER_REPLICATE)
    return np.clip(result, picture.min(), picture.max(), out=result)


def _coefficients(lens: Camera) -> np.ndarray:
    return lens.distortion if lens.distortion.size else np.zeros(4)


def _is_rotation(matrix: np.ndarray, tolerance: float = NEARLY) -> bool:
    straight = np.allclose(np.einsum("ik,jk->ij", matrix, matrix), np.eye(3), rtol=0, atol=tolerance)
    return bool(straight and np.sum(np.cross(matrix[0], matrix[1]) * matrix[2]) > 0)


def _nearest_rotation(matrix: np.ndarray) -> Float64[np.ndarray, "3 3"]:
    """Return the rotation nearest to one that is nearly so. Source: Higham, SIAM J. Sci. Stat. Comput. 7(4), 1986."""
    for _ in range(4):
        cofactors = np.stack([np.cross(matrix[row - 2], matrix[row - 1]) for row in range(3)])
        matrix = (matrix + cofactors / np.sum(cofactors[0] * matrix[0])) / 2
    return matrix


def _length(vector: np.ndarray) -> float:
    return sqrt(np.square(vector).sum())
