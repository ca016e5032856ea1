"""The passivity observer and controller, compiled; docs/explanation/safety.md has their bounds. Imports numba.

Source: Hannaford & Ryu, Time-domain passivity control of haptic interfaces, IEEE Trans. Robotics and Automation 18(1),
2002.
"""

# pyright: basic

from ...compiled.compiling import inner
from . import layout as at
from .vectors import clip

# Range of a hand's speed: a faster step is a fault of the sensor and not counted as work, a slower one its noise.
FASTEST_M_PER_S, SLOWEST_M_PER_S = 10.0, 1e-5


@inner(forceinline=True)
def rise_m(memory, elapsed_s):
    """Return the rise of the surface in this tick; 0 if it is not finite, or faster than any hand."""
    rise = memory[at.RISE_M]
    return rise if abs(rise) <= FASTEST_M_PER_S * elapsed_s else 0.0


@inner(forceinline=True)
def _surface_work(settings, memory, elapsed_s, rise):
    """Return the work that the surface did on the law's spring since the last tick, as far as it counts.

    The surface stands still between two ticks and moves in them, half of each way under the force before the tick and
    half under the force after it: for a spring this is exact. The surface does no more work than it may, and takes back
    no more than it did, which it may do again: energy that the hand put into the spring and a sinking surface releases
    is lost to the hand.
    """
    may_j = min(memory[at.MAY_GIVE_J] + settings[at.SURFACE_W] * elapsed_s, settings[at.MAX_SURFACE_J])
    work = _limit_work(memory, 0.5 * memory[at.SURFACE_FORCE_N] * (memory[at.LAST_RISE_M] + rise), may_j)
    memory[at.GIVEN_J] += work
    memory[at.MAY_GIVE_J] = min(may_j - work, settings[at.MAX_SURFACE_J])
    return work


@inner(forceinline=True)
def _limit_work(memory, work, may_j):
    return max(min(work, may_j), -memory[at.GIVEN_J])


@inner(forceinline=True)
def _observe(settings, memory, elapsed_s, rise, x, y, z):
    """Update the passivity observer: the force held on the way to this place did the work F.dx on the hand, exactly."""
    slot = at.HELD + 3 * int(memory[at.SLOT])
    dx, dy, dz = x - memory[at.PLACE], y - memory[at.PLACE + 1], z - memory[at.PLACE + 2]
    way = dx * dx + dy * dy + dz * dz
    if way <= (FASTEST_M_PER_S * elapsed_s) ** 2:
        work = memory[slot] * dx + memory[slot + 1] * dy + memory[slot + 2] * dz
        work -= _surface_work(settings, memory, elapsed_s, rise)
        memory[at.ENERGY_J] = max(
            memory[at.ENERGY_J] - work + settings[at.CREDIT] * way / elapsed_s, -settings[at.MAX_DEBT_J]
        )
    memory[at.PLACE], memory[at.PLACE + 1], memory[at.PLACE + 2] = x, y, z


@inner(forceinline=True)
def _brake(settings, memory, elapsed_s, surface_j, vx, vy, vz, fx, fy, fz):
    """Return the passivity controller's damping, alpha = -E / (T v^2) where the energy E with this tick is < 0."""
    v2 = vx * vx + vy * vy + vz * vz
    if not SLOWEST_M_PER_S**2 < v2 < FASTEST_M_PER_S**2:
        return 0.0
    share = memory[at.GAIN]  # the pull of a beacon has an account of its own
    fx, fy = fx - share * memory[at.PULL], fy - share * memory[at.PULL + 1]
    debt_j = (fx * vx + fy * vy + fz * vz - settings[at.CREDIT] * v2) * elapsed_s - surface_j - memory[at.ENERGY_J]
    return min(debt_j / (elapsed_s * v2), settings[at.BRAKE]) if debt_j > 0.0 else 0.0


@inner(forceinline=True)
def make_passive(settings, memory, elapsed_s, touching, surface_n, x, y, z, vx, vy, vz, fx, fy, fz):
    """Return the force, damped where the loop would give more energy than it received, and whether it was damped."""
    rise = rise_m(memory, elapsed_s)
    _observe(settings, memory, elapsed_s, rise, x, y, z)
    if not touching and memory[at.FORCE] == 0.0 and memory[at.FORCE + 1] == 0.0 and memory[at.FORCE + 2] == 0.0:
        memory[at.ENERGY_J], memory[at.GIVEN_J] = min(memory[at.ENERGY_J], 0.0), 0.0
        return fx, fy, fz, False
    # half of this tick's way is yet to count, and the whole of the next
    surface_j = _limit_work(memory, 1.5 * surface_n * rise, memory[at.MAY_GIVE_J])
    brake = _brake(settings, memory, elapsed_s, surface_j, vx, vy, vz, fx, fy, fz)
    if brake <= 0.0:
        return fx, fy, fz, False
    fx, fy, fz, _ = clip(fx - brake * vx, fy - brake * vy, fz - brake * vz, settings[at.MAX_FORCE_N])
    return fx, fy, fz, True
