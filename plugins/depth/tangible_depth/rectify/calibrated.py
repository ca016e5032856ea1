"""Rectification of a pair taken by known cameras: exact, and depth comes out in metres."""

from dataclasses import dataclass
from math import sqrt

import numpy as np
from jaxtyping import Float64

from tangible_core.data import Calibration, Record, Views
from tangible_core.errors import GeometryError

from .epipolar import product
from .homographies import inverse
from .rectification import check_homographies
from .rectified import RectifiedPair, warped


@dataclass(frozen=True, eq=False)
class StereoRig(Record):
    """Two cameras free of lens distortion: a point X_left in metres is X_right = rotation X_left + translation_m.

    left_matrix, right_matrix: K, (3, 3), pixels. Undistort the pictures first (`cv2.undistort`).
    Raises: GeometryError if a matrix is no camera's, the rotation is none, or the cameras stand in one place.
    """

    left_matrix: Float64[np.ndarray, "3 3"]
    right_matrix: Float64[np.ndarray, "3 3"]
    rotation: Float64[np.ndarray, "3 3"]
    translation_m: Float64[np.ndarray, "3"]

    def __post_init__(self) -> None:
        super().__post_init__()
        for side, matrix in (("left", self.left_matrix), ("right", self.right_matrix)):
            if matrix.shape != (3, 3) or not np.isfinite(matrix).all() or min(matrix[0, 0], matrix[1, 1]) <= 0:
                raise GeometryError(
                    f"the {side} camera matrix must be (3, 3) with positive focal lengths, not {matrix}"
                )
        turn = self.rotation
        if turn.shape != (3, 3) or not _is_rotation(turn):
            raise GeometryError(f"a rotation must be an orthogonal (3, 3) matrix of determinant 1, not {turn}")
        if self.translation_m.shape != (3,) or not 0 < _length(self.translation_m) < np.inf:
            raise GeometryError(
                f"the translation must be three finite numbers in metres, not all zero, not {self.translation_m}"
            )


def rectify_calibrated(views: Views, rig: StereoRig) -> RectifiedPair:
    """A pair of known cameras turned so that its rows correspond; its calibration gives Z = f B / d exactly.

    The new axes are the baseline, and the mean viewing direction made square to it. Depth is along the new axis.
    Raises: PictureError if there is only one view; RectificationError if the cameras look along their baseline.
    Source: Fusiello, Trucco & Verri, A compact algorithm for rectification of stereo pairs, 2000.
    """
    centre = -product(rig.rotation.T, rig.translation_m[:, None])[:, 0]
    axes = _axes(centre, looking=rig.rotation[2] + [0, 0, 1])
    focal = float((rig.left_matrix[1, 1] + rig.right_matrix[1, 1]) / 2)
    camera = np.array([[focal, 0, rig.left_matrix[0, 2]], [0, focal, rig.left_matrix[1, 2]], [0, 0, 1]])
    view = product(camera, axes)
    pair = (
        product(view, inverse(rig.left_matrix)),
        product(product(view, rig.rotation.T), inverse(rig.right_matrix)),
    )
    check_homographies(pair, views.shape, np.zeros(1))
    return warped(views, pair, "turned as its calibration says", calibration=Calibration(focal, _length(centre)))


def _axes(baseline: np.ndarray, looking: np.ndarray) -> Float64[np.ndarray, "3 3"]:
    """Rows: unit vectors along the baseline, square to it and the view, and the new viewing direction."""
    x = baseline / _length(baseline)
    y = np.cross(looking, x)
    y /= max(_length(y), np.finfo(np.float64).tiny)
    return np.stack([x, y, np.cross(x, y)])


def _is_rotation(turn: np.ndarray) -> bool:
    straight = np.allclose(product(turn, turn.T), np.eye(3), atol=1e-6)
    return bool(straight and np.sum(np.cross(turn[0], turn[1]) * turn[2]) > 0)


def _length(vector: np.ndarray) -> float:
    return sqrt(np.square(vector).sum())
