"""Parts on a grid whose cells have a size in metres, independent of the picture's pixels."""

from math import ceil, log2
from typing import NamedTuple

import numpy as np

from tangible_core.data import PartMap
from tangible_core.errors import GeometryError
from tangible_core.parts import reduced_parts

FINEST_M, COARSEST_M = 0.0625e-3, 0.25e-3
"""Smallest and largest side of a cell: a finger does not notice a tenth of a millimetre."""
MAX_CELLS, MAX_COARSE_CELLS = 2560, 1280
"""Limit of the number of smallest and of largest cells along a side; a longer side has larger cells."""


class Grid(NamedTuple):
    """Parts on a grid of square cells, and the side of a cell in metres."""

    parts: PartMap
    pitch_m: float


def on_grid(parts: PartMap, width_m: float, *, worked: bool = False) -> Grid:
    """Return the parts on a grid of cells between FINEST_M and COARSEST_M; unchanged if their pixels are.

    Larger pixels are divided by a power of two, so that nothing moves; smaller ones are sampled at every second,
    fourth, ... pixel. A picture enlarged twofold has the same cells, or twice as many.
    worked: at least half of the coarsest cells, on which parts are changed in a short time.
    Raises: GeometryError if width_m is not positive.
    """
    if not 0 < width_m < np.inf:
        raise GeometryError(f"width_m must be a positive length in metres, not {width_m}")
    rows, columns = parts.labels.shape
    pitch_m, longest_m = width_m / columns, width_m * max(1, rows / columns)
    coarsest_m = max(COARSEST_M, longest_m / MAX_COARSE_CELLS)
    finest_m = coarsest_m / 2 if worked else min(coarsest_m / 2, max(FINEST_M, longest_m / MAX_CELLS))
    if pitch_m > coarsest_m:
        times = 2 ** ceil(log2(pitch_m / coarsest_m))
        return Grid(PartMap(parts.labels.repeat(times, 0).repeat(times, 1), parts.segments), pitch_m / times)
    if pitch_m < finest_m:
        step = 2 ** ceil(log2(finest_m / pitch_m))
        return Grid(reduced_parts(parts, (ceil(rows / step), ceil(columns / step))), pitch_m * step)
    return Grid(parts, pitch_m)
