"""Arms, motors, encoders and grip of a simulated Falcon, and their motion, compiled, so imported in verbs."""

import math
from typing import Protocol, final

import numpy as np
from numba import float64, int64, void

from tangible_core.compiled import KERNEL, njit

from ..kernels.kinematics import CENTRE_M, force, inverse, jacobian

PERIOD_S, STEPS = 0.001, 8
OFFSET_RAD, RAD_PER_COUNT = math.radians(35.0), math.radians(360 / 1280 * 0.01425 / 0.110)
# Angles for homing: an arm has found its zero after it was beyond the first, and then beyond the second.
OUT_RAD, IN_RAD = math.radians(60.0), math.radians(-8.0)
UNHOMED = (1034, -517, 78)  # offsets of the encoders before homing
HOMED = (0x10, 0x20, 0x40)
REACH_M = 0.055  # radius of the ball about the centre to which the mechanics are limited


@njit(void(float64[::1], float64[::1], float64[::1], float64[::1], int64, float64), **KERNEL)
def move(tip, torque, target, feel, steps, period_s):
    """Move tip (position and velocity, 6 numbers) on by a period; feel: mass, friction, stiffness and damping."""
    # Semi-implicit: velocity first, Coulomb friction last and never beyond rest, so that it cannot drive the tip.
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
        share = max(1.0 - step_s * coulomb / (mass_kg * speed), 0.0) if speed > 0.0 else 0.0
        away, outward = 0.0, 0.0
        for i in range(3):
            tip[3 + i] *= share
            tip[i] += step_s * tip[3 + i]
            from_centre = tip[i] - (CENTRE_M if i == 2 else 0.0)
            away += from_centre * from_centre
            outward += from_centre * tip[3 + i]
        if away > REACH_M * REACH_M:  # back onto the ball, and without the velocity outwards
            back = REACH_M / math.sqrt(away)
            for i in range(3):
                centre = CENTRE_M if i == 2 else 0.0
                from_centre = tip[i] - centre
                tip[i] = centre + back * from_centre
                tip[3 + i] -= max(outward, 0.0) / away * from_centre


class Holder(Protocol):
    """A hand on the grip."""

    buttons: int

    def wants(self, tip_m: np.ndarray, homing: bool, homed: bool) -> np.ndarray:
        """Return the target one period later, in the device's frame."""
        ...


@final
class Body:
    """The moving parts; they move in whole milliseconds, up to the last complete one."""

    def __init__(self, hand: Holder, feel: np.ndarray, counts_per_newton_metre: float = 10_000.0) -> None:
        self.torque_counts: tuple[int, ...] = (0, 0, 0)
        self.info: int = 0
        self.tip: np.ndarray = np.array([0.0, 0.0, 0.125, 0.0, 0.0, 0.0])
        self._hand = hand
        self._feel = feel
        self._newton_metres = -1.0 / counts_per_newton_metre
        self._arms_out, self._home_bits = 0, 0
        self._moved_s = 0.0

    def let_go(self) -> None:
        """Reset torques, lights and homing."""
        self.torque_counts, self.info, self._arms_out, self._home_bits = (0, 0, 0), 0, 0, 0

    def obey(self, torque_counts: tuple[int, ...], info: int, now_s: float) -> None:
        """Hold these torques from now on, and home or unhome the arms."""
        self.move_until(now_s)
        self.torque_counts, self.info = torque_counts, info
        if not info & 1:
            self._arms_out = self._home_bits = 0

    def move_until(self, now_s: float) -> None:
        """Simulate the motion under the held torques."""
        torque = self._newton_metres * np.array(self.torque_counts, np.float64)
        while self._moved_s + PERIOD_S <= now_s + 1e-9:
            target = self._hand.wants(self.tip, bool(self.info & 1), self._home_bits == sum(HOMED))
            move(self.tip, torque, target, self._feel, STEPS, PERIOD_S)
            self._moved_s += PERIOD_S
            if self.info & 1 and self._home_bits != sum(HOMED):
                self._seek()

    def report(self) -> tuple[tuple[int, ...], int]:
        """Return the encoder counts, and the byte of buttons and homed arms."""
        counts = tuple(
            round((angle - OFFSET_RAD) / RAD_PER_COUNT) - (0 if self._home_bits & bit else off)
            for angle, bit, off in zip(self._angles(), HOMED, UNHOMED, strict=True)
        )
        return counts, self._home_bits | self._hand.buttons & 15

    def _angles(self) -> tuple[float, ...]:
        return inverse(*self.tip[:3].tolist())

    def _seek(self) -> None:
        for angle, bit in zip(self._angles(), HOMED, strict=True):
            if angle > OUT_RAD:
                self._arms_out |= bit
            elif angle < IN_RAD:
                self._home_bits |= self._arms_out & bit
