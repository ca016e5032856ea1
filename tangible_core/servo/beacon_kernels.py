"""A beacon's tick, compiled; `beacon` describes its pull. Imports numba.

The pull is added to the law's force in the guard, through the guard's memory. Its potential has a separate account
there: the energy that the hand receives on the way to the part is not a debt of the loop, and the energy that it gives
on the way back is not a credit of the force law. What sampling adds is observed like any other energy.
"""

# pyright: basic

import numpy as np
from numba import float32, float64, int64, types

from ..compiled.compiling import KERNEL, inner, njit
from ..data.ticks import BEACON_SHIFT, TickFlag
from . import beacon as at
from .guard import layout
from .guard.coupling import FASTEST_M_PER_S, WRITTEN
from .guard.vectors import clip

INTEGERS, FIELD = types.Array(int64, 1, "C"), types.Array(float32, 1, "C", readonly=True)
FLAG, SHIFT = int(TickFlag.BEACON), BEACON_SHIFT


@inner(forceinline=True)
def _weights(t):
    """Return the three quadratic B-splines at t in -0.5..0.5 of the middle one, and their slopes."""
    near, far = 0.5 - t, 0.5 + t
    return 0.5 * near * near, 0.75 - t * t, 0.5 * far * far, -near, -2.0 * t, far


@inner(forceinline=True)
def _node(u, count):
    """Return the nearest inner node, the distance to it, and 1, or 0 beyond the outer nodes."""
    node = min(max(int(np.rint(min(max(u, 0.0), float(count)))), 1), count - 2)
    t = u - node
    return (node, t, 1.0) if -0.5 <= t <= 0.5 else (node, 0.5 if t > 0.0 else -0.5, 0.0)


@njit(types.UniTuple(float64, 3)(INTEGERS, WRITTEN, FIELD, float64, float64), **KERNEL)
def potential(words, numbers, field, x, y):
    """Return (U, U_x, U_y) in joules and newtons at a place; zeros if the grid does not fit the memory."""
    rows, columns = words[at.ROWS], words[at.COLUMNS]
    if rows < 3 or columns < 3 or rows > field.size or columns > field.size or rows * columns > field.size:
        return 0.0, 0.0, 0.0
    j, across, within_x = _node((x - numbers[at.LEFT_M]) / numbers[at.ACROSS_M], columns)
    i, down, within_y = _node((numbers[at.FAR_M] - y) / numbers[at.DOWN_M], rows)
    a, b, c, da, db, dc = _weights(across)
    left, middle, right = _weights(down)[:3]
    far_slope, own_slope, near_slope = _weights(down)[3:]
    u, ux, uy = 0.0, 0.0, 0.0
    for row, weight, slope in ((i - 1, left, far_slope), (i, middle, own_slope), (i + 1, right, near_slope)):
        first = row * columns + j - 1
        p, q, r = np.float64(field[first]), np.float64(field[first + 1]), np.float64(field[first + 2])
        value = a * p + b * q + c * r
        u += weight * value
        ux += weight * (da * p + db * q + dc * r)
        uy += slope * value
    return u, within_x * ux / numbers[at.ACROSS_M], -within_y * uy / numbers[at.DOWN_M]


@inner(forceinline=True)
def _is_on(words, presses):
    """Return True if a beacon acts in this tick; a button that was pressed just now ends the request."""
    request = words[at.ASKED]
    if request == 0 or request == words[at.LET_GO]:
        words[at.SEEN] = 0
        return False
    if presses & words[at.BUTTONS]:
        words[at.LET_GO], words[at.WHY], words[at.SEEN] = request, at.BY_BUTTON, 0
        return False
    return True


@inner(forceinline=True)
def _settle(numbers, memory, x, y, u, elapsed_s):
    """Take the work of the pull on the way to this place out of the loop's account; a jump does not count as a way."""
    dx, dy = x - numbers[at.X_M], y - numbers[at.Y_M]
    if dx * dx + dy * dy <= (FASTEST_M_PER_S * elapsed_s) ** 2:
        share = numbers[at.RAMP] * memory[layout.RAMP] * memory[layout.GAIN]
        memory[layout.ENERGY_J] += share * (numbers[at.U_J] - u)
    numbers[at.X_M], numbers[at.Y_M], numbers[at.U_J] = x, y, u


@njit(int64(INTEGERS, WRITTEN, FIELD, WRITTEN, *[float64] * 5, int64), **KERNEL)
def pull(words, numbers, field, memory, period_s, x, y, vx, vy, buttons):
    """Write the beacon's force at a fresh position into the guard's memory, before the guard; return the flags."""
    presses = buttons & ~words[at.HELD]
    words[at.HELD] = buttons
    memory[layout.PULL] = memory[layout.PULL + 1] = memory[layout.PULL_STIFFNESS] = 0.0
    if not _is_on(words, presses):
        return 0
    words[at.TICKS] += 1
    flags = FLAG | words[at.PART] << SHIFT
    if words[at.SEEN] != words[at.ASKED]:  # its grid is read from the next tick on, when it is certainly complete
        words[at.SEEN] = words[at.ASKED]
        numbers[at.RAMP], numbers[at.X_M] = 0.0, np.nan
        return flags
    if not np.isfinite(x + y + vx + vy) or not 0.0 < period_s < np.inf:
        numbers[at.X_M] = np.nan
        return flags
    u, ux, uy = potential(words, numbers, field, x, y)
    if not np.isfinite(u + ux + uy):
        return flags
    _settle(numbers, memory, x, y, u, period_s)
    numbers[at.RAMP] = share = min(numbers[at.RAMP] + period_s / at.RAMP_S, 1.0)
    steep = np.sqrt(ux * ux + uy * uy)
    brake = at.DAMPING_N_S_PER_M * min(steep / (at.BRAKED_FROM * at.PULL_N), 1.0)
    bx, by, _, _ = clip(brake * vx, brake * vy, 0.0, at.MAX_N - at.PULL_N)
    fx, fy, _, _ = clip(-share * (ux + bx), -share * (uy + by), 0.0, at.MAX_N)
    memory[layout.PULL], memory[layout.PULL + 1] = fx, fy
    memory[layout.PULL_STIFFNESS] = share * at.STIFFNESS_N_PER_M
    return flags
