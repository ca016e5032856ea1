"""Dense matching of square windows: what `zncc` and `ssd` share."""

import numpy as np
from jaxtyping import Float, Float32

from tangible_core.threads import in_blocks

from .confidence import LEAST_MATCHED
from .correlation import correlate_strip
from .dense import Dense, completed
from .lanes import Lanes
from .pairs import Pair
from .span import Span
from .strips import blank

LEAST_VARIANCE = 1.0
"""Grey levels squared below which a window says nothing."""
SSD_SCALE = 400.0
"""Mean squared difference of grey levels at which the confidence has fallen to 1/e."""


def match_by_correlation(pair: Pair, span: Span, window_px: int) -> Dense:
    """Zero-mean normalised cross-correlation; the confidence of a match is its correlation."""
    disparity, scores = _match(pair, span, window_px, None, 0.0)
    return _completed(disparity, np.clip(scores, 0, 1), pair)


def match_by_difference(pair: Pair, span: Span, window_px: int) -> Dense:
    """Sum of squared differences S; the confidence of a match is exp(-S / (pixels x SSD_SCALE))."""
    disparity, scores = _match(pair, span, window_px, True, -1e29)
    return _completed(disparity, np.exp(np.minimum(scores, 0) / (window_px**2 * SSD_SCALE)), pair)


def _match(
    pair: Pair, span: Span, window_px: int, squared: bool | None, least: float
) -> tuple[np.ndarray, Float32[np.ndarray, "h w"]]:
    disparity, scores = blank(pair.left.shape)[0], np.full(pair.left.shape, -1e30, np.float32)
    radius = window_px // 2
    if min(pair.left.shape) < window_px:
        return disparity, scores

    def block(y0: int, y1: int) -> None:
        lanes = Lanes(span.lanes)
        how = (radius, span, np.float32(least), LEAST_VARIANCE)
        correlate_strip(lanes, squared, *pair, (y0, y1), *how, disparity, scores)

    in_blocks(pair.left.shape[0], block)
    return disparity, scores


def _completed(disparity: np.ndarray, trust: Float[np.ndarray, "h w"], pair: Pair) -> Dense:
    quality = np.rint(255 * trust).astype(np.uint8)
    return completed(disparity, quality, np.maximum(np.arange(256) / 255, LEAST_MATCHED), pair.left)
