"""Geometry from disparity to a relief in metres, and between the frames of picture and workspace (see `data`)."""

from typing import Literal, NamedTuple, TypeVar

import numpy as np
from jaxtyping import Float, Float32, Float64, Int, Shaped

from ..data import Calibration, DisparityMap, Relief
from ..errors import GeometryError
from ..runtime.opencv import cv2, plain_opencv

# Treatment of unknown places: `fill` takes the farther neighbour in the row, `cut` goes down to the base plane.
Holes = Literal["fill", "cut"]
RANGE_PERCENT = (0.5, 99.5)
"""Percentiles of an estimated map between which the relief spans; values beyond, mostly wrong matches, are clipped."""
TINY, HUGE = 1e-30, 1e30  # magnitudes beyond which operations on a float32 may leave its range
MAX_RELIEF_M = 1

Coordinate = TypeVar("Coordinate", float, np.ndarray)


class Rise(NamedTuple):
    """What becomes of the heights of a map: 0 and the top of a relief, or a scale."""

    # Metres of the relief in a metre of the map; None where the map's whole range becomes the relief's height.
    m_per_m: float | None = None
    # The height that becomes 0, below which all is 0; None for the lowest of the map.
    low_m: float | None = None
    high_m: float | None = None  # the height above which all is as high; None for the highest of the map


class ValueRange(NamedTuple):
    """The values that become the bottom and the top of a relief: disparities, depths with their sign, or heights."""

    low: float
    high: float


def disparity_to_depth(
    disparity_px: Float[np.ndarray, "h w"], focal_px: float, baseline_m: float, offset_px: float = 0.0
) -> Float32[np.ndarray, "h w"]:
    """Return the depth along the optical axis, Z = f B / (d + offset).

    Parameters: disparity_px (h, w), NaN where unknown; focal_px > 0; baseline_m > 0; offset_px, the difference of the
    principal points' columns, right minus left.
    Returns: metres, (h, w), NaN where the disparity is unknown or d + offset is not positive.
    Raises: GeometryError if focal_px or baseline_m is not positive.
    Source: Hartley & Zisserman, Multiple View Geometry, 2nd ed., sec. 11.12.

    >>> disparity_to_depth(np.float32([[10, 20, 0]]), focal_px=1000, baseline_m=0.1)
    array([[10.,  5., nan]], dtype=float32)
    """
    camera = Calibration(focal_px, baseline_m, offset_px)
    shift = disparity_px.astype(np.float64) + camera.offset_px
    with np.errstate(over="ignore"):
        return (camera.focal_px * camera.baseline_m / np.where(shift > 0, shift, np.nan)).astype(np.float32)


def make_relief(
    disparity: DisparityMap,
    calibration: Calibration | None,
    width_m: float,
    relief_m: float,
    holes: Holes = "fill",
    spans: ValueRange | None = None,
) -> Relief:
    """Make the relief of a disparity map, far 0 to near relief_m, its pixels square. Raises: GeometryError."""
    # Linear in depth with a calibration, otherwise in disparity; at or beyond infinity is far, beyond `spans` clipped.
    nearness = _nearness(disparity, calibration)
    return _relief(nearness, width_m, relief_m, holes, spans or _value_range(nearness, RANGE_PERCENT))


def unit_nearness(
    disparity: DisparityMap, calibration: Calibration | None, spans: ValueRange
) -> Float32[np.ndarray, "h w"]:
    """Return nearness, 0 at `spans.low` to 1 at `spans.high`, holes filled from behind. Raises: GeometryError."""
    return _unit_range(fill_rows(_nearness(disparity, calibration)), spans).astype(np.float32, copy=False)


def nearness_range(disparity: DisparityMap, calibration: Calibration | None) -> ValueRange:
    """Return RANGE_PERCENT of known nearness: disparity, or, with a calibration, -depth. Raises: GeometryError."""
    return _value_range(_nearness(disparity, calibration), RANGE_PERCENT)


