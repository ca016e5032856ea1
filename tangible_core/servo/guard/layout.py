"""The layout of a guard's two arrays: indices of its settings and of its memory."""

MAX_DELAY = 8  # greatest delay of a force, ticks; the memory holds one force for each

(
    MAX_FORCE_N,
    MAX_STEP_N,
    RAMP_PER_S,
    STALE_S,
    STIFFNESS,
    STIFFNESS_TIMES_PERIOD,
    MAX_STIFFNESS,
    DELAY,
    BRAKE,
    CREDIT,
    MAX_DEBT_J,
    COUPLING,
    COUPLING_DAMPING,
    COUPLING_LAW,
    SURFACE_W,
    MAX_SURFACE_J,
    SETTINGS,
) = range(17)
"""Indices of the settings, which a guard reads; the last is their number. N/m and N s/m where the name has no unit.

STIFFNESS_TIMES_PERIOD, N s/m: divided by the period, it is the greatest stable stiffness. CREDIT: the damping whose
dissipation the loop is credited with. COUPLING: stiffness of the coupling, 0 for none; COUPLING_LAW: stiffness of the
force law behind it. SURFACE_W, MAX_SURFACE_J: limits of the work of a moving surface, as sustained power and as energy
at once.
"""

FORCE = 0  # memory: the force sent at the last tick; x, y, z from this index on
PLACE = 3  # memory: the last fresh position; x is NaN if there is none
RAMP, GAIN, MEAN_S, MEAN_S2, ENERGY_J, AGE_S, SLOT = range(6, 13)
"""Memory: factors 0..1 of fading in and of the stiffness limit; running means of the period and of its square; energy
that the loop received and may return; time without a fresh position; slot in HELD of the oldest delayed force."""
HELD = 13  # memory: the forces that are delayed on their way to the hand, or act on it
# Memory: the tool of the coupling: position, with x NaN if it has none, velocity, and the law's force on it.
TOOL = HELD + 3 * (MAX_DELAY + 1)
COUNTS = TOOL + 9  # memory: ticks with each flag of the guard, by the flag's bit
FLAGS = 8
PULL = COUNTS + FLAGS  # memory: the beacon's force along x and y, which is added to the law's
PULL_STIFFNESS = PULL + 2  # memory: the beacon's stiffness, which is added to the law's
RISE_M, LAST_RISE_M, SURFACE_FORCE_N, GIVEN_J, MAY_GIVE_J = range(PULL_STIFFNESS + 1, PULL_STIFFNESS + 6)
"""Memory of a moving surface: its rise under the proxy in this tick, which the caller of the law writes before the
guard, and in the tick before; the law's force along z as it was sent; the work that the surface did in this contact and
has not taken back, and the work that it may still do."""
MEMORY = MAY_GIVE_J + 1
