"""States and forces that pass between a force law and a device, and the abilities of a device.

The frame of the workspace: metres, right-handed, x right, y away from the user (the picture's top row is far), z up;
its origin is the centre of the picture on the base plane.
"""

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple

from ..errors import check_positive

Vector = tuple[float, float, float]
"""Components along x, y and z."""


class Force(NamedTuple):
    """A force on the user's hand, newtons in the workspace frame."""

    x: float
    y: float
    z: float


NO_FORCE = Force(0.0, 0.0, 0.0)


def limited(force: Force, most_n: float) -> Force:
    """Return the force, scaled down to a magnitude of at most most_n; zero if it is not finite.

    >>> limited(Force(6.0, 0.0, 8.0), 5.0)
    Force(x=3.0, y=0.0, z=4.0)
    """
    if math.hypot(*force) <= most_n:
        return force
    if not all(map(math.isfinite, force)):
        return NO_FORCE
    greatest = max(map(abs, force))  # divided by first, so that the magnitude cannot overflow
    x, y, z = (part / greatest for part in force)
    scale = most_n / math.hypot(x, y, z)
    return Force(x * scale, y * scale, z * scale)


class HapticState(NamedTuple):
    """The position, velocity and time of the device's tip: m, m/s and s, in the workspace frame."""

    position_m: Vector
    velocity_m_per_s: Vector = (0.0, 0.0, 0.0)
    time_s: float = 0.0
    buttons: int = 0
    """The pressed buttons, one bit each."""


@dataclass(frozen=True)
class DeviceSpec:
    """The abilities of a device, known before it is opened; in the workspace frame.

    Raises: ConfigError unless force, stiffness, resolution and workspace are positive and finite, and damping is finite
    and at least 0: the force loop relies on them.
    """

    max_force_n: float
    max_stiffness_n_per_m: float
    """The greatest stiffness that it renders at a loop rate of 1 kHz."""
    damping_n_s_per_m: float
    workspace_m: Vector
    """The size along x, y and z."""
    resolution_m: float
    axes: int = 3
    """The number of axes that can give force."""
    buttons: int = 0
    simulated: bool = False
    """True if no motor moves."""

    def __post_init__(self) -> None:
        for name in ("max_force_n", "max_stiffness_n_per_m", "resolution_m"):
            check_positive(f"the device's {name}", getattr(self, name))
        for size_m in self.workspace_m:
            check_positive("the device's workspace_m", size_m)
        if self.damping_n_s_per_m != 0:
            check_positive("the device's damping_n_s_per_m", self.damping_n_s_per_m)


@dataclass(frozen=True)
class Unit:
    """A device that is connected now."""

    name: str
    """The maker's name of the device."""
    serial: str = ""
    """The serial number, to which a calibration belongs; "" if the device has none."""
    place: str = ""
    """The port or address at which it is connected."""
    problem: str = ""
    """The reason why it cannot be used as it is; "" if it can."""


@dataclass(frozen=True)
class Finding:
    """The result of one check of a device's surroundings."""

    check: str
    verdict: Literal["fine", "failed", "not asked"]
    """The result; `not asked` if there is nothing to check."""
    says: str
    cure: str = ""
    """The cure for a check that failed."""
