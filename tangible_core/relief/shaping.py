"""The steps from a disparity map to the relief that is felt."""

from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Float64

from ..data import Calibration, DisparityMap, Relief
from ..runtime.opencv import cv2, plain_opencv
from ..scene import geometry, scaling
from ..scene.geometry import ValueRange
from ..scene.workspace import FeltSize
from .choice import ReliefChoice
from .slope_limit import limit_slopes

# The finest cells on which a relief is shaped, m; what is rounded by 0.25 mm has no finer detail.
CELL_M = 1e-4
CELL_SHARE = 0.4
# The standard deviation below which a neighbourhood is noise, m: what a Falcon feels is three times as high.
GRAIN_HIGH_M = 1e-4
ACCENT_REACH_M = 0.0015  # the standard deviation of the Gaussian that says how high the surroundings are, m


class ReliefScale(NamedTuple):
    """What the frames of a film share, so that a thing that stands still keeps its height."""

    spans: ValueRange
    tones: Float64[np.ndarray, "n"]  # heights, 0 to 1, of evenly spaced values of nearness between these


def relief_scale(
    disparity: DisparityMap, calibration: Calibration | None, width_m: float, choice: ReliefChoice
) -> ReliefScale:
    """Return the scale of the relief of this map alone. Raises: GeometryError if no depth is known."""
    calibration = _calibration(calibration, choice)
    spans = geometry.nearness_range(disparity, calibration)
    if not choice.spread_share:
        return ReliefScale(spans, STRAIGHT)
    nearness = geometry.unit_nearness(disparity, calibration, spans)
    return ReliefScale(spans, relief_tones(_on_cells(nearness, width_m, CELL_M), choice.spread_share))


def shape_relief(
    disparity: DisparityMap,
    calibration: Calibration | None,
    size: FeltSize,
    choice: ReliefChoice,
    scale: ReliefScale | None = None,
) -> Relief:
    """Make the relief of a disparity map: far 0, near `size.relief_m` at most, pixels square. Raises: GeometryError."""
    scale = scale or relief_scale(disparity, calibration, size.width_m, choice)
    extent_m = geometry.surface_extent(disparity.disparity_px.shape, size.width_m)
    nearness = geometry.unit_nearness(disparity, _calibration(calibration, choice), scale.spans)
    # Each step is done on cells no finer than is felt after the rounding, so that time hardly grows with the picture.
    # Noise: He et al., PAMI 2013; accent: Luft et al. 2006, as height.
    cells = _on_cells(nearness, size.width_m, min(CELL_M, CELL_SHARE * size.smooth_m))
    pitch_m = size.width_m / cells.shape[1]
    height_m = apply_tones(cells, scale.tones) * np.float32(size.relief_m)
    if choice.grain_m:
        height_m = _without_grain(height_m, pitch_m, choice.grain_m)
    if choice.most_accent_m:
        height_m = _accent(height_m, pitch_m, choice.most_accent_m, size.relief_m)
    if size.holes == "cut" and (unknown := np.isnan(disparity.disparity_px)).any():
        height_m[scaling.reduced_mask(unknown, height_m.shape)] = 0
    smooth = geometry.smooth(Relief(limit_slopes(height_m, pitch_m, choice.slope), extent_m), size.smooth_m)
    return Relief(_enlarge(smooth.height_m, nearness.shape), extent_m)


def _calibration(calibration: Calibration | None, choice: ReliefChoice) -> Calibration | None:
    return calibration if choice.by == "depth" else None


def _on_cells(nearness: Float32[np.ndarray, "h w"], width_m: float, cell_m: float) -> Float32[np.ndarray, "r c"]:
    factor = scaling.felt_factor(nearness.shape[1], width_m, cell_m)
    return scaling.reduced_map(nearness, scaling.reduced_shape(nearness.shape, factor))


def _without_grain(height_m: Float32[np.ndarray, "h w"], pitch_m: float, grain_m: float) -> Float32[np.ndarray, "h w"]:
    """Flatten noise lower than GRAIN_HIGH_M in windows of this radius, and keep steps."""
    # The guided filter with itself as guide, its coefficients found on a half as fine grid (He & Sun 2015).
    shape = scaling.reduced_shape(height_m.shape, 2)
    with plain_opencv():
        coarse = np.asarray(cv2.resize(height_m, shape[::-1], interpolation=cv2.INTER_AREA))
        gain, offset = filter_coefficients(coarse * np.float32(1 / GRAIN_HIGH_M), grain_m / (2 * pitch_m), 1)
    return _enlarge(gain, height_m.shape) * height_m + _enlarge(offset * np.float32(GRAIN_HIGH_M), height_m.shape)


