"""How fast a surface may move under a hand."""

SPEED_M_PER_S = 0.1
"""No place of a surface moves faster: a hand does not."""
STEP_N = 0.08
"""Nor so fast that the spring on a hand at rest changes by more in a tick, which it would feel as a knock."""
