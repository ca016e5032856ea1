"""Parts on a grid whose cells have a size in metres, independent of the picture's pixels."""

from math import ceil, log2
from typing import NamedTuple

import numpy as np

from tangible_core.data import PartMap
from tangible_core.errors import GeometryError
from tangible_core.parts import reduced_parts

FINEST_M, COARSEST_M = 0.0625e-3, 0.25e-3  # a finger does not notice a tenth of a millimetre
MAX_CELLS, MAX_COARSE_CELLS = 2560, 1280  # along a side, which has larger cells if it is longer


class Grid(NamedTuple):
    """Parts on a grid of square cells, and the side of a cell in metres."""

    parts: PartMap
    pitch_m: float


def on_grid(parts: PartMap, width_m: float, *, worked: bool = False) -> Grid:
    """Return the parts on a grid of cells between FINEST_M and COARSEST_M; unchanged if their pixels are."""
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
