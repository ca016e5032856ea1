"""Dense matching of square windows, shared by `zncc` and `ssd`."""

from collections.abc import Callable

import numpy as np
from jaxtyping import Float32

from tangible_core.compiled import exponentials, in_blocks

from ..dense.confidence import MIN_MATCHED
from ..dense.refinement import DenseMatches, complete
from ..dense.span import Span
from ..search.pairs import Pair
from ..sgm.strips import unknown_matches
from ..simd.lanes import Lanes
from ..windows.correlation import correlate_strip

MIN_VARIANCE = 1.0
SSD_SCALE = 400.0  # mean squared difference of grey levels at which the confidence has fallen to 1/e

Trust = Callable[[Float32[np.ndarray, "rows w"]], Float32[np.ndarray, "rows w"]]


def match_by_correlation(pair: Pair, span: Span, window_px: int) -> DenseMatches:
    """Match by zero-mean normalised cross-correlation; the confidence of a match is its correlation."""
    return _match(pair, span, window_px, None, 0.0, lambda scores: np.clip(scores, 0, 1))


def match_by_difference(pair: Pair, span: Span, window_px: int) -> DenseMatches:
    """Match by the sum of squared differences S; the confidence of a match is exp(-S / (pixels x SSD_SCALE))."""
    scale = np.float32(window_px**2 * SSD_SCALE)
    return _match(pair, span, window_px, True, -1e29, lambda scores: exponentials(np.minimum(scores, 0) / scale))


def _match(pair: Pair, span: Span, window_px: int, is_squared: bool | None, least: float, trust: Trust) -> DenseMatches:
    disparity, quality = unknown_matches(pair.left.shape)
    scores = np.full(pair.left.shape, -1e30, np.float32)

    def block(y0: int, y1: int) -> None:
        how = (window_px // 2, span, np.float32(least), MIN_VARIANCE)
        correlate_strip(Lanes(span.lanes), is_squared, *pair, (y0, y1), *how, disparity, scores)
        quality[y0:y1] = np.rint(255 * trust(scores[y0:y1]))

    if min(pair.left.shape) >= window_px:
        in_blocks(pair.left.shape[0], block)
    return complete(disparity, quality, np.maximum(np.arange(256) / 255, MIN_MATCHED), pair.left)
