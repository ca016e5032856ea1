"""Collision of the hand with the surface, and the proxy's starting point; imports numba: import it inside a verb."""

import numpy as np

from tangible_core.compiled import inner

from ..surface.bilinear import cell, over
from ..surface.spline import height

# Values in a touch's memory: 0-2 the proxy, z NaN without contact; 3-5 the last hand; 6 sliding; 7 the phase.
REMEMBERED = 8
# The phases: no valid hand; hand at the side, or entered below the rim; above the surface; in contact from above.
LOST, BESIDE, FREE, TOUCHING = 0.0, 1.0, 2.0, 3.0
# The longest step of a hand in a tick, m: after a longer one its contact starts anew.
LEAP_M = 0.005
# The distance, m, at which a proxy is released if the surface above is nearer: no desktop device holds its force.
STRETCH_M = 0.02


@inner()
def _entry(coefficients, across_per_m, down_per_m, from_x, from_y, from_z, x, y, z):
    """Return where the hand's straight way crossed the surface, within 1/64 of the way, on the outer side."""
    out, inside = 0.0, 1.0
    for _ in range(6):
        part = 0.5 * (out + inside)
        at_x, at_y = from_x + part * (x - from_x), from_y + part * (y - from_y)
        if from_z + part * (z - from_z) >= height(coefficients, across_per_m, down_per_m, at_x, at_y):
            out = part
        else:
            inside = part
    return from_x + out * (x - from_x), from_y + out * (y - from_y)


@inner(forceinline=True)
def approach(shape, tiles_m, memory, x, y, z, speed):
    """Return True if the hand is in the surface; write its phase and the proxy's starting point to the memory."""
    coefficients, width_m, length_m, across_per_m, down_per_m = shape
    phase, px, py, was_x, was_y, was_z = memory[7], memory[0], memory[1], memory[3], memory[4], memory[5]
    memory[7], memory[2], memory[3], memory[4], memory[5] = LOST, np.nan, x, y, z
    if not np.isfinite(x + y + z + speed):
        return False
    if not over(width_m, length_m, x, y):
        memory[7] = BESIDE
        memory[0] = min(max(x, -0.5 * width_m), 0.5 * width_m)
        memory[1] = min(max(y, -0.5 * length_m), 0.5 * length_m)
        return False
    row, column = cell(tiles_m.shape[0], tiles_m.shape[1], width_m, length_m, x, y)
    memory[7] = FREE
    # Bounds of a tile spare most ticks the spline: above the upper one is no contact, below the lower one a sure one.
    if z >= tiles_m[row, column, 0]:
        return False
    within = z < tiles_m[row, column, 1]
    if not (within or height(coefficients, across_per_m, down_per_m, x, y) > z):
        return False
    memory[7] = TOUCHING
    leap = (x - was_x) ** 2 + (y - was_y) ** 2 + (z - was_z) ** 2 > LEAP_M * LEAP_M
    # A hand that was beside the block came in through a side wall: the proxy stays on the wall and slides along it.
    if phase == BESIDE:
        if abs(px) >= 0.5 * width_m:
            py = y
        else:
            px = x
    # A proxy left far behind starts anew above the hand, but only if the surface above is nearer than the proxy.
    far = phase != FREE and (x - px) ** 2 + (y - py) ** 2 > STRETCH_M * STRETCH_M
    if far:
        depth = height(coefficients, across_per_m, down_per_m, x, y) - z
        far = (x - px) ** 2 + (y - py) ** 2 > depth * depth
    if phase == LOST or leap or far:
        px, py = x, y
    elif phase == FREE:
        px, py = _entry(coefficients, across_per_m, down_per_m, was_x, was_y, was_z, x, y, z)
    elif phase == BESIDE and z < height(coefficients, across_per_m, down_per_m, px, py):
        memory[7] = BESIDE
    if phase != TOUCHING or leap:
        memory[6] = 0.0
    memory[0], memory[1] = px, py
    return True
