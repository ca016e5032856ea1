"""The figures of a Falcon that no source is sure of or that differ between devices, and the options to open it by."""

import math
from dataclasses import dataclass
from typing import Annotated, ClassVar, Literal, Self

import numpy as np
from jaxtyping import Float64
from pydantic import BaseModel, ConfigDict, Field, model_validator

from tangible_core.data import DeviceSpec

from ..device_calibrations import load_calibration

Axis = Literal["x", "-x", "y", "-y", "z", "-z"]
Angle = Annotated[float, Field(ge=-90, le=90)]
Gain = Annotated[float, Field(ge=0.1, le=10)]
CENTRE_M = 0.125  # the workspace's origin on the device's axis: the middle of its reach
LEVER_M = 0.0672
"""Torque of the busiest motor, N m, for a force of 1 N in the least favourable direction, at the centre."""
# The greatest torque that is sent; the greatest force, as in CHAI3D's table of devices.
MAX_COUNTS, MAX_N = 4095, 8.0


class Calibration(BaseModel):
    """The conversion of counts to angles, of newtons to counts, and of the device's axes to the workspace's."""

    model_config: ClassVar[ConfigDict] = ConfigDict(frozen=True, extra="forbid", use_attribute_docstrings=True)

    encoder_offset_deg: tuple[Angle, Angle, Angle] = (35.0, 35.0, 35.0)
    """Angles of the arms (top, right, left) at encoder count 0; about 35 according to the source."""
    counts_per_newton_metre: Annotated[float, Field(ge=100, le=100_000)] = 10_000.0
    """Motor counts for a torque of 1 N m. Uncertain by a factor of two: the default was found by trial, while traces of
    the original driver suggest 5000, with half the force."""
    motor_gain: tuple[Gain, Gain, Gain] = (1.0, 1.0, 1.0)
    """Gain of each motor (top, right, left), for motors that differ."""
    axes: tuple[Axis, Axis, Axis] = ("x", "-z", "y")
    """Device axes that are the workspace's x (right), y (away from the user) and z (up). The device's own axes are
    assumed to be x right, y up, z towards the user; no source states them."""

    @model_validator(mode="after")
    def _agrees(self) -> Self:
        if {axis[-1] for axis in self.axes} != set("xyz"):
            raise ValueError(f"axes {', '.join(self.axes)} name an axis twice; name each of x, y and z once")
        return self

    def arms(self) -> Float64[np.ndarray, "3 2"]:
        """Return each arm's angle at 0 counts in radians, and its counts of torque per newton metre."""
        counts = self.counts_per_newton_metre * np.array(self.motor_gain)
        return np.column_stack([np.radians(self.encoder_offset_deg), counts])

    def frame(self) -> Float64[np.ndarray, "3 4"]:
        """Return the transform of positions in metres: workspace = frame[:, :3] @ device + frame[:, 3]."""
        turn = np.array(
            [[(axis[-1] == letter) * (-1.0 if axis[0] == "-" else 1.0) for letter in "xyz"] for axis in self.axes]
        )
        return np.column_stack([turn, -turn @ (0.0, 0.0, CENTRE_M)])

    def spec(self, simulated: bool = False) -> DeviceSpec:
        """Return a Falcon's limits, as in CHAI3D's table; the force is what the motors can give in every direction."""
        greatest_n = MAX_COUNTS / (LEVER_M * self.counts_per_newton_metre * max(self.motor_gain))
        return DeviceSpec(
            max_force_n=min(MAX_N, math.floor(100 * greatest_n) / 100),
            max_stiffness_n_per_m=3000.0,
            damping_n_s_per_m=20.0,
            workspace_m=(0.08, 0.08, 0.08),
            resolution_m=6e-5,
            buttons=4,
            simulated=simulated,
        )


@dataclass(frozen=True)
class Settings:
    """The options of `Falcon` by which it is opened and driven, with the same names."""

    serial: str | None
    index: int
    calibration: Calibration | None
    home_within_s: float
    leds: bool
    velocity_samples: int
    in_flight: int
    event_character: bool

    def find_calibration(self, serial: str) -> Calibration:
        """Return the option, else the calibration saved for this serial number, else the defaults."""
        return self.calibration or load_calibration("falcon", serial, Calibration) or Calibration()
