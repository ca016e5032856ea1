"""Matching costs: the codes that are compared, and the penalties P1 and P2 of disparity changes."""

from collections.abc import Callable
from typing import Any, NamedTuple

import numpy as np
from jaxtyping import UInt8

from ..dense.speckles import Specks
from .census import BITS, census, census_with_levels, two_scale_census


class Penalties(NamedTuple):
    """The penalties of a path, in differing bits."""

    p1: np.uint8
    neutral: np.uint8
    """Cost of a disparity that leads out of the right view, where nothing can be compared."""
    p2_by_step: UInt8[np.ndarray, "256"]
    """Penalty of any other change, by the grey step there: depth edges coincide with edges of the picture."""


class Cost(NamedTuple):
    """A way to compare two pictures."""

    name: str
    bits: int
    """Bits of a code, the most that a pixel can cost."""
    codes: Callable[[UInt8[np.ndarray, "h w"]], Any]
    penalties: Penalties
    most_level: int = 0
    """Largest value that the difference of two grey levels counts; 0 for codes without levels."""
    specks: Specks = Specks()


def p2_by_grey_step(flat: int, edge: int, slope: float) -> UInt8[np.ndarray, "256"]:
    """Return P2 by grey step: `flat` at 0, `slope` bits less per grey level, `edge` at least."""
    return np.clip(flat - slope * np.arange(256), edge, flat).astype(np.uint8)


SHARP = Cost(
    "sharp",
    BITS,
    census,
    Penalties(np.uint8(10), np.uint8(8), p2_by_grey_step(50, 12, 1.5)),
)
"""Census of the original picture: the most precise on clean pictures."""
MAX_LEVEL = 4
"""Largest value that the difference of two halved grey levels counts, in bits."""
LEVELS = Cost(
    "levels",
    BITS + MAX_LEVEL,
    census_with_levels,
    Penalties(np.uint8(10), np.uint8(9), p2_by_grey_step(40, 12, 2.0)),
    MAX_LEVEL,
)
"""Census and grey levels: more precise still, if both views have the same exposure."""
NOISY = Specks(among_many_px=30, alone_px=200)
LIGHT = Cost(
    "light",
    2 * BITS,
    lambda z: two_scale_census(z, 0.5, 1.5),
    Penalties(np.uint8(18), np.uint8(16), p2_by_grey_step(110, 28, 2.0)),
    specks=NOISY,
)
HEAVY = Cost(
    "heavy",
    2 * BITS,
    lambda z: two_scale_census(z, 0.7, 2.0),
    Penalties(np.uint8(22), np.uint8(16), p2_by_grey_step(120, 40, 2.0)),
    specks=NOISY,
)
COSTS = {cost.name: cost for cost in (SHARP, LEVELS, LIGHT, HEAVY)}
