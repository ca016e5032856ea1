"""Where each number stands in the two arrays of a guard."""

MOST_DELAY = 8
"""Ticks of delay that are told apart."""

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
    MOST_DEBT_J,
    COUPLING,
    COUPLING_DAMPING,
    COUPLING_LAW,
    SURFACE_W,
    MOST_SURFACE_J,
    SETTINGS,
) = range(17)
"""Settings, which a guard reads; the last is how many there are. N/m and N s/m where no unit is in the name.

STIFFNESS_TIMES_PERIOD, N s/m: divided by the period it is the stiffness held stably. CREDIT: the damping whose loss is
counted for the loop. COUPLING: its stiffness, 0 for none; COUPLING_LAW: that of the law behind it. SURFACE_W,
MOST_SURFACE_J: the work that a surface which moves may do, as a power for long and as an energy at once.
"""

FORCE = 0
"""Memory: where the force that left at the last tick begins; x, y, z."""
PLACE = 3
"""The last fresh position; x is NaN where there is none."""
RAMP, SOFTNESS, MEAN_S, MEAN_S2, ENERGY_J, AGE_S, SLOT = range(6, 13)
"""Shares of the force, 0..1; running means of the period and its square; what the loop took in and may give; the time
without a fresh position; and the place in HELD of the force that is on its way longest."""
HELD = 13
"""The forces that are on their way to the hand, or there."""
TOOL = HELD + 3 * (MOST_DELAY + 1)
"""The tool of the coupling: position, with x NaN where it has none, velocity, and the law's force on it."""
COUNTS = TOOL + 9
"""Ticks of each flag that a guard gives, by the flag's bit."""
FLAGS = 8
PULL = COUNTS + FLAGS
"""The beacon's force along x and y, which joins the law's; and its stiffness, which joins the law's as well."""
PULL_STIFFNESS = PULL + 2
RISE_M, ROSE_M, LIFT_N, GIVEN_J, MAY_GIVE_J = range(PULL_STIFFNESS + 1, PULL_STIFFNESS + 6)
"""Of a surface that moves: by how much it rose under the proxy in this tick, which whoever asks the law writes before
the guard, and in the one before; the law's force along z as it left; the work that the surface did in this contact and
has not taken back, and what it may yet do."""
MEMORY = MAY_GIVE_J + 1
"""How many numbers a guard remembers."""
