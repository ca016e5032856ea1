"""What a match costs: the codes that are compared, and the penalties P1 and P2 of changes of disparity."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import UInt8

from ..dense.speckles import Specks
from .census import BITS, census, two_scale_census, with_levels


class Penalties(NamedTuple):
    """What a path pays, in differing bits."""

    p1: np.uint8
    """For a change of one disparity."""
    neutral: np.uint8
    """For a disparity that leads out of the right view, where nothing can be compared."""
    p2_by_step: UInt8[np.ndarray, "256"]
    """For any other change, by the grey step it comes with: depth breaks where the picture does."""


class Cost(NamedTuple):
    """A way of comparing two pictures."""

    name: str
    bits: int
    """Of a code: what a pixel can cost."""
    codes: Callable[[UInt8[np.ndarray, "h w"]], Any]
    penalties: Penalties
    most_level: int = 0
    """Up to what the difference of two levels counts; 0: the codes have none."""
    specks: Specks = Specks()
    """Which islands are errors."""


def p2_by_grey_step(flat: int, edge: int, slope: float) -> UInt8[np.ndarray, "256"]:
    """From `flat` where the picture is flat down to `edge`, `slope` bits cheaper for each grey level of the step."""
    return np.clip(flat - slope * np.arange(256), edge, flat).astype(np.uint8)


SHARP = Cost(
    "sharp",
    BITS,
    census,
    Penalties(np.uint8(10), np.uint8(8), p2_by_grey_step(50, 12, 1.5)),
)
"""Census of the picture as it is: the most exact on clean pictures."""
MOST_LEVEL = 4
LEVELS = Cost(
    "levels",
    BITS + MOST_LEVEL,
    with_levels,
    Penalties(np.uint8(10), np.uint8(9), p2_by_grey_step(40, 12, 2.0)),
    MOST_LEVEL,
)
"""Census and the grey levels themselves: more exact still, where both views were exposed alike."""
NOISY = Specks(among_many_px=30, alone_px=200)
LIGHT = Cost(
    "light",
    2 * BITS,
    lambda z: two_scale_census(z, 0.5, 1.5),
    Penalties(np.uint8(18), np.uint8(16), p2_by_grey_step(110, 28, 2.0)),
    specks=NOISY,
)
"""For light noise or compression."""
HEAVY = Cost(
    "heavy",
    2 * BITS,
    lambda z: two_scale_census(z, 0.7, 2.0),
    Penalties(np.uint8(22), np.uint8(16), p2_by_grey_step(120, 40, 2.0)),
    specks=NOISY,
)
"""For heavy noise."""
COSTS = {each.name: each for each in (SHARP, LEVELS, LIGHT, HEAVY)}
