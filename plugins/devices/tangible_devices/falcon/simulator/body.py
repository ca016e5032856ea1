"""Arms, motors, encoders and grip of a simulated Falcon."""

import math
from typing import Protocol, final

import numpy as np

from .plant import move

PERIOD_S, STEPS = 0.001, 8
OFFSET_RAD, RAD_PER_COUNT = math.radians(35.0), math.radians(360 / 1280 * 0.01425 / 0.110)
OUT_RAD, IN_RAD = math.radians(60.0), math.radians(-8.0)
"""Angles for homing: an arm has found its zero after it was beyond the first, and then beyond the second."""
UNHOMED = (1034, -517, 78)
"""Offsets of the encoders before homing."""
HOMED = (0x10, 0x20, 0x40)


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
        self._arms_out, self._homed = 0, 0
        self._moved_s = 0.0

    def let_go(self) -> None:
        """Reset torques, lights and homing."""
        self.torque_counts, self.info, self._arms_out, self._homed = (0, 0, 0), 0, 0, 0

    def obey(self, torque_counts: tuple[int, ...], info: int, now_s: float) -> None:
        """Hold these torques from now on, and home or unhome the arms."""
        self.move_until(now_s)
        self.torque_counts, self.info = torque_counts, info
        if not info & 1:
            self._arms_out = self._homed = 0

    def move_until(self, now_s: float) -> None:
        """Simulate the motion under the held torques."""
        torque = self._newton_metres * np.array(self.torque_counts, np.float64)
        while self._moved_s + PERIOD_S <= now_s + 1e-9:
            target = self._hand.wants(self.tip, bool(self.info & 1), self._homed == sum(HOMED))
            move(self.tip, torque, target, self._feel, STEPS, PERIOD_S)
            self._moved_s += PERIOD_S
            if self.info & 1 and self._homed != sum(HOMED):
                self._seek()

    def report(self) -> tuple[tuple[int, ...], int]:
        """Return the encoder counts, and the byte of buttons and homed arms."""
        counts = tuple(
            round((angle - OFFSET_RAD) / RAD_PER_COUNT) - (0 if self._homed & bit else off)
            for angle, bit, off in zip(self._angles(), HOMED, UNHOMED, strict=True)
        )
        return counts, self._homed | self._hand.buttons & 15

    def _angles(self) -> tuple[float, ...]:
        from ..kernels.kinematics import inverse

        return inverse(*self.tip[:3].tolist())

    def _seek(self) -> None:
        for angle, bit in zip(self._angles(), HOMED, strict=True):
            if angle > OUT_RAD:
                self._arms_out |= bit
            elif angle < IN_RAD:
                self._homed |= self._arms_out & bit
