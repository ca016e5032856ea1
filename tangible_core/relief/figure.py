"""The relief of things: what stands out from its ground is raised and rounded, faces have their shape.

Networks see the figure, the borders and the faces (`tangible_core.data.Figure`); what they do not see stays ground.
"""
# scipy has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

import numpy as np
from jaxtyping import Bool, Float32

from ..data import Figure, Relief, Views
from ..data.figure import IS_FIGURE
from ..data.pictures import to_grey
from ..runtime.opencv import plain_opencv
from ..scene import geometry, scaling
from ..scene.workspace import FeltSize
from .choice import ReliefChoice
from .slope_limit import limit_slopes

CELL_M = 2e-4
"""Side of the cells on which heights are made, m: finer than a fingertip resolves."""
GROUND, STEP, BODY, FACE = 0.1, 0.18, 0.4, 0.5
"""Shares of the height: of a ground that rises towards the viewer, of the step from the ground to the figure, of the
figure's rounding, and the largest of a face's own shape."""
ROUNDING_M = 0.01
"""Distance from its rim at which a figure is level, m: a thinner limb stays lower, a broad thing stays flat."""
SOFT_M = 0.0004
"""Standard deviation by which the rim of a figure is softened, m."""
GROOVE_M, GROOVE_SIGMA_M = 0.0006, 0.00025
"""Depth of the groove at a sure border, and the standard deviation of its profile, m."""
FACE_SCALE = 0.8
"""Largest ratio of a face's depth to its true depth."""
RIM_M = 0.0015
"""Width of the rim along which a face passes into the head, m."""
FEATURES = 0.01
"""Height of the features of a face that are seen by their brightness, such as eyes and lips, for one standard deviation
of the brightness, over the face's width."""
FINE, COARSE = 0.012, 0.12
"""Standard deviations of the Gaussians whose difference has these features, over the face's width."""
MIN_FACE_CELLS = 30
"""Fewest cells of a face that has a shape."""


def figure_relief(views: Views, seen: Figure, size: FeltSize, choice: ReliefChoice) -> Relief:
    """Make the relief of what networks see in the left view, pixels square.

    The figure stands on a step and is rounded towards its rim, as bodies are; the ground rises towards the lower rim,
    where things are nearer; borders are grooves; a face has the true shape of its points, as far as the height allows,
    and passes into the head along its rim. Slopes are limited as everywhere.
    """
    import cv2

    rows, columns = views.shape
    small = scaling.reduce_views(Views(views.left), scaling.felt_factor(columns, size.width_m, CELL_M)).left
    shape: tuple[int, int] = small.shape[:2]
    pitch_m = size.width_m / shape[1]
    with plain_opencv():
        figure = np.zeros(shape, bool) if seen.figure is None else scaling.reduced_map(seen.figure, shape) >= IS_FIGURE
        height_m = size.relief_m * _blur(_shares(figure, pitch_m), SOFT_M / pitch_m)
        if seen.borders is not None:
            height_m -= GROOVE_M * _blur(scaling.reduced_map(seen.borders, shape), GROOVE_SIGMA_M / pitch_m)
        light = to_grey(small)
        for face in seen.faces:
            _add_face(
                height_m,
                (face + np.array([0.5, 0.5, 0], np.float32)) * np.float32(shape[1] / columns),
                light,
                pitch_m,
                size,
            )
        height_m = np.ascontiguousarray(height_m - height_m.min(), np.float32)
        limited = limit_slopes(height_m, pitch_m, choice.slope)
        shown = np.asarray(cv2.resize(limited, (columns, rows), interpolation=cv2.INTER_LINEAR))
    return geometry.smooth(Relief(shown, geometry.extent_of(views.shape, size.width_m)), size.smooth_m)


def _shares(figure: Bool[np.ndarray, "r c"], pitch_m: float) -> Float32[np.ndarray, "r c"]:
    """Return the heights of ground and figure, in shares of the whole."""
    from scipy.ndimage import distance_transform_edt

    lower = np.linspace(0, GROUND, figure.shape[0], dtype=np.float32)[:, None]
    if not figure.any():
        return np.broadcast_to(lower, figure.shape).astype(np.float32)
    from_rim = np.minimum(np.asarray(distance_transform_edt(figure)) * (pitch_m / ROUNDING_M), 1)
    rounding = _blur(np.sqrt(1 - (1 - from_rim) ** 2).astype(np.float32), 0.1 * ROUNDING_M / pitch_m)
    return np.where(figure, STEP + BODY * rounding, lower).astype(np.float32)


def _add_face(
    height_m: Float32[np.ndarray, "r c"],
    face: Float32[np.ndarray, "468 3"],
    light: Float32[np.ndarray, "r c"],
    pitch_m: float,
    size: FeltSize,
) -> None:
    """Give a face its shape, in place. face: its points in cells, from the corner of the first cell."""
    from scipy.interpolate import LinearNDInterpolator
    from scipy.ndimage import distance_transform_edt

    low = np.maximum(np.floor(face[:, :2].min(axis=0)).astype(int) - 1, 0)
    high = np.minimum(np.ceil(face[:, :2].max(axis=0)).astype(int) + 1, height_m.shape[::-1])
    if (high <= low).any():
        return
    box = np.s_[low[1] : high[1], low[0] : high[0]]
    row, column = np.mgrid[box] + 0.5
    depth_m = face[:, 2].astype(np.float64) * pitch_m
    scale = min(FACE_SCALE, FACE * size.relief_m / max(float(np.ptp(depth_m)), 1e-9))
    own_m = np.asarray(LinearNDInterpolator(face[:, :2].astype(np.float64), scale * depth_m)(column, row))
    inside = np.isfinite(own_m)
    from_rim_m = np.asarray(distance_transform_edt(np.pad(inside, 1)))[1:-1, 1:-1] * pitch_m
    rim = inside & (from_rim_m < RIM_M)
    if int(inside.sum()) < MIN_FACE_CELLS or not rim.any():
        return
    width = float(np.ptp(face[:, 0]))
    features = (_blur(light, FINE * width) - _blur(light, COARSE * width))[box]
    spread = max(float(features[inside].std()), 1e-6)
    own_m = np.where(inside, own_m, 0) + FEATURES * width * pitch_m * np.clip(features / spread, -2, 2)
    own_m += float(np.median(height_m[box][rim] - own_m[rim]))
    share = np.clip(from_rim_m / RIM_M, 0, 1)
    share = share * share * (3 - 2 * share)
    height_m[box] = height_m[box] * (1 - share) + own_m * share


def _blur(values: Float32[np.ndarray, "r c"], sigma: float) -> Float32[np.ndarray, "r c"]:
    """Return a map blurred by a Gaussian; sigma: in cells."""
    import cv2

    return np.asarray(cv2.GaussianBlur(values, (0, 0), max(sigma, 0.1), borderType=cv2.BORDER_REPLICATE))
