"""Kinematics of a Falcon: the tip for three arm angles, and the torques for a force; compiled, so imported in verbs.

Frame: metres, z along the device's axis out to the user (0.075 in, 0.175 out), x right, y up, right-handed. Angles are
those of the three thighs, in radians. Source: Stamper, A three degree of freedom parallel manipulator with only
translational degrees of freedom, PhD thesis, University of Maryland 1997; lengths: libnifalcon, FalconGeometry.h.
"""

import math

import numpy as np
from numba import boolean, float64, types

from tangible_core.compiled import KERNEL, njit

# Stamper's a, b, c and d + e: thigh, shin parallelogram, offset of the tip's hinge, the two ends of the shin.
THIGH_M, SHIN_M, HINGE_M, ENDS_M = 0.060, 0.1025, 0.01443, 0.01125 + 0.01125
SIDEWAYS_M, RADIUS_M, SHIFT_M = -0.025, 0.0400, -0.02309  # stamper's f, r, s: the place of each arm
_TURN = np.radians(np.array([105.0, -15.0, -135.0]))
# Cosines and sines of the arms' directions: top, right, left, as seen from the front, all turned by 15 degrees.
COS, SIN = np.cos(_TURN), np.sin(_TURN)
CENTRE_M = 0.125  # z in the middle of the workspace
# Resolution of an encoder: four edges of 320 slots a turn; a drum of 14.25 mm drives the arm's sector of 110 mm.
RAD_PER_COUNT = 2 * math.pi / (4 * 320) * 0.01425 / 0.110

# Range of an arm's angle; within 50 mm of the centre the arms stay 27 degrees inside.
LOW_RAD, HIGH_RAD = math.radians(-60.0), math.radians(135.0)
STEPS, STEP_M, NEAR_M = 20, 0.010, 1e-6
"""Largest number of Newton steps; longest step; step after which the tip is found, as the remaining error is of the
order of its square."""

POINT = types.UniTuple(float64, 3)
ROWS = types.UniTuple(POINT, 3)
LEG = types.UniTuple(float64, 5)


@njit(LEG(types.int64, *[float64] * 5), **KERNEL)
def _leg(i, cos, sin, x, y, z):
    """Return the distance F by which arm i misses the tip at this angle, and its slopes along x, y, z and the angle.

    F = sqrt((u + c - a cos t)^2 + (w - a sin t)^2) - (d + e) - sqrt(b^2 - (v + f)^2), (u, v, w) the tip from the arm.
    """
    along = COS[i] * x + SIN[i] * y - RADIUS_M + HINGE_M - THIGH_M * cos
    across = COS[i] * y - SIN[i] * x - SHIFT_M + SIDEWAYS_M
    out = z - THIGH_M * sin
    far, shin = math.sqrt(along * along + out * out), math.sqrt(SHIN_M * SHIN_M - across * across)
    du, dv, dw = along / far, across / shin, out / far
    return (
        far - ENDS_M - shin,
        COS[i] * du - SIN[i] * dv,
        SIN[i] * du + COS[i] * dv,
        dw,
        THIGH_M * (sin * du - cos * dw),
    )


@njit(POINT(ROWS, POINT), **KERNEL)
def solve(rows, right):
    """Solve three linear equations by Cramer's rule; the result is not finite if there is no solution."""
    (a, b, c), (d, e, f), (g, h, i) = rows
    p, q, r = right
    ei, di, dh = e * i - f * h, d * i - f * g, d * h - e * g
    qi, qh, rd = q * i - f * r, q * h - e * r, d * r - q * g
    scale = 1.0 / (a * ei - b * di + c * dh)
    return (
        (p * ei - b * qi + c * qh) * scale,
        (a * qi - p * di + c * rd) * scale,
        (p * dh - b * rd - a * qh) * scale,
    )


