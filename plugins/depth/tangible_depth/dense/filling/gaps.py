"""Gaps of a disparity map, filled from the surfaces next to them: the entry to this room."""

from typing import Literal

import numpy as np
from jaxtyping import Int16, UInt8

from tangible_core.compiled import LATE_STEPS, wait_for

from ..span import UNKNOWN
from .eight_directions import fill_from_eight_directions
from .four_directions import fill_from_four_directions
from .planes import fit_planes

# The option `effort` of `semi-global`; all other methods fill as `balanced`.
Effort = Literal["balanced", "best"]


def fill_gaps(
    matches: Int16[np.ndarray, "h w"], grey: UInt8[np.ndarray, "h w"], effort: Effort = "balanced"
) -> Int16[np.ndarray, "h w"]:
    """Fill every UNKNOWN pixel of a map in sixteenths of a pixel; best: from eight directions, on planes."""
    wait_for(LATE_STEPS)
    if effort == "best":
        return fit_planes(matches, fill_from_eight_directions(matches, grey), grey)
    return fill_from_four_directions(matches, grey)


def made_up_matches() -> tuple[Int16[np.ndarray, "h w"], UInt8[np.ndarray, "h w"]]:
    """Return a small map with gaps, and a left view that is read-only as that of a `Pair`: kernels depend on it."""
    rows, columns = np.indices((64, 96))
    gaps = (rows // 5 + columns // 7) % 3 == 0
    grey = (rows + columns).astype(np.uint8)
    grey.flags.writeable = False
    return np.where(gaps, UNKNOWN, 16 + columns // 20 * 32).astype(np.int16), grey
