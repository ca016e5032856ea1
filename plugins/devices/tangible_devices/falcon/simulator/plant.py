"""The moving parts of a simulated Falcon, held by a hand; compiled.

Imports numba: a method imports this module inside its verb.
"""

# ruff: noqa: ANN001, ANN201 -- the types are in the signatures that numba compiles

import math

from numba import float64, int64, void

from tangible_core.compiled.compiling import KERNEL, njit

from ..kernels.kinematics import CENTRE_M, force, inverse, jacobian

REACH_M = 0.055
"""Radius of the ball about the centre to which the mechanics are limited."""


@njit(void(float64[::1], float64[::1], float64[::1], float64[::1], int64, float64), **KERNEL)
def move(tip, torque, target, feel, steps, period_s):
    """Move tip (position and velocity, 6 numbers) on by a period, in `steps` steps.

    torque: N m of the three motors; target: the hand's target; feel: mass kg, viscous friction N s/m, Coulomb friction
    N, the hand's stiffness N/m and damping N s/m.
    Semi-implicit: velocity first, friction last and never beyond rest, so that it cannot drive the tip.
    """
    mass_kg, viscous, coulomb, stiffness, damping = feel[0], feel[1], feel[2], feel[3], feel[4]
    step_s = period_s / steps
    for _ in range(steps):
        x, y, z = tip[0], tip[1], tip[2]
        pull = force(jacobian(*inverse(x, y, z), x, y, z), (torque[0], torque[1], torque[2]))
        slow = 1.0 / (1.0 + step_s * (viscous + damping) / mass_kg)
        square = 0.0
        for i in range(3):
            push = pull[i] + stiffness * (target[i] - tip[i])
            tip[3 + i] = (tip[3 + i] + step_s * push / mass_kg) * slow
            square += tip[3 + i] * tip[3 + i]
        speed = math.sqrt(square)
        left = max(1.0 - step_s * coulomb / (mass_kg * speed), 0.0) if speed > 0.0 else 0.0
        away, outward = 0.0, 0.0
        for i in range(3):
            tip[3 + i] *= left
            tip[i] += step_s * tip[3 + i]
            from_centre = tip[i] - (CENTRE_M if i == 2 else 0.0)
            away += from_centre * from_centre
            outward += from_centre * tip[3 + i]
        if away > REACH_M * REACH_M:
            back = REACH_M / math.sqrt(away)
            for i in range(3):
                centre = CENTRE_M if i == 2 else 0.0
                from_centre = tip[i] - centre
                tip[i] = centre + back * from_centre
                tip[3 + i] -= max(outward, 0.0) / away * from_centre
