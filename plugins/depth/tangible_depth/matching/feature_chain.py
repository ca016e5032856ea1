"""The chain of the report, feature by feature, with exchangeable parts."""

import logging
from collections.abc import Callable
from math import ceil, floor
from typing import NamedTuple

import numpy as np
from jaxtyping import Float32, Int64

from tangible_core.data import DisparityMap, Views, to_grey
from tangible_core.errors import PictureError

from ..dense.span import Span
from ..rectify.fundamental import Fit
from ..rectify.projective import RectifiedPair
from ..rectify.rectification import rectify
from ..sparse.assembling import assemble
from ..sparse.corner_range import MAX_CORNERS, MaxDisparity, range_of_shifts
from ..sparse.harris import corners, least_response, row_edges
from ..sparse.matches import Matches, corner_matches

logger: logging.Logger = logging.getLogger(__name__)

Grey = Float32[np.ndarray, "h w"]
Row = Float32[np.ndarray, "n"]


class Parts(NamedTuple):
    """The exchangeable parts of the chain: the Harris response, F from trusted matches, and the search along rows."""

    response: Callable[[Grey], Grey]
    fit: Fit
    # Search left, right, points (column, row), lowest and highest disparity -> disparity (NaN unknown), score 0..1.
    match_rows: Callable[[Grey, Grey, Int64[np.ndarray, "n 2"], int, int], tuple[Row, Row]]


def disparity_by_features(
    views: Views, parts: Parts, least_contrast: float, least_score: float, max_disparity_px: MaxDisparity
) -> DisparityMap:
    """Compute dense disparity from matched corners and edges. Raises: PictureError for one view; as `rectify`."""
    if views.right is None:
        raise PictureError("matching features needs two views; give a right one")
    left, right = to_grey(views.left), to_grey(views.right)
    least = least_response(least_contrast)
    corner_points = [corners(parts.response(grey), least, MAX_CORNERS) for grey in (left, right)]
    matches = corner_matches(left, right, corner_points[0], corner_points[1])
    rectified_pair = rectify(views, matches=matches, fit=parts.fit)
    span = _range(matches, rectified_pair, max_disparity_px)
    return rectified_pair.to_original(_match_features(rectified_pair.views, parts, least, least_score, *span))


def _match_features(views: Views, parts: Parts, least: float, least_score: float, low: int, high: int) -> DisparityMap:
    assert views.right is not None
    left, right = to_grey(views.left), to_grey(views.right)
    response = parts.response(left)
    points = np.unique(np.vstack([corners(response, least, left.size), row_edges(response, least)]), axis=0)
    shifts_px, value = parts.match_rows(left, right, points, low, high)
    is_match = np.isfinite(shifts_px) & (value >= least_score)
    logger.info("%d features, %d matched along rows over %d..%d px", len(points), np.count_nonzero(is_match), low, high)
    disparity, score = np.full(left.shape, np.nan, np.float32), np.zeros(left.shape, np.float32)
    columns, rows = points[is_match].T
    disparity[rows, columns], score[rows, columns] = shifts_px[is_match], value[is_match]
    return assemble(disparity, score, views.left)


def _range(matches: Matches, rectified_pair: RectifiedPair, most: MaxDisparity) -> Span:
    width = rectified_pair.views.shape[1]
    if most != "auto":
        return Span(floor(-rectified_pair.offset_px), ceil(most - rectified_pair.offset_px)).within(width)
    return range_of_shifts(
        rectified_pair.left_place_px(matches.left_px) - rectified_pair.right_place_px(matches.right_px), width
    )
