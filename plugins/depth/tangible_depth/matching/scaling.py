"""Semi-global matching at full size, or at a smaller one for a preview or a very wide range."""

import logging
from typing import Literal, NamedTuple

import numpy as np
from jaxtyping import UInt8

from tangible_core.plugins import note

from ..dense.confidence import FILLED, FLAT_REACH, MIN_MATCHED
from ..dense.filling.gaps import Effort
from ..dense.refinement import Cleaning, DenseMatches, complete, enlarge
from ..dense.span import UNKNOWN, Span
from ..search.pairs import Pair
from ..sgm.costs import COSTS, SHARP, Penalties, p2_by_grey_step
from ..sgm.strips import MAX_LANES, strips
from .adaptive import Fixed, match

log: logging.Logger = logging.getLogger(__name__)
CHECK_TOLERANCE = {"soft": 1.08, "strict": 1.0}
"""Factor on the best cost of the right pixel that a match may have, by the option `check`."""
# Cost of a preview: at half the size noise is averaged away, and surfaces end within fewer pixels.
HALVED = SHARP._replace(penalties=Penalties(np.uint8(8), np.uint8(8), p2_by_grey_step(40, 10, 2.0)))
# Largest number of disparities that `resolution: auto` matches at full size; wider ranges hardly need it.
MAX_AT_FULL_SIZE = 256


class Scaling(NamedTuple):
    """The options of `semi-global` about size and cost, under their own names."""

    resolution: Literal["full", "half", "auto"]
    effort: Effort
    cost: Literal["auto", "sharp", "levels", "light", "heavy"]
    check: Literal["soft", "strict"]
    realign_rows: bool
    skip_flat: bool


def match_scaled(pair: Pair, span: Span, options: Scaling) -> DenseMatches:
    """Match a pair and return a dense map of its full size."""
    factor = _factor(span, options)
    small = pair.downsample(factor)
    dense = _match(small, span.downsample(factor).within(small.width), options, factor)
    while factor > 1:
        factor //= 2
        dense = enlarge(dense, pair.downsample(factor).left)
    return dense


def _factor(span: Span, options: Scaling) -> int:
    """Choose the factor by which the pictures are downsampled before the matching: a power of two."""
    factor = 2 if options.resolution == "half" else 1
    most = MAX_AT_FULL_SIZE if options.resolution == "auto" else MAX_LANES
    while span.downsample(factor).size > most:
        factor *= 2
    if factor > 1:
        note(log, f"skipped: full resolution, matched at 1/{factor}")
    return factor


def _has_texture(grey: UInt8[np.ndarray, "h w"], y0: int, y1: int) -> bool:
    """Test whether any pixel of rows y0..y1-1 is not flat (`flat_pixels`); one row tells it of nearly every strip."""
    rows = grey[max(0, y0 - FLAT_REACH) : y1 + FLAT_REACH]
    return any(not np.array_equal(part[:, 1:], part[:, :-1]) for part in (rows[:1], rows))


def _match(pair: Pair, span: Span, options: Scaling, factor: int) -> DenseMatches:
    rows = strips(pair.left.shape, span)
    if options.skip_flat:
        textured_strips = [row for row in rows if _has_texture(pair.left, *row)]
        if len(textured_strips) < len(rows):
            note(log, f"skipped: {len(rows) - len(textured_strips)} of {len(rows)} strips, which have no texture")
        rows = textured_strips
    preview = options.resolution == "half"
    cost = HALVED if preview and options.cost == "auto" else COSTS.get(options.cost)
    realign_rows = options.realign_rows and not preview
    matches = match(pair, span, rows, Fixed(cost, CHECK_TOLERANCE[options.check], realign_rows, options.effort))
    by_sum = np.maximum(1 - np.arange(256) / (4 * matches.cost.bits), MIN_MATCHED)
    cleaning = Cleaning(not preview, matches.cost.specks, factor, options.effort)
    from_right = None
    if (
        right_view := matches.mirrored_right
    ) is not None:  # its matches at its own pixels, cleaned as the default does it
        dense = complete(*right_view.matches, by_sum, right_view.grey, cleaning._replace(effort="balanced"))
        from_right = np.where(dense.confidence > FILLED, dense.disparity, UNKNOWN)[:, ::-1].copy()
    return complete(*matches.left.matches, by_sum, matches.left.grey, cleaning, from_right)
