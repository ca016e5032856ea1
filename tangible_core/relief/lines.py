"""The relief of a drawing: its lines as ridges of one height, its areas as even steps below them, its paper flat."""
# scipy has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false

from typing import Any

import numpy as np
from jaxtyping import Bool, Float32, Int32

from ..data import Relief, Views
from ..drawing import Areas, find_areas, find_marks
from ..runtime.opencv import cv2, plain_opencv
from ..scene import geometry, scaling
from ..scene.workspace import FeltSize
from .choice import ReliefChoice
from .slope_limit import limit_slopes

CELL_M = 1e-4
# The least width of the top of a line, m, as in tactile graphics; a wider stroke keeps its width.
LINE_M = 0.001
AREAS = 0.6  # the share of the height that the highest area has; lines have all of it


def line_relief(views: Views, size: FeltSize, choice: ReliefChoice, *, areas: bool) -> tuple[Relief, int]:
    """Make the relief of the left view's lines, and areas if requested; return the number of texts left out too."""
    factor = scaling.felt_factor(views.shape[1], size.width_m, CELL_M)
    picture = scaling.reduce_views(Views(views.left), factor).left
    pitch_m = size.width_m / picture.shape[1]
    marks = find_marks(picture)
    lines = marks.lines
    base_m = np.zeros(picture.shape[:2], np.float32)
    if areas:
        colour_areas = find_areas(picture)
        levels = _levels(colour_areas)
        top_m = AREAS * size.relief_m if lines.mask.any() else size.relief_m
        base_m = limit_slopes(top_m * levels[colour_areas.labels] / max(1, levels.max()), pitch_m, choice.slope)
    line_pitch_m = size.width_m / lines.mask.shape[1]
    # Dashes are ridges as well. Gaps that their least width leaves are felt, if only as a rough line.
    # Slopes fall from the line's edge, so that all lines are of one height, however close; nothing is sunk.
    ridges_m = _ridges(lines.width_px > 0, lines.width_px * line_pitch_m, line_pitch_m, size.relief_m, choice.slope)
    height_m = np.maximum(_enlarge(ridges_m, views.shape), _enlarge(base_m, views.shape))
    relief = Relief(np.maximum(height_m, np.float32(0)), geometry.surface_extent(views.shape, size.width_m))
    return geometry.smooth(relief, size.smooth_m), len(marks.texts.boxes)


def _ridges(
    centre: Bool[np.ndarray, "r c"], width_m: Float32[np.ndarray, "r c"], pitch_m: float, top_m: float, slope: float
) -> Float32[np.ndarray, "r c"]:
    """Return ridges about centre lines: level over the width of the stroke, then falling by this slope."""
    from scipy.ndimage import distance_transform_edt

    if not centre.any():
        return np.zeros(centre.shape, np.float32)
    distances: Any = distance_transform_edt(~centre, return_indices=True)
    distance, rows, columns = np.asarray(distances[0], np.float32), *np.asarray(distances[1], np.int64)
    beyond_m = np.maximum(distance * pitch_m - np.maximum(width_m, LINE_M)[rows, columns] / 2, 0)
    return (top_m - slope * beyond_m if slope else np.where(beyond_m > 0, 0, top_m)).astype(np.float32)


def _levels(areas: Areas) -> Float32[np.ndarray, "n"]:
    """Return a level for each colour: 0 for paper, for the others the lowest from 1 that no larger neighbour has."""
    neighbours = _neighbours(areas.labels, len(areas.colours))
    levels = np.full(len(areas.colours), -1, np.int32)
    if areas.paper is not None:
        levels[areas.paper] = 0
    for colour in range(levels.size):
        if levels[colour] < 0:
            used_levels = {0, *levels[neighbours[colour]].tolist()}
            levels[colour] = next(level for level in range(1, levels.size + 2) if level not in used_levels)
    return (levels - levels.min()).astype(np.float32)


def _neighbours(labels: Int32[np.ndarray, "h w"], count: int) -> Bool[np.ndarray, "n n"]:
    touch = np.zeros((count, count), np.bool_)
    for one, other in ((labels[1:], labels[:-1]), (labels[:, 1:], labels[:, :-1])):
        touch[one.reshape(-1), other.reshape(-1)] = True
    touch |= touch.T
    np.fill_diagonal(touch, val=False)
    return touch


def _enlarge(values: Float32[np.ndarray, "r c"], shape: tuple[int, int]) -> Float32[np.ndarray, "h w"]:
    with plain_opencv():
        return np.asarray(cv2.resize(values, shape[::-1], interpolation=cv2.INTER_LINEAR), np.float32)
