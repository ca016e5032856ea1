"""Simulated Falcons: the hand that homes one and follows a path, and a synthetic firmware image."""

import struct
from typing import final

import numpy as np
from jaxtyping import Float64

from ...paths import Stroke
from ...simulated import VirtualHand
from ..calibration import Calibration
from ..usb.image import KEY, RESERVED_WORDS
from .body import PERIOD_S, Body
from .bus import Unit
from .chip import Chip, SimulatedClock
from .processor import Processor

TIP_KG, VISCOUS_N_S_PER_M, COULOMB_N = 0.2, 1.0, 0.4
"""Mass and friction of the mechanics at the tip, all guessed."""
# Length in words and destination of each block; together half as long as in a real image.
IMAGE_BLOCKS = ((1821, 0x3F8002), (120, 0x3F8E3D), (168, 0x93A2), (2, 0x3F8000))
OUT_Z_M, IN_Z_M, AT_Z_M = 0.174, 0.077, 0.002
"""Positions along the device's axis to which the grip is pulled out and pushed in for homing, and their tolerance."""
SPEED_M_PER_S = 0.3  # speed of the hand during homing and on the way to the path
# Ticks of waiting above the start of the path, so that the force fades in while the tip is in free air.
PAUSE_TICKS = 1000


@final
class ScriptedHand:
    """A hand that follows the stroke once the device is homed, and presses with limited strength."""

    def __init__(
        self, stroke: Stroke, lift_m: float, frame: Float64[np.ndarray, "3 4"], reach_down_m: float, buttons: int = 0
    ) -> None:
        self.buttons = buttons
        self._stroke = stroke
        self._lift_m = lift_m
        self._turn, self._origin = frame[:, :3], frame[:, 3]
        self._reach_down_m = reach_down_m
        self._at = np.array([0.0, 0.0, 0.125])
        self._was_out = False
        self._tick: int | None = None

    def wants(self, tip_m: np.ndarray, homing: bool, homed: bool) -> Float64[np.ndarray, "3"]:
        """Return the target one period later, in the device's frame."""
        if homing and not homed:
            self._was_out = self._was_out or tip_m[2] > OUT_Z_M - AT_Z_M
            self._tick = None
            return self._towards(np.array([0.0, 0.0, IN_Z_M if self._was_out else OUT_Z_M]))
        self._was_out = False
        if self._tick is None:
            x, y, z = self._stroke.at(0)
            start = self._turn.T @ (np.array([x, y, max(z, self._lift_m)]) - self._origin)
            self._tick = -PAUSE_TICKS if np.array_equal(self._towards(start), start) else None
            return self._at
        if self._tick < 0:
            self._tick += 1
            return self._at
        self._at = self._along(self._tick, tip_m)
        self._tick += 1
        return self._at

    def _towards(self, goal: np.ndarray) -> np.ndarray:
        way = goal - self._at
        far = float(np.linalg.norm(way))
        most = SPEED_M_PER_S * PERIOD_S
        self._at = goal if far <= most else self._at + way * (most / far)
        return self._at

    def _along(self, tick: int, tip_m: np.ndarray) -> np.ndarray:
        x, y, z = self._stroke.at(tick)
        height_m = float(self._turn[2] @ tip_m[:3] + self._origin[2])
        return self._turn.T @ (np.array([x, y, max(z, height_m - self._reach_down_m)]) - self._origin)


def simulated_falcon(
    clock: SimulatedClock, stroke: Stroke, lift_m: float, hand: VirtualHand, serial: str = "SIM0001"
) -> Unit:
    """Return a Falcon without firmware, held by a hand that homes it, then starts above the path and follows it."""
    holder = ScriptedHand(stroke, lift_m, Calibration().frame(), hand.press_n / hand.stiffness_n_per_m)
    feel = (TIP_KG + hand.mass_kg, VISCOUS_N_S_PER_M, COULOMB_N, hand.stiffness_n_per_m, hand.damping_n_s_per_m)
    return Unit(Chip(Processor(Body(holder, np.array(feel))), clock), serial)


def synthetic_image(seed: int = 0) -> bytes:
    """Return the boot stream of an image with random content, in the structure of a real one."""
    numbers = np.random.default_rng(seed)
    words = [KEY, *[0] * RESERVED_WORDS, 0x003F, 0x8002]
    for length, destination in IMAGE_BLOCKS:
        words += [length, destination >> 16, destination & 0xFFFF, *numbers.integers(0, 1 << 16, length).tolist()]
    return struct.pack(f"<{len(words) + 1}H", *words, 0)
