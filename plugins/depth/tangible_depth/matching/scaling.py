"""Semi-global matching at the size that serves: full, or smaller for a preview or a very wide range."""

import logging
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import UInt8

from tangible_core.plugins.notes import note

from ..dense.confidence import FLAT_REACH, LEAST_MATCHED
from ..dense.filling.gaps import Effort
from ..dense.refinement import Cleaning, DenseMatches, completed, enlarged
from ..dense.span import Span
from ..search.pairs import Pair
from ..sgm.costs import COSTS, SHARP, Penalties, p2_by_grey_step
from ..sgm.strips import MOST_LANES, strips
from .adaptive import match

log = logging.getLogger(__name__)
CHECK_TOLERANCE = {"soft": 1.08, "strict": 1.0}
HALVED = SHARP._replace(penalties=Penalties(np.uint8(8), np.uint8(8), p2_by_grey_step(40, 10, 2.0)))
"""Of a preview: at half the size noise is averaged away, and surfaces end within fewer pixels."""
MOST_AT_FULL_SIZE = 256
"""Disparities up to which `auto` works at full size: beyond, a coarser map costs little and saves much."""


class Scaling(NamedTuple):
    """What `semi-global` says of the size and the costs at which it matches; each as its option of that name."""

    resolution: Literal["full", "half", "auto"]
    effort: Effort
    cost: Literal["auto", "sharp", "levels", "light", "heavy"]
    check: Literal["soft", "strict"]
    realign_rows: bool
    skip_flat: bool


def match_scaled(pair: Pair, span: Span, options: Scaling) -> DenseMatches:
    """A dense map of the pair's own size, whatever size was matched at."""
    factor = _factor(span, options)
    small = pair.shrunk(factor)
    dense = _match(small, span.shrunk(factor).within(small.width), options, factor)
    while factor > 1:
        factor //= 2
        dense = enlarged(dense, pair.shrunk(factor).left)
    return dense


def _factor(span: Span, options: Scaling) -> int:
    """By how much the pictures are made smaller before they are matched: a power of two."""
    factor = 2 if options.resolution == "half" else 1
    most = MOST_AT_FULL_SIZE if options.resolution == "auto" else MOST_LANES
    while span.shrunk(factor).size > most:
        factor *= 2
    if factor > 1:
        note(log, f"skipped: full resolution, matched at 1/{factor}")
    return factor


def _has_texture(grey: UInt8[np.ndarray, "h w"], y0: int, y1: int) -> bool:
    """Whether any pixel of rows y0..y1-1 is not flat (`flat_pixels`)."""
    rows = grey[max(0, y0 - FLAT_REACH) : y1 + FLAT_REACH]
    return not np.array_equal(rows[:, 1:], rows[:, :-1])


def _match(pair: Pair, span: Span, options: Scaling, factor: int) -> DenseMatches:
    rows = strips(pair.left.shape, span)
    if options.skip_flat:
        textured = [each for each in rows if _has_texture(pair.left, *each)]
        if len(textured) < len(rows):
            note(log, f"skipped: {len(rows) - len(textured)} of {len(rows)} strips, which have no texture")
        rows = textured
    preview = options.resolution == "half"
    cost = HALVED if preview and options.cost == "auto" else COSTS.get(options.cost)
    realign_rows = options.realign_rows and not preview
    swept, cost = match(pair, span, cost, CHECK_TOLERANCE[options.check], realign_rows, rows, options.effort)
    by_sum = np.maximum(1 - np.arange(256) / (4 * cost.bits), LEAST_MATCHED)
    cleaning = Cleaning(not preview, cost.specks, factor, options.effort)
    return completed(swept.disparity, swept.sums, by_sum, pair.left, cleaning)
