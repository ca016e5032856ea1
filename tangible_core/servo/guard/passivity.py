"""The passivity observer and controller (Hannaford & Ryu 2002), compiled; docs/safety.md says what holds them in.

Imports numba.
"""

# ruff: noqa: ANN001, ANN201, ANN202 -- the types are those that numba infers
# pyright: basic

from ...compiled.compiling import inner
from . import layout as at
from .vectors import shortened

FASTEST_M_PER_S, SLOWEST_M_PER_S = 10.0, 1e-5
"""No hand is faster: a greater step is a fault of the sensor, and no work. A slower one is the sensor's noise."""


@inner(forceinline=True)
def _observe(settings, memory, elapsed_s, x, y, z):
    """The passivity observer: the force held over the way to here did F.dx on the hand, exactly."""
    slot = at.HELD + 3 * int(memory[at.SLOT])
    dx, dy, dz = x - memory[at.PLACE], y - memory[at.PLACE + 1], z - memory[at.PLACE + 2]
    way = dx * dx + dy * dy + dz * dz
    if way <= (FASTEST_M_PER_S * elapsed_s) ** 2:
        work = memory[slot] * dx + memory[slot + 1] * dy + memory[slot + 2] * dz
        memory[at.ENERGY_J] = max(
            memory[at.ENERGY_J] - work + settings[at.CREDIT] * way / elapsed_s, -settings[at.MOST_DEBT_J]
        )
    memory[at.PLACE], memory[at.PLACE + 1], memory[at.PLACE + 2] = x, y, z


@inner(forceinline=True)
def _brake(settings, memory, elapsed_s, vx, vy, vz, fx, fy, fz):
    """The passivity controller's damping: alpha = -E / (T v^2) where E, with this tick foreseen, is below 0."""
    v2 = vx * vx + vy * vy + vz * vz
    if not SLOWEST_M_PER_S**2 < v2 < FASTEST_M_PER_S**2:
        return 0.0
    share = memory[at.SOFTNESS]  # the pull of a beacon has an account of its own
    fx, fy = fx - share * memory[at.PULL], fy - share * memory[at.PULL + 1]
    owed = (fx * vx + fy * vy + fz * vz - settings[at.CREDIT] * v2) * elapsed_s - memory[at.ENERGY_J]
    return min(owed / (elapsed_s * v2), settings[at.BRAKE]) if owed > 0.0 else 0.0


@inner(forceinline=True)
def passive(settings, memory, elapsed_s, touching, x, y, z, vx, vy, vz, fx, fy, fz):
    """The force, braked where the loop would give away more than it took in, and whether it was."""
    _observe(settings, memory, elapsed_s, x, y, z)
    if not touching and memory[at.FORCE] == 0.0 and memory[at.FORCE + 1] == 0.0 and memory[at.FORCE + 2] == 0.0:
        memory[at.ENERGY_J] = min(memory[at.ENERGY_J], 0.0)
        return fx, fy, fz, False
    brake = _brake(settings, memory, elapsed_s, vx, vy, vz, fx, fy, fz)
    if brake <= 0.0:
        return fx, fy, fz, False
    fx, fy, fz, _ = shortened(fx - brake * vx, fy - brake * vy, fz - brake * vz, settings[at.MAX_FORCE_N])
    return fx, fy, fz, True
