"""The relief of things: what stands out from its ground is raised and rounded, faces have their shape."""
# scipy has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false, reportUnknownArgumentType=false

import numpy as np
from jaxtyping import Bool, Float32

from ..data import DisparityMap, Figure, Relief, Views
from ..data.figure import IS_FIGURE
from ..data.pictures import to_grey
from ..runtime.opencv import cv2, plain_opencv
from ..scene import geometry, scaling
from ..scene.workspace import FeltSize
from .choice import ReliefChoice
from .slope_limit import limit_slopes

# Side of the cells on which heights are made, m: finer than a fingertip resolves.
CELL_M = 2e-4
# Shares of the height: ground, step to the figure, its rounding, a face; networks know most faces again with them.
GROUND, STEP, BODY, FACE = 0.1, 0.2, 0.25, 0.2
# Distance from its rim at which a figure is level, m: a thinner limb stays lower, a broad thing stays flat.
ROUNDING_M = 0.014
# Share of the rectangle around a figure from which it is a level board, such as a page; no other fills over 0.89.
BOARD = 0.95
SOFT_M = 0.0004
# Distance from an outline within which depth is that of the places behind it: networks for depth have spikes there.
HALO_M = 0.001
# Smallest range of nearness, of the picture's, that is stretched to a full share: what is flatter stays flatter.
SHALLOW = 0.1
GROOVE_M, GROOVE_SIGMA_M = 0.0004, 0.00025
"""Depth of the groove at a sure border, and the standard deviation of its profile, m."""
FACE_SCALE = 0.8  # largest ratio of a face's depth to its true depth
RIM_M = 0.003
FEATURES = 0.01
"""Height of a face's features by brightness, for one standard deviation of it, over the face's width."""
FINE, COARSE = 0.006, 0.07
"""Standard deviations of the Gaussians whose difference has these features, over the face's width."""
MIN_FACE_CELLS = 30


def figure_relief(
    views: Views, sight: Figure, size: FeltSize, choice: ReliefChoice, disparity: DisparityMap | None = None
) -> Relief:
    """Make the relief of what networks see in the left view, pixels square. Raises: GeometryError without depth."""
    rows, columns = views.shape
    small = scaling.reduce_views(Views(views.left), scaling.felt_factor(columns, size.width_m, CELL_M)).left
    shape: tuple[int, int] = small.shape[:2]
    pitch_m = size.width_m / shape[1]
    with plain_opencv():
        figure = (
            np.zeros(shape, bool) if sight.figure is None else scaling.reduced_map(sight.figure, shape) >= IS_FIGURE
        )
        nearness = None
        if disparity is not None:
            spans = geometry.nearness_range(disparity, None)
            nearness = scaling.reduced_map(geometry.unit_nearness(disparity, None, spans), shape)
        # The figure stands on a step and is rounded towards its rim, as bodies are; the ground rises towards the lower
        # rim, where things are nearer; borders are grooves; a face passes into the head along its rim.
        height_m = size.relief_m * _blur(_shares(figure, nearness, pitch_m), SOFT_M / pitch_m)
        if sight.borders is not None:
            height_m -= GROOVE_M * _blur(scaling.reduced_map(sight.borders, shape), GROOVE_SIGMA_M / pitch_m)
        light = to_grey(small)
        for face in sight.faces:
            _add_face(
                height_m,
                (face + np.array([0.5, 0.5, 0], np.float32)) * np.float32(shape[1] / columns),
                light,
                pitch_m,
                size,
            )
        height_m = np.ascontiguousarray(height_m - height_m.min(), np.float32)
        gentle_m = limit_slopes(height_m, pitch_m, choice.slope)
        enlarged_m = np.asarray(cv2.resize(gentle_m, (columns, rows), interpolation=cv2.INTER_LINEAR))
    return geometry.smooth(Relief(enlarged_m, geometry.surface_extent(views.shape, size.width_m)), size.smooth_m)


def _shares(
    figure: Bool[np.ndarray, "r c"], nearness: Float32[np.ndarray, "r c"] | None, pitch_m: float
) -> Float32[np.ndarray, "r c"]:
    if nearness is None:
        body, ground = _rounding(figure, pitch_m), np.linspace(0, 1, len(figure), dtype=np.float32)[:, None]
    else:
        body, ground = (_without_halo(nearness, part, pitch_m) for part in (figure, ~figure))
        shallow = SHALLOW * float(np.ptp(np.percentile(np.where(figure, body, ground), geometry.RANGE_PERCENT)))
        body, ground = _stretch(body, figure, shallow), _stretch(ground, ~figure, shallow)
    return np.where(figure, STEP + BODY * body, GROUND * ground).astype(np.float32)


def _rounding(figure: Bool[np.ndarray, "r c"], pitch_m: float) -> Float32[np.ndarray, "r c"]:
    """Return a figure's height, 0 at its rim to 1: a parabola, whose slope is bounded; 1 all over a board."""
    from scipy.ndimage import distance_transform_edt

    from_rim = np.minimum(np.asarray(distance_transform_edt(figure)) * (pitch_m / ROUNDING_M), 1)
    rounding = _blur((1 - (1 - from_rim) ** 2).astype(np.float32), 0.1 * ROUNDING_M / pitch_m)
    outlines, _ = cv2.findContours(figure.astype(np.uint8), cv2.RETR_EXTERNAL, cv2.CHAIN_APPROX_NONE)
    sides = [cv2.minAreaRect(outline)[1] for outline in outlines]
    boards = [
        outline
        for outline, side in zip(outlines, sides, strict=True)
        if min(side) * pitch_m >= ROUNDING_M and cv2.contourArea(outline) >= BOARD * side[0] * side[1]
    ]
    return np.asarray(cv2.drawContours(rounding, boards, -1, 1.0, cv2.FILLED))


def _without_halo(
    nearness: Float32[np.ndarray, "r c"], part: Bool[np.ndarray, "r c"], pitch_m: float
) -> Float32[np.ndarray, "r c"]:
    """Return the nearness with that at a part's outline replaced by that of the nearest place farther inside."""
    from scipy.ndimage import distance_transform_edt

    inner = np.asarray(distance_transform_edt(part)) * pitch_m > HALO_M
    if not inner.any():
        return nearness
    return nearness[tuple(np.asarray(distance_transform_edt(~inner, return_distances=False, return_indices=True)))]


def _stretch(
    nearness: Float32[np.ndarray, "r c"], part: Bool[np.ndarray, "r c"], shallow: float
) -> Float32[np.ndarray, "r c"]:
    """Return the nearness over its own range in a part of the picture, 0 to 1; `shallow`: the least such range."""
    if not part.any():
        return nearness
    low, high = np.percentile(nearness[part], geometry.RANGE_PERCENT)
    return np.clip((nearness - low) / max(float(high - low), shallow, 1e-6), 0, 1).astype(np.float32)


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
    return np.asarray(cv2.GaussianBlur(values, (0, 0), max(sigma, 0.1), borderType=cv2.BORDER_REPLICATE))
