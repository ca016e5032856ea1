"""The hand that holds a simulated Falcon: it homes the device, then follows a path."""

from typing import final

import numpy as np
from jaxtyping import Float64

from ...paths import Stroke
from .body import PERIOD_S

OUT_Z_M, IN_Z_M, AT_Z_M = 0.174, 0.077, 0.002
"""Positions along the device's axis to which the grip is pulled out and pushed in for homing, and their tolerance."""
SPEED_M_PER_S = 0.3
"""Speed of the hand during homing and on the way to the path."""
PAUSE_TICKS = 1000
"""Ticks of waiting above the start of the path, so that the force fades in while the tip is in free air."""


@final
class ScriptedHand:
    """A hand that follows the stroke once the device is homed, and presses with limited strength."""

    def __init__(
        self,
        stroke: Stroke,
        lift_m: float,
        frame: Float64[np.ndarray, "3 4"],
        reach_down_m: float,
        buttons: int = 0,
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