def _nearness(disparity: DisparityMap, calibration: Calibration | None) -> Float[np.ndarray, "h w"]:
    """Return values that grow towards the viewer, NaN where unknown. Raises: GeometryError if no depth is known."""
    nearness = disparity.disparity_px
    if calibration is not None and disparity.unit == "px":
        depth = disparity_to_depth(nearness, calibration.focal_px, calibration.baseline_m, calibration.offset_px)
        nearness = np.where(np.isnan(depth) & ~np.isnan(nearness), -np.inf, -depth)
    if not np.isfinite(nearness).any():
        raise GeometryError(
            "no depth is known anywhere: all disparities are NaN or mean infinity; check that left and "
            "right are two pictures that show something and are not swapped, the search range, and offset_px"
        )
    return nearness


def scale_heights(
    heights: Shaped[np.ndarray, "h w"],
    width_m: float,
    relief_m: float,
    holes: Holes = "fill",
    spans: ValueRange | None = None,
) -> Relief:
    """Make the relief of a height map in any unit, lowest 0, highest relief_m, or of `spans`. Raises: GeometryError."""
    values = np.where(np.isfinite(heights), heights, np.nan)
    if np.isnan(values).all():
        raise GeometryError("the height map holds only NaN or infinity; use one with some known values")
    return _relief(values, width_m, relief_m, holes, spans or _value_range(values, (0, 100)))


def fill_rows(values: Float[np.ndarray, "h w"]) -> Float[np.ndarray, "h w"]:
    """Fill holes (NaN) from the background. Raises: GeometryError if every value is unknown.

    >>> fill_rows(np.float32([[1, np.nan, 3]]))
    array([[1., 1., 3.]], dtype=float32)
    """
    unknown = np.isnan(values)
    if unknown.all():
        raise GeometryError("holes cannot be filled: every value is unknown (NaN); use a map with some known values")
    if not unknown.any():
        return values
    # A hidden place belongs to the surface behind: the farther of two known neighbours in the row (Hirschmueller, PAMI
    # 2008, sec. 2.5); a row without any takes the nearest row with some.
    before, after = _neighbours(unknown)
    wall = np.pad(values, ((0, 0), (0, 1)), constant_values=np.inf)  # both -1 and w mean the wall
    dense = np.minimum(np.take_along_axis(wall, before, axis=1), np.take_along_axis(wall, after, axis=1))
    empty: np.ndarray = np.all(unknown, axis=1)
    return dense[_nearest(~empty)] if empty.any() else dense


def _neighbours(unknown: Shaped[np.ndarray, "h w"]) -> tuple[Int[np.ndarray, "h w"], Int[np.ndarray, "h w"]]:
    """Return the column of the last known value up to each place (-1: none), and of the next one (w: none)."""
    width = unknown.shape[1]
    columns = np.arange(width, dtype=np.int32)
    before = np.maximum.accumulate(np.where(unknown, np.int32(-1), columns), axis=1)
    after = np.minimum.accumulate(np.where(unknown, np.int32(width), columns)[:, ::-1], axis=1)[:, ::-1]
    return before, after


def _nearest(mask: Shaped[np.ndarray, "n"]) -> Int[np.ndarray, "n"]:
    """Return the index of the nearest True of a mask, the lower one of two."""
    places, index = np.flatnonzero(mask), np.arange(mask.size)
    after = np.searchsorted(places, index)
    low, high = places[np.maximum(after - 1, 0)], places[np.minimum(after, places.size - 1)]
    return np.where(index - low <= high - index, low, high)


def flat_relief(shape: tuple[int, int], width_m: float) -> Relief:
    """Make a relief of height 0 with (h, w) square cells. Raises: GeometryError if empty or width_m is not positive."""
    return Relief(np.zeros(shape, np.float32), surface_extent(shape, width_m))


