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
def rise_m(memory, elapsed_s):
    """By how much the surface rose in this tick; a number that is none, or faster than any, is no way."""
    rise = memory[at.RISE_M]
    return rise if abs(rise) <= FASTEST_M_PER_S * elapsed_s else 0.0


@inner(forceinline=True)
def _lifted(settings, memory, elapsed_s, rise):
    """Work that the surface did on the law's spring since the last tick, as far as it counts.

    The surface stands still between two ticks and moves in them, half of each way under the force of before, half under
    the one of after: for a spring that is exact. It gives what it may, and takes back no more than it gave, which it
    may give again: what a hand put into the spring and a surface that sinks lets go of is the hand's own loss.
    """
    may_j = min(memory[at.MAY_GIVE_J] + settings[at.SURFACE_W] * elapsed_s, settings[at.MOST_SURFACE_J])
    work = _counts(memory, 0.5 * memory[at.LIFT_N] * (memory[at.ROSE_M] + rise), may_j)
    memory[at.GIVEN_J] += work
    memory[at.MAY_GIVE_J] = min(may_j - work, settings[at.MOST_SURFACE_J])
    return work


@inner(forceinline=True)
def _counts(memory, work, may_j):
    return max(min(work, may_j), -memory[at.GIVEN_J])


@inner(forceinline=True)
def _observe(settings, memory, elapsed_s, rise, x, y, z):
    """The passivity observer: the force held over the way to here did F.dx on the hand, exactly.

    What the surface did on the law meanwhile is no work of the loop's own.
    """
    slot = at.HELD + 3 * int(memory[at.SLOT])
    dx, dy, dz = x - memory[at.PLACE], y - memory[at.PLACE + 1], z - memory[at.PLACE + 2]
    way = dx * dx + dy * dy + dz * dz
    if way <= (FASTEST_M_PER_S * elapsed_s) ** 2:
        work = memory[slot] * dx + memory[slot + 1] * dy + memory[slot + 2] * dz
        work -= _lifted(settings, memory, elapsed_s, rise)
        memory[at.ENERGY_J] = max(
            memory[at.ENERGY_J] - work + settings[at.CREDIT] * way / elapsed_s, -settings[at.MOST_DEBT_J]
        )
    memory[at.PLACE], memory[at.PLACE + 1], memory[at.PLACE + 2] = x, y, z


@inner(forceinline=True)
def _brake(settings, memory, elapsed_s, lifted, vx, vy, vz, fx, fy, fz):
    """The passivity controller's damping: alpha = -E / (T v^2) where E, with this tick foreseen, is below 0.

    lifted: the work that the surface does meanwhile, if it goes on as it did.
    """
    v2 = vx * vx + vy * vy + vz * vz
    if not SLOWEST_M_PER_S**2 < v2 < FASTEST_M_PER_S**2:
        return 0.0
    share = memory[at.SOFTNESS]  # the pull of a beacon has an account of its own
    fx, fy = fx - share * memory[at.PULL], fy - share * memory[at.PULL + 1]
    owed = (fx * vx + fy * vy + fz * vz - settings[at.CREDIT] * v2) * elapsed_s - lifted - memory[at.ENERGY_J]
    return min(owed / (elapsed_s * v2), settings[at.BRAKE]) if owed > 0.0 else 0.0


@inner(forceinline=True)
def passive(settings, memory, elapsed_s, touching, lift, x, y, z, vx, vy, vz, fx, fy, fz):
    """The force, braked where the loop would give away more than it took in, and whether it was.

    lift: the law's part along z of this force, by which a surface that moves does work.
    """
    rise = rise_m(memory, elapsed_s)
    _observe(settings, memory, elapsed_s, rise, x, y, z)
    if not touching and memory[at.FORCE] == 0.0 and memory[at.FORCE + 1] == 0.0 and memory[at.FORCE + 2] == 0.0:
        memory[at.ENERGY_J], memory[at.GIVEN_J] = min(memory[at.ENERGY_J], 0.0), 0.0
        return fx, fy, fz, False
    # half of this tick's way is yet to count, and the whole of the next
    lifted = _counts(memory, 1.5 * lift * rise, memory[at.MAY_GIVE_J])
    brake = _brake(settings, memory, elapsed_s, lifted, vx, vy, vz, fx, fy, fz)
    if brake <= 0.0:
        return fx, fy, fz, False
    fx, fy, fz, _ = shortened(fx - brake * vx, fy - brake * vy, fz - brake * vz, settings[at.MAX_FORCE_N])
    return fx, fy, fz, True
