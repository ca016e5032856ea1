"""The virtual coupling, compiled: the force law pushes a small tool, joined to the device by a spring and a damper.

The device then never feels more stiffness than the coupling has, whatever the force law does. Imports numba.
Source: Colgate, Stanley & Brown, Issues in the haptic display of tool use, IROS 1995; Adams & Hannaford, Stable haptic
interaction with virtual environments, IEEE Trans. Robotics and Automation 15(3), 1999.
"""

# pyright: basic

import numpy as np
from numba import float64, types

from ...compiled.compiling import KERNEL, inner, njit
from . import layout as at
from .vectors import clip, zero_or_nan

# Greatest speed of a hand. A device that jumps farther, such as a released pointer, does not drag the tool along.
FASTEST_M_PER_S = 10.0
READ, WRITTEN = types.Array(float64, 1, "C", readonly=True), types.Array(float64, 1, "C")


@inner(forceinline=True)
def _leapt(settings, memory, elapsed_s, x, y, z):
    """Return True if the device is farther from its tool than the leash plus the way of a hand in this period."""
    dx, dy, dz = memory[at.TOOL] - x, memory[at.TOOL + 1] - y, memory[at.TOOL + 2] - z
    most = settings[at.MAX_FORCE_N] / settings[at.COUPLING] + FASTEST_M_PER_S * elapsed_s
    return dx * dx + dy * dy + dz * dz > most * most


@inner(forceinline=True)
def _lead_tool(settings, memory, elapsed_s, place, velocity):
    """Move the tool by one period; return False if its new state is not finite.

    Integrates the coupling by backward Euler and the force law by forward Euler. This is stable up to a force law of
    stiffness + 2 damping / T + 4 mass / T^2, so a mass of (law's stiffness) T^2 / 2, a gram or two, leaves room for
    slopes, which are stiffer.
    """
    stiffness, damping = settings[at.COUPLING], settings[at.COUPLING_DAMPING]
    mass = 0.5 * settings[at.COUPLING_LAW] * elapsed_s * elapsed_s
    inertia = mass + elapsed_s * (damping + elapsed_s * stiffness)
    for i in range(3):
        pull = memory[at.TOOL + 6 + i] + stiffness * (place[i] - memory[at.TOOL + i]) + damping * velocity[i]
        memory[at.TOOL + 3 + i] = (mass * memory[at.TOOL + 3 + i] + elapsed_s * pull) / inertia
        memory[at.TOOL + i] += elapsed_s * memory[at.TOOL + 3 + i]
    # The leash: a pull beyond the greatest force is cut off anyway, so the tool need not move farther.
    dx, dy, dz = memory[at.TOOL] - place[0], memory[at.TOOL + 1] - place[1], memory[at.TOOL + 2] - place[2]
    dx, dy, dz, _ = clip(dx, dy, dz, settings[at.MAX_FORCE_N] / stiffness)
    memory[at.TOOL], memory[at.TOOL + 1], memory[at.TOOL + 2] = place[0] + dx, place[1] + dy, place[2] + dz
    return zero_or_nan(dx, dy, dz) + zero_or_nan(memory[at.TOOL + 3], memory[at.TOOL + 4], memory[at.TOOL + 5]) == 0.0


@njit(types.UniTuple(float64, 6)(READ, WRITTEN, *[float64] * 7), **KERNEL)
def couple(settings, memory, period_s, x, y, z, vx, vy, vz):
    """Return the state for the force law: that of the tool, or of the device if there is no coupling."""
    if settings[at.COUPLING] <= 0.0:
        return x, y, z, vx, vy, vz
    elapsed_s = memory[at.AGE_S] + period_s
    is_lost = np.isnan(memory[at.TOOL]) or _leapt(settings, memory, elapsed_s, x, y, z)
    if is_lost or not _lead_tool(settings, memory, elapsed_s, (x, y, z), (vx, vy, vz)):
        memory[at.TOOL], memory[at.TOOL + 1], memory[at.TOOL + 2] = x, y, z
        memory[at.TOOL + 3], memory[at.TOOL + 4], memory[at.TOOL + 5] = vx, vy, vz
    tool = memory[at.TOOL], memory[at.TOOL + 1], memory[at.TOOL + 2]
    return *tool, memory[at.TOOL + 3], memory[at.TOOL + 4], memory[at.TOOL + 5]


@inner(forceinline=True)
def tool_force(settings, memory, x, y, z, vx, vy, vz, fx, fy, fz):
    """Return the tool's force on the device, and store the law's force on the tool for the next `couple`."""
    memory[at.TOOL + 6], memory[at.TOOL + 7], memory[at.TOOL + 8] = fx, fy, fz
    stiffness, damping = settings[at.COUPLING], settings[at.COUPLING_DAMPING]
    px = stiffness * (memory[at.TOOL] - x) + damping * (memory[at.TOOL + 3] - vx)
    py = stiffness * (memory[at.TOOL + 1] - y) + damping * (memory[at.TOOL + 4] - vy)
    pz = stiffness * (memory[at.TOOL + 2] - z) + damping * (memory[at.TOOL + 5] - vz)
    return (px, py, pz) if zero_or_nan(px, py, pz) == 0.0 else (0.0, 0.0, 0.0)
