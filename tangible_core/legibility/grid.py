"""Parts on a grid whose cells have a size in metres, whatever the pixels of the picture are."""

from math import ceil, log2
from typing import NamedTuple

import numpy as np

from ..data import PartMap
from ..errors import GeometryError
from ..parts import reduced_parts

FINEST_M, COARSEST_M = 0.0625e-3, 0.25e-3
"""Cells are of a size between these: a finger tells no tenth of a millimetre."""
MOST_CELLS, MOST_COARSE_CELLS = 2560, 1280
"""A side, of the finest and of the coarsest cells: what is larger has larger cells."""


class Grid(NamedTuple):
    """Parts on such a grid, and the side of its square cells."""

    parts: PartMap
    pitch_m: float


def on_grid(parts: PartMap, width_m: float, *, worked: bool = False) -> Grid:
    """The same parts on the grid: as they are where their pixels are of such a size.

    Larger pixels are divided by a power of two, so that nothing moves, and of smaller ones each second, fourth ... is
    taken. So a picture that is enlarged twofold has the same cells, or twice as many.
    worked: cells in which parts can be changed in a short time, no smaller than half of the coarsest.
    Raises: GeometryError if width_m is not positive.
    """
    if not 0 < width_m < np.inf:
        raise GeometryError(f"width_m must be a positive length in metres, not {width_m}")
    rows, columns = parts.labels.shape
    pitch_m, longest_m = width_m / columns, width_m * max(1, rows / columns)
    coarsest_m = max(COARSEST_M, longest_m / MOST_COARSE_CELLS)
    finest_m = coarsest_m / 2 if worked else min(coarsest_m / 2, max(FINEST_M, longest_m / MOST_CELLS))
    if pitch_m > coarsest_m:
        times = 2 ** ceil(log2(pitch_m / coarsest_m))
        return Grid(PartMap(parts.labels.repeat(times, 0).repeat(times, 1), parts.segments), pitch_m / times)
    if pitch_m < finest_m:
        step = 2 ** ceil(log2(finest_m / pitch_m))
        return Grid(reduced_parts(parts, (ceil(rows / step), ceil(columns / step))), pitch_m * step)
    return Grid(parts, pitch_m)
