"""Semi-global matching of a picture in strips: threads, memory, seams."""

from collections.abc import Iterable, Sequence
from typing import NamedTuple

import numpy as np
from jaxtyping import Int16, UInt8

from tangible_core.compiled import in_turns

from ..dense.span import UNKNOWN, Span
from ..simd.lanes import Lanes
from .aggregation import scratch, sweep_strip
from .costs import Penalties
from .paths import row_limits

ROWS = 128
WARM_ROWS = 16
"""Rows before a strip at which its paths start: rows farther away hardly affect it."""
VOLUME_BYTES = 256 << 20
"""Largest memory for the cost volumes of all threads together, bytes."""
AT_ONCE = 4
"""Fewest strips in memory at once; more run in parallel only if they are small."""
MAX_LANES = 512
"""Largest number of SIMD lanes, so of disparities at full size."""


class StripMatches(NamedTuple):
    """Disparity in sixteenths of a pixel, UNKNOWN if none passed the left-right check, and the winner's cost."""

    disparity: Int16[np.ndarray, "h w"]
    sums: UInt8[np.ndarray, "h w"]


def unknown_matches(shape: tuple[int, int]) -> StripMatches:
    """Allocate a map of UNKNOWN disparities."""
    return StripMatches(np.full(shape, UNKNOWN, np.int16), np.full(shape, 255, np.uint8))


def strips(shape: tuple[int, int], span: Span) -> list[tuple[int, int]]:
    """Return first and last + 1 row of each strip: ROWS high, or lower if AT_ONCE volumes would exceed VOLUME_BYTES."""
    h, w = shape
    # Independent of the number of threads, as seams are visible in a map.
    rows = max(8, min(ROWS, VOLUME_BYTES // (AT_ONCE * w * span.lanes)))
    return [(y, min(y + rows, h)) for y in range(0, h, rows)]


def sweep(
    codes: tuple[UInt8[np.ndarray, "h planes whole"], UInt8[np.ndarray, "h planes whole"]],
    grey: UInt8[np.ndarray, "h w"],
    span: Span,
    penalties: Penalties,
    check_tolerance: float,
    only: Sequence[tuple[int, int]],
    out: StripMatches,
    warm: int = WARM_ROWS,
    most_level: int = 0,
) -> None:
    """Match the strips `only` into `out`, their paths begun `warm` rows early; independent of the number of threads."""
    w, n = grey.shape[1], span.lanes
    planes = codes[0].shape[1]
    lanes = Lanes(n, planes - (most_level > 0), most_level)
    limits = row_limits(n, w, span, penalties.neutral)
    highest = max((y1 - y0 for y0, y1 in only), default=0)

    def work(share: Iterable[tuple[int, int]]) -> None:
        room = scratch(highest, w, n, planes)
        for rows in share:
            sweep_strip(
                lanes, *codes, grey, rows, warm, span, limits, penalties, np.float32(check_tolerance), room, *out
            )

    highest_first = sorted(only, key=lambda rows: rows[0] - rows[1])  # so that all threads end at about the same time
    in_turns(highest_first, work, max(1, VOLUME_BYTES // max(1, highest * w * n)))