def _accent(
    height_m: Float32[np.ndarray, "h w"], pitch_m: float, most_m: float, relief_m: float
) -> Float32[np.ndarray, "h w"]:
    shape = scaling.reduced_shape(height_m.shape, 4)
    sigma = ACCENT_REACH_M / (pitch_m * height_m.shape[1] / shape[1])
    with plain_opencv():
        coarse = cv2.resize(height_m, shape[::-1], interpolation=cv2.INTER_AREA)
        around = np.asarray(cv2.GaussianBlur(coarse, (0, 0), max(sigma, 1e-3), borderType=cv2.BORDER_REPLICATE))
    above = height_m - _enlarge(around, height_m.shape)
    return np.clip(height_m + np.clip(above, -np.float32(most_m), np.float32(most_m)), 0, np.float32(relief_m))


def _enlarge(values: Float32[np.ndarray, "r c"], shape: tuple[int, int]) -> Float32[np.ndarray, "h w"]:
    if values.shape == shape:
        return values
    with plain_opencv():
        return np.asarray(cv2.resize(values, shape[::-1], interpolation=cv2.INTER_LINEAR))


BINS = 256  # places of the map, less one: as many as a lookup table of OpenCV has
BORDER = 0.03  # the least difference of nearness of two cells at a border, of its whole range
# Distance between these two cells: matched borders are one or two cells wide.
REACH = 2
# The greatest density of borders, over its mean; what is cut off is shared out to all depths.
STEEPEST = 4.0
STRAIGHT = np.linspace(0, 1, BINS + 1)


def relief_tones(nearness: Float32[np.ndarray, "h w"], share: float) -> Float64[np.ndarray, "n"]:
    """Return the heights, 0 to 1, of BINS + 1 evenly spaced values of nearness from 0 to 1."""
    density = _border_density(nearness) if share else np.zeros(BINS)
    if not density.any():
        return STRAIGHT
    # Each border counts once, however high: its weight is spread evenly over the depths between its sides (Pizer et al.
    # 1987, the clipped histogram, of borders in place of pixels). The slope is 1 - share to 1 + share STEEPEST.
    cut = np.minimum(density / density.mean(), STEEPEST)
    slope = share * (cut + 1 - cut.mean()) + 1 - share
    return np.concatenate([[0], np.cumsum(slope) / BINS])


def apply_tones(nearness: Float32[np.ndarray, "h w"], tones: Float64[np.ndarray, "n"]) -> Float32[np.ndarray, "h w"]:
    """Return the heights of these values of nearness, 0 to 1, interpolated between the places of the map."""
    place = nearness * np.float32(BINS)
    below = np.minimum(np.floor(place), np.float32(BINS - 1))
    place -= below
    index = below.astype(np.uint8)
    place *= cv2.LUT(index, np.diff(tones).astype(np.float32))
    place += cv2.LUT(index, tones[:-1].astype(np.float32))
    return place


def _border_density(nearness: Float32[np.ndarray, "h w"]) -> Float64[np.ndarray, "n"]:
    change = np.zeros(BINS + 1)
    for one, other in ((nearness[:, REACH:], nearness[:, :-REACH]), (nearness[REACH:], nearness[:-REACH])):
        at_border = np.abs(one - other) > BORDER
        one, other = one[at_border], other[at_border]
        low, high = np.minimum(one, other), np.maximum(one, other)
        weight = 1 / (high - low).astype(np.float64)
        change += np.bincount((low * BINS).astype(np.int32), weight, BINS + 1)
        change -= np.bincount((high * BINS).astype(np.int32), weight, BINS + 1)
    return np.maximum(np.cumsum(change)[:BINS], 0)


Map = Float32[np.ndarray, "h w"]


def filter_coefficients(values: Map, radius: float, deviation: float) -> tuple[Map, Map]:
    """Return two maps: the filtered map is the first times the values plus the second (He et al., PAMI 2013)."""
    side = 2 * max(1, round(radius)) + 1

    def mean(values: np.ndarray) -> np.ndarray:
        return np.asarray(cv2.blur(values, (side, side), borderType=cv2.BORDER_REPLICATE))

    around = mean(values)
    variance = np.maximum(mean(values * values) - around * around, 0)
    gain = variance / (variance + np.float32(deviation**2))
    return mean(gain), mean((1 - gain) * around)