def _relief(
    values: Float[np.ndarray, "h w"], width_m: float, relief_m: float, holes: Holes, spans: ValueRange
) -> Relief:
    if not (0 < width_m < np.inf and 0 < relief_m < np.inf):
        raise GeometryError(f"width_m and relief_m must be positive lengths in metres, not {width_m} and {relief_m}")
    whole = fill_rows(values) if holes == "fill" else values
    heights = _unit_range(whole, spans)
    heights *= relief_m
    if holes == "cut":
        heights = np.nan_to_num(heights, nan=0.0)
    return Relief(heights.astype(np.float32, copy=False), surface_extent(values.shape, width_m))


def surface_extent(shape: tuple[int, ...], width_m: float) -> tuple[float, float]:
    """Return width and length of a surface of (h, w) square cells that is this wide, m."""
    return width_m, width_m * shape[0] / max(shape[1], 1)


def _value_range(values: Float[np.ndarray, "h w"], percent: tuple[float, float]) -> ValueRange:
    """Return percentiles of the known values, or their extremes if these are equal; one value for a constant map."""
    finite = values[np.isfinite(values)]
    exponent = np.frexp(np.max(np.abs(finite)))[1]  # divided out first: the largest floats have no difference
    parts = np.ldexp(finite.astype(np.float64), -exponent)
    low, high = np.percentile(parts, percent)
    if not low < high:
        low, high = parts.min(), parts.max()
    if high - low <= 4 * np.finfo(values.dtype).eps * max(abs(low), abs(high)):
        high = low
    return ValueRange(*(float(np.ldexp(end, exponent)) for end in (low, high)))


def _unit_range(values: Float[np.ndarray, "h w"], spans: ValueRange) -> Float[np.ndarray, "h w"]:
    size = max(abs(spans.low), abs(spans.high)) or 1.0
    low, high = spans.low / size, spans.high / size
    if not low < high:
        return np.zeros(values.shape)
    if not (spans.high - spans.low > TINY and size < HUGE):  # their difference, or their share, would not be a float32
        values, spans = values.astype(np.float64) / size, ValueRange(low, high)
    with np.errstate(over="ignore"):
        part = (values - values.dtype.type(spans.low)) * values.dtype.type(1 / (spans.high - spans.low))
        return np.clip(part, 0, 1, out=part)


def picture_to_workspace(
    column: Coordinate, row: Coordinate, shape: tuple[int, int], extent_m: tuple[float, float]
) -> tuple[Coordinate, Coordinate]:
    """Return the position (x_m, y_m) of a place of an (h, w) picture on a surface of this extent.

    Pixel centres are at whole numbers and each pixel is a cell of the surface, so the picture's left edge is column
    -0.5. Row 0 is far from the user, at the largest y.

    >>> picture_to_workspace(0.0, 0.0, (1, 2), (0.08, 0.04))
    (-0.02, 0.0)
    """
    rows, columns = shape
    return ((column + 0.5) / columns - 0.5) * extent_m[0], (0.5 - (row + 0.5) / rows) * extent_m[1]


def workspace_to_picture(
    x_m: Coordinate, y_m: Coordinate, shape: tuple[int, int], extent_m: tuple[float, float]
) -> tuple[Coordinate, Coordinate]:
    """Return (column, row), not rounded: the inverse of `picture_to_workspace`.

    >>> workspace_to_picture(-0.02, 0.0, (1, 2), (0.08, 0.04))
    (0.0, 0.0)
    """
    rows, columns = shape
    return (x_m / extent_m[0] + 0.5) * columns - 0.5, (0.5 - y_m / extent_m[1]) * rows - 0.5


