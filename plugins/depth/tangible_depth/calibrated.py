"""Rectification of a pair taken by known cameras: exact, and depth comes out in metres."""

from dataclasses import dataclass

import numpy as np
from jaxtyping import Float64

from tangible_core.data import Calibration, Record, Views
from tangible_core.errors import GeometryError

from .rectification import check_homographies
from .rectified import Rectified, warped


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
                raise GeometryError(f"the {side} camera matrix is K, (3, 3), with positive focal lengths, not {matrix}")
        turn = self.rotation
        if turn.shape != (3, 3) or not np.allclose(turn @ turn.T, np.eye(3), atol=1e-6) or np.linalg.det(turn) < 0:
            raise GeometryError(f"a rotation is orthogonal, (3, 3), of determinant 1, not {turn}")
        if self.translation_m.shape != (3,) or not 0 < np.linalg.norm(self.translation_m) < np.inf:
            raise GeometryError(f"the translation is three metres, not all zero, not {self.translation_m}")


def rectify_calibrated(views: Views, rig: StereoRig) -> Rectified:
    """A pair of known cameras turned so that its rows correspond; its calibration gives Z = f B / d exactly.

    The new axes are the baseline, and the mean viewing direction made square to it. Depth is along the new axis.
    Raises: PictureError if there is only one view; CannotRectify if the cameras look along their baseline.
    Source: Fusiello, Trucco & Verri, A compact algorithm for rectification of stereo pairs, 2000.
    """
    centre = -rig.rotation.T @ rig.translation_m
    axes = _axes(centre, looking=rig.rotation[2] + [0, 0, 1])
    focal = float((rig.left_matrix[1, 1] + rig.right_matrix[1, 1]) / 2)
    camera = np.array([[focal, 0, rig.left_matrix[0, 2]], [0, focal, rig.left_matrix[1, 2]], [0, 0, 1]])
    pair = (
        camera @ axes @ np.linalg.inv(rig.left_matrix),
        camera @ axes @ rig.rotation.T @ np.linalg.inv(rig.right_matrix),
    )
    check_homographies(pair, views.shape, np.zeros(1))
    return warped(
        views, pair, "turned as its calibration says", calibration=Calibration(focal, float(np.linalg.norm(centre)))
    )


def _axes(baseline: np.ndarray, looking: np.ndarray) -> Float64[np.ndarray, "3 3"]:
    """Rows: unit vectors along the baseline, square to it and the view, and the new viewing direction."""
    x = baseline / np.linalg.norm(baseline)
    y = np.cross(looking, x)
    y /= max(np.linalg.norm(y), np.finfo(np.float64).tiny)
    return np.stack([x, y, np.cross(x, y)])
