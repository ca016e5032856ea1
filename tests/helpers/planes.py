"""Planes that are exact in floating point, and how to feel at a place."""

import numpy as np

from tangible_core.data import Force, HapticState, HapticSurface
from tangible_core.plugins.interfaces import Touch

WIDTH_M = 0.0625  # powers of two: cells, centres and slopes below are exact in floating point
UP_M = 1 / 32


def at(touch: Touch, x: float, y: float, z: float, velocity=(0.0, 0.0, 0.0)) -> Force:
    return touch.force(HapticState((x, y, z), velocity))


def tilted(slope_x: float, slope_y: float, shape: tuple[int, int] = (32, 32), width_m: float = WIDTH_M):
    """A plane, UP_M high at the origin, of square cells."""
    rows, columns = shape
    pitch = width_m / columns
    x = (np.arange(columns) + 0.5) * pitch - width_m / 2
    y = rows * pitch / 2 - (np.arange(rows) + 0.5) * pitch
    return HapticSurface.from_heights(UP_M + slope_x * x[None, :] + slope_y * y[:, None], width_m)