def resample(relief: Relief, shape: tuple[int, int]) -> Relief:
    """Resample the surface on another grid of (h, w) cells; extent and metres stay. Raises: GeometryError if empty."""
    if min(shape) < 1:
        raise GeometryError(f"a relief has at least one cell, not {shape[0]} x {shape[1]}")
    # Each cell is taken as a tilted facet whose mean is its height, and each new height is the mean over its cell: the
    # volume stays, a plane stays that plane, nothing overshoots, and refining and back is the same (van Leer, J.
    # Comput. Phys. 32, 1979, the monotonised central slope).
    along = _resample_columns(relief.height_m.astype(np.float64).T, shape[0]).T
    return Relief(_resample_columns(along, shape[1]).astype(np.float32), relief.extent_m)


def _resample_columns(heights: Float64[np.ndarray, "h w"], count: int) -> Float64[np.ndarray, "h n"]:
    """Return means over `count` equal cells a row, as differences of the facets' integral at the new edges."""
    width = heights.shape[1]
    if width == count:
        return heights
    edges = np.arange(count + 1) * width / count
    cell = np.minimum(edges.astype(np.int64), width - 1)
    part = edges - cell
    whole = np.pad(np.cumsum(heights, axis=1), ((0, 0), (1, 0)))
    integral = whole[:, cell] + heights[:, cell] * part + _tilts(heights)[:, cell] * (part * (part - 1) / 2)
    return np.maximum(np.diff(integral, axis=1) * (count / width), 0)


def _tilts(heights: Float64[np.ndarray, "h w"]) -> Float64[np.ndarray, "h w"]:
    """Return the rise across each cell: the central difference, limited to the range of the neighbours."""
    if heights.shape[1] == 1:
        return np.zeros_like(heights)
    steps = np.diff(heights, axis=1)
    steps = np.concatenate([steps[:, :1], steps, steps[:, -1:]], axis=1)
    left, right = steps[:, :-1], steps[:, 1:]
    bound = 2 * np.minimum(np.abs(left), np.abs(right))
    tilt = np.where(left * right > 0, np.clip((left + right) / 2, -bound, bound), 0)
    return np.clip(tilt, -2 * heights, 2 * heights)


def smooth(relief: Relief, sigma_m: float) -> Relief:
    """Smooth the relief by a Gaussian of this standard deviation, its borders extended. Raises: GeometryError."""
    if not 0 <= sigma_m < np.inf:
        raise GeometryError(f"sigma_m must be a length in metres, 0 or more, not {sigma_m}")
    # Matching noise is rough where the real surface is not, and a force law that follows slopes amplifies it.
    sigmas = sigma_m / relief.pitch_m[0], sigma_m / relief.pitch_m[1]
    if max(sigmas) < 0.1:  # a pixel's own size hides it
        return relief
    with plain_opencv():
        heights = cv2.GaussianBlur(
            relief.height_m, (0, 0), max(sigmas[0], 1e-3), sigmaY=max(sigmas[1], 1e-3), borderType=cv2.BORDER_REPLICATE
        )
    return Relief(np.maximum(heights, 0), relief.extent_m)


def slopes(relief: Relief) -> tuple[Float32[np.ndarray, "h w"], Float32[np.ndarray, "h w"]]:
    """Return slopes dh/dx and dh/dy in the workspace frame, by central differences; y runs against the rows."""
    across, along = relief.pitch_m
    heights = relief.height_m
    return _difference(heights, across, 1), -_difference(heights, along, 0)


def _difference(heights: Float32[np.ndarray, "h w"], pitch_m: float, axis: int) -> Float32[np.ndarray, "h w"]:
    if heights.shape[axis] == 1:
        return np.zeros_like(heights)
    return np.gradient(heights, pitch_m, axis=axis).astype(np.float32)


def normals(relief: Relief) -> Float32[np.ndarray, "h w 3"]:
    """Return unit normals (x, y, z) out of the surface, in the workspace frame."""
    across, along = slopes(relief)
    up = np.stack([-across, -along, np.ones_like(across)], axis=2)
    return up / np.linalg.norm(up, axis=2, keepdims=True)
