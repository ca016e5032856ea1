"""The spring and the damper between a hand and its proxy; imports numba: import it inside a verb."""

import numpy as np
from numba import float32, float64, types

from tangible_core.compiled import inner

from ..surface.bilinear import HEIGHTS, cell
from ..surface.spline import prefetch
from .approach import BESIDE, approach
from .closest import settle

SURFACE = (HEIGHTS, *[float64] * 4, types.Array(float32, 3, "C", readonly=True))
MATERIALS = types.Array(float64, 2, "C", readonly=True)
# The numba types of a touch's memory; SURFACE and MATERIALS are those of the other arguments of a kernel.
MEMORY = float64[::1]


@inner(forceinline=True)
def spring(shape, tiles_m, stiffness, memory, x, y, z, vx, vy, vz):
    """Compute F = k (p - q), for one material without friction and damping."""
    _, width_m, length_m, _, _ = shape
    if not approach(shape, tiles_m, memory, x, y, z, vx + vy + vz):
        return 0.0, 0.0, 0.0
    px, py, top = memory[0], memory[1], z
    row, column = cell(tiles_m.shape[0], tiles_m.shape[1], width_m, length_m, x, y)
    highest, lowest = tiles_m[row, column, 0], tiles_m[row, column, 1]
    if memory[7] == BESIDE:
        pass
    elif highest == lowest and (row, column) == cell(tiles_m.shape[0], tiles_m.shape[1], width_m, length_m, px, py):
        # In a level tile that already holds the proxy, the proxy is right above the hand.
        px, py, top = x, y, np.float64(highest)
    else:
        px, py, top, _, _, _ = settle(shape, px, py, x, y, z, 0.0, 0.0, 0.0)
        _prefetch_ahead(shape, memory, px, py)
    memory[0], memory[1], memory[2] = px, py, top
    fx, fy, fz = stiffness * (px - x), stiffness * (py - y), stiffness * (top - z)
    return (fx, fy, fz) if np.isfinite(fx + fy + fz) else (0.0, 0.0, 0.0)


@inner(forceinline=True)
def spring_and_damper(shape, tiles_m, labels, table, memory, x, y, z, vx, vy, vz):
    """Compute F = k (p - q) - b v_n n; friction holds the proxy p."""
    _, width_m, length_m, _, _ = shape
    if not approach(shape, tiles_m, memory, x, y, z, vx + vy + vz):
        return 0.0, 0.0, 0.0
    px, py, top, damper, hx, hy = memory[0], memory[1], z, 0.0, 0.0, 0.0
    row, column = cell(labels.shape[0], labels.shape[1], width_m, length_m, px, py)
    label = labels[row, column]
    stiffness, damping, static, dynamic = table[label, 0], table[label, 1], table[label, 2], table[label, 3]
    if memory[7] != BESIDE:
        px, py, top, hx, hy, memory[6] = settle(shape, px, py, x, y, z, static, dynamic, memory[6])
        _prefetch_ahead(shape, memory, px, py)
        square = 1.0 + hx * hx + hy * hy
        spring = stiffness * (hx * (x - px) + hy * (y - py) + top - z) / square
        damper = min(damping * (vz - hx * vx - hy * vy) / square, max(spring, 0.0))
    memory[0], memory[1], memory[2] = px, py, top
    fx, fy, fz = stiffness * (px - x) + damper * hx, stiffness * (py - y) + damper * hy, stiffness * (top - z) - damper
    return (fx, fy, fz) if np.isfinite(fx + fy + fz) else (0.0, 0.0, 0.0)


@inner()
def _prefetch_ahead(shape, memory, px, py):
    """Prefetch the coefficients for the tick after the next, if the proxy keeps its last step, memory to (px, py)."""
    coefficients, _, _, across_per_m, down_per_m = shape
    # For a large surface they come from main memory, which takes longer than a tick of a path.
    ahead_x, ahead_y = px + 2.0 * (px - memory[0]), py + 2.0 * (py - memory[1])
    prefetch(coefficients, across_per_m, down_per_m, ahead_x, ahead_y)
