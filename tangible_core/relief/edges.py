"""The relief of one picture of which no depth is known: its edges as raised lines, as in a tactile graphic."""
# scipy has no types.
# pyright: reportMissingTypeStubs=false, reportUnknownVariableType=false

import numpy as np
from jaxtyping import Bool, Float32, Int32, UInt8

from ..data import Relief, Views
from ..data.views import border_pixels
from ..runtime.opencv import cv2, plain_opencv
from ..scene import geometry, scaling
from ..scene.workspace import FeltSize
from .choice import ReliefChoice
from .shaping import filter_coefficients
from .slope_limit import limit_slopes

CELL_M = 3.3e-4
# The blur's sigma is the geometric mean of this length, m, and this share of the width: wide ones hold more lines.
BLUR_M, BLUR_SHARE = 0.001, 1 / 80
# Share of the picture below an edge's contrast; by how much less an edge may have that continues a strong one.
STRONG, WEAK = 0.94, 1.5
# The least contrast of an edge, Lab units over the blur: about what is seen between two shades side by side.
LEAST = 1.0
LONG = 10.0
# The standard deviation of the profile of a line, m: a line of 1 mm, as tactile graphics have.
LINE_M = 0.0004
# The share of the height that lines have; the rest is that of light over dark.
LINES = 0.6
HALF = 0.5
# Least value of a map of borders in a line: of .55 to .7, the best for the borders of 30 drawn photographs.
SURE = 0.55
# The radius, m, within which light and dark are made even, and their standard deviation up to which they are.
CALM_M, CALM = 0.0015, 0.1


def edge_relief(
    views: Views,
    size: FeltSize,
    choice: ReliefChoice,
    regions: Int32[np.ndarray, "r c"] | None = None,
    borders: Float32[np.ndarray, "h w"] | None = None,
) -> Relief:
    """Make the relief of the left view's edges: raised lines on low steps from dark to light, pixels square."""
    extent_m = geometry.surface_extent(views.shape, size.width_m)
    small = reduce_to_cells(views, size.width_m)
    pitch_m = size.width_m / small.shape[1]
    with plain_opencv():
        lab = np.asarray(cv2.cvtColor(_colours(small), cv2.COLOR_RGB2LAB), np.float32)
        sigma = (BLUR_M * BLUR_SHARE * size.width_m) ** 0.5 / pitch_m
        # The borders of regions, else the ridges of a map of borders, else differences of colour at the scale of the
        # blur that are among the strongest, or continue one (Canny 1986, on the channel of Lab with the greatest
        # difference).
        if regions is not None:
            lines = _lines(border_pixels(regions), HALF, pitch_m)
        elif borders is not None:
            sure = scaling.reduced_map(borders, lab.shape[:2]) > SURE
            thin = np.asarray(cv2.ximgproc.thinning(255 * sure.astype(np.uint8)))
            lines = _lines(_long(thin, sigma), 0, pitch_m)
        else:
            lines = _lines(_edges(lab, sigma), 0, pitch_m)
        height_m = (1 - LINES) * size.relief_m * _calm_light(np.ascontiguousarray(lab[..., 0]) / 100, pitch_m)
        height_m = np.maximum(height_m + LINES * size.relief_m * lines, 0).astype(np.float32)
        enlarged = np.asarray(cv2.resize(height_m, views.shape[::-1], interpolation=cv2.INTER_LINEAR))
    relief = Relief(limit_slopes(enlarged, size.width_m / views.shape[1], choice.slope), extent_m)
    return geometry.smooth(relief, size.smooth_m)


def reduce_to_cells(views: Views, width_m: float) -> np.ndarray:
    """Return the left view on the cells on which edges are found."""
    factor = scaling.felt_factor(views.shape[1], width_m, CELL_M)
    return scaling.reduce_views(Views(views.left), factor).left


def _colours(picture: np.ndarray) -> Float32[np.ndarray, "h w 3"]:
    scale = np.iinfo(picture.dtype).max if picture.dtype.kind in "iu" else 1
    colours = picture[..., :3] if picture.ndim == 3 and picture.shape[2] >= 3 else np.dstack([picture] * 3)
    return colours.astype(np.float32) / np.float32(scale)


def _lines(at_edge: Bool[np.ndarray, "h w"], off: float, pitch_m: float) -> Float32[np.ndarray, "h w"]:
    """Return the profile of the lines, 0 to 1. off: the distance of an edge's cells from the edge itself, cells."""
    from scipy.ndimage import distance_transform_edt

    if not at_edge.any():
        return np.zeros(at_edge.shape, np.float32)
    distance_m = (np.asarray(distance_transform_edt(~at_edge)) + off) * pitch_m
    return np.exp(-((distance_m / LINE_M) ** 2) / 2).astype(np.float32)


def _edges(lab: Float32[np.ndarray, "h w 3"], sigma: float) -> Bool[np.ndarray, "h w"]:
    smooth = cv2.GaussianBlur(lab, (0, 0), max(sigma, 0.3), borderType=cv2.BORDER_REPLICATE)
    across, along = (
        cv2.Sobel(smooth, cv2.CV_32F, *order, scale=sigma / 8, borderType=cv2.BORDER_REPLICATE)
        for order in ((1, 0), (0, 1))
    )
    contrast = np.hypot(across, along)
    channel = contrast.argmax(axis=2)[..., None]
    across, along, contrast = (
        np.take_along_axis(np.asarray(slope), channel, axis=2)[..., 0] for slope in (across, along, contrast)
    )
    strong = max(float(np.quantile(contrast, STRONG)), LEAST)
    unit = 16384 / max(float(contrast.max()), strong)  # OpenCV takes whole numbers of 16 bits
    whole_across, whole_along = (np.rint(slope * unit).astype(np.int16) for slope in (across, along))
    edges = cv2.Canny(whole_across, whole_along, strong / WEAK * unit, strong * unit, L2gradient=True)
    return _long(np.asarray(edges), sigma)


def _long(edges: UInt8[np.ndarray, "h w"], sigma: float) -> Bool[np.ndarray, "h w"]:
    """Return the cells of lines that are not 0, without the short ones. sigma: of the blur, cells."""
    _, pieces, about, _ = cv2.connectedComponentsWithStats(edges, connectivity=8)
    long: np.ndarray = np.asarray(about)[:, cv2.CC_STAT_AREA] >= LONG * sigma
    long[0] = False
    return long[np.asarray(pieces, np.int32)]


def _calm_light(light: Float32[np.ndarray, "h w"], pitch_m: float) -> Float32[np.ndarray, "h w"]:
    """Return light and dark from 0 to 1, even but for their steps."""
    low, high = np.percentile(light, geometry.RANGE_PERCENT)
    if high - low < LEAST / 100:
        return np.zeros_like(light)
    light = np.clip((light - low) / (high - low), 0, 1).astype(np.float32)
    gain, offset = filter_coefficients(light, CALM_M / pitch_m, CALM)
    return gain * light + offset
