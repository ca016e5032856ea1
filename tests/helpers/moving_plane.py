"""A film whose answer is known: a level plane on a spring, which goes evenly from one height to the next."""

import numpy as np
from numba import float64, njit, types

from tangible_core.compiled.compiling import KERNEL
from tangible_core.compiled.touch import FRAME, RISE_M, CompiledTouch
from tangible_core.data import Relief
from tangible_core.plugins.touch import Film, Touch

AT_M, GOAL_M, STEP_M, SHOWN, GOING = range(5)
"""Height, where it goes, by how much a tick, the frame that was shown last, and the one that it goes to."""
ARRAY = types.Array(float64, 1, "C")
FRAME_TICKS, MAX_M = 33, 1e-4
"""Ticks of 1 ms over which a frame moves the plane, and the most that it moves in one."""


@njit(types.UniTuple(float64, 3)(ARRAY, ARRAY, ARRAY, *[float64] * 7), **KERNEL)
def tick(plane, memory, moving, stiffness, x, y, z, vx, vy, vz):
    if plane[SHOWN] != plane[GOING]:
        plane[GOING] = plane[SHOWN]
    rise = min(max(plane[GOAL_M] - plane[AT_M], -plane[STEP_M]), plane[STEP_M])
    plane[AT_M] += rise
    top = plane[AT_M]
    moving[FRAME] = plane[GOING]
    if not z < top:
        moving[RISE_M], memory[2] = 0.0, np.nan
        return 0.0, 0.0, 0.0
    moving[RISE_M] = rise
    memory[0], memory[1], memory[2] = x, y, top
    return 0.0, 0.0, stiffness * (top - z)


class MovingPlane(Film):
    """At `height_m` until it is shown another height: that of a relief's first cell, at most at 0.1 m/s."""

    def __init__(self, height_m: float = 0.01, stiffness_n_per_m: float = 800.0) -> None:
        self.plane = np.array([height_m, height_m, 0.0, 0.0, 0.0])
        memory, moving = np.full(3, np.nan), np.zeros(2)
        fixed = self.plane, memory, moving, stiffness_n_per_m
        self._touch = CompiledTouch(tick, fixed, memory, stiffness_n_per_m, moving)
        self._dropped = 0

    @property
    def touch(self) -> Touch:
        return self._touch

    def show(self, relief: Relief, frame: int) -> None:
        self._dropped += self.plane[SHOWN] != self.plane[GOING]
        goal = float(relief.height_m[0, 0])
        self.plane[STEP_M] = min(abs(goal - self.plane[AT_M]) / FRAME_TICKS, MAX_M)
        self.plane[GOAL_M], self.plane[SHOWN] = goal, frame

    @property
    def arrived(self) -> bool:
        return bool(self.plane[AT_M] == self.plane[GOAL_M])

    @property
    def dropped(self) -> int:
        return int(self._dropped)


def level(height_m: float) -> Relief:
    """What it is shown."""
    return Relief(np.full((2, 2), height_m, np.float32), (0.08, 0.06))