@njit(types.Tuple((float64, float64, float64, boolean))(*[float64] * 6), **KERNEL)
def forward(first, second, third, x, y, z):
    """Find the tip for three angles by Newton's method; return (x, y, z, True), or the last tip and False."""
    from_x, from_y, from_z = x, y, z
    # negated comparisons, here and below: NaN has to fail them too
    if not (min(first, second, third) >= LOW_RAD and max(first, second, third) <= HIGH_RAD):
        return x, y, z, False
    cos = math.cos(first), math.cos(second), math.cos(third)
    sin = math.sin(first), math.sin(second), math.sin(third)
    for _ in range(STEPS):
        f0, x0, y0, z0, _ = _leg(0, cos[0], sin[0], x, y, z)
        f1, x1, y1, z1, _ = _leg(1, cos[1], sin[1], x, y, z)
        f2, x2, y2, z2, _ = _leg(2, cos[2], sin[2], x, y, z)
        dx, dy, dz = solve(((x0, y0, z0), (x1, y1, z1), (x2, y2, z2)), (-f0, -f1, -f2))
        square = dx * dx + dy * dy + dz * dz
        if not square < np.inf:
            break
        if square > STEP_M * STEP_M:
            shorter = STEP_M / math.sqrt(square)
            dx, dy, dz = shorter * dx, shorter * dy, shorter * dz
        x, y, z = x + dx, y + dy, z + dz
        if square < NEAR_M * NEAR_M:
            return x, y, z, True
    return from_x, from_y, from_z, False


@njit(float64(types.int64, float64, float64, float64), **KERNEL)
def angle(i, x, y, z):
    """Return the angle of arm i for a tip; NaN if the arm does not reach it."""
    along = COS[i] * x + SIN[i] * y - RADIUS_M + HINGE_M
    across = COS[i] * y - SIN[i] * x - SHIFT_M + SIDEWAYS_M
    reach = ENDS_M + math.sqrt(SHIN_M * SHIN_M - across * across)
    square = along * along + z * z
    knee = (square + THIGH_M * THIGH_M - reach * reach) / (2.0 * THIGH_M * math.sqrt(square))
    return math.atan2(z, along) - math.acos(knee)


@njit(POINT(float64, float64, float64), **KERNEL)
def inverse(x, y, z):
    """Return the angles of the three arms for a tip; NaN for an arm that does not reach it."""
    return angle(0, x, y, z), angle(1, x, y, z), angle(2, x, y, z)


@njit(POINT(types.int64, *[float64] * 4), **KERNEL)
def _row(i, angle_rad, x, y, z):
    _, by_x, by_y, by_z, by_angle = _leg(i, math.cos(angle_rad), math.sin(angle_rad), x, y, z)
    scale = -1.0 / by_angle
    return by_x * scale, by_y * scale, by_z * scale


@njit(ROWS(*[float64] * 6), **KERNEL)
def jacobian(first, second, third, x, y, z):
    """Return d angle / d tip: a row an arm, a column an axis, rad/m, by implicit differentiation of the arm's equation.

    The last column is sin t2 / (a sin(t2 - t1)); libnifalcon has sin(t2)^2 for sin(t2) sin(t3) there, which turns
    forces by 5 degrees at the median and makes them a third too strong along the axis.
    """
    return _row(0, first, x, y, z), _row(1, second, x, y, z), _row(2, third, x, y, z)


@njit(POINT(ROWS, POINT), **KERNEL)
def torques(rows, force):
    """Return the torques in N m that give a force: J^T F with J = d tip / d angle, the inverse of these rows."""
    (a, b, c), (d, e, f), (g, h, i) = rows
    return solve(((a, d, g), (b, e, h), (c, f, i)), force)


@njit(POINT(ROWS, POINT), **KERNEL)
def force(rows, torque):
    """Return the force in newtons that three torques give: the transpose of these rows times the torques."""
    (a, b, c), (d, e, f), (g, h, i) = rows
    p, q, r = torque
    return a * p + d * q + g * r, b * p + e * q + h * r, c * p + f * q + i * r
