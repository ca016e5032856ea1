"""What passes between a force law and a device, and what a device can do.

Frame of the workspace: metres, right-handed, x right, y away from the user (the picture's top row is far), z up; its
origin is the centre of the picture on the base plane.
"""

import math
from dataclasses import dataclass
from typing import Literal, NamedTuple

Vector = tuple[float, float, float]
"""Along x, y and z."""


class Force(NamedTuple):
    """Newtons in the workspace frame, on the user's hand."""

    x: float
    y: float
    z: float


NO_FORCE = Force(0.0, 0.0, 0.0)


def limited(force: Force, most_n: float) -> Force:
    """The force, scaled down to a magnitude of most_n where it is over it; zero where it is not finite.

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
    """Where the device's tip is: metres, metres per second and seconds, in the workspace frame."""

    position_m: Vector
    velocity_m_per_s: Vector = (0.0, 0.0, 0.0)
    time_s: float = 0.0
    buttons: int = 0
    """One bit a button."""


@dataclass(frozen=True)
class DeviceSpec:
    """What a device can do, known before it is opened. Frame: workspace."""

    max_force_n: float
    max_stiffness_n_per_m: float
    """At a servo rate of 1 kHz."""
    damping_n_s_per_m: float
    workspace_m: Vector
    """Size along x, y, z."""
    resolution_m: float
    axes: int = 3
    """How many axes can give force."""
    buttons: int = 0
    simulated: bool = False
    """True if no motor moves."""


@dataclass(frozen=True)
class Unit:
    """One device that is connected now."""

    name: str
    """What it is, as its maker calls it."""
    serial: str = ""
    """What tells it from its like; a calibration belongs to it."""
    place: str = ""
    """Where it is connected."""
    problem: str = ""
    """Why it cannot be used as it is; empty if it can."""


@dataclass(frozen=True)
class Finding:
    """What one check of a device's surroundings found."""

    check: str
    verdict: Literal["fine", "failed", "not asked"]
    """`not asked` where nothing is there that could be asked."""
    says: str
    cure: str = ""
    """What to do about it, for a check that failed."""
