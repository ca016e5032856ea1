"""What passes between a force law and a device, and what a device can do.

Frame of the workspace: metres, right-handed, x right, y away from the user (the picture's top row is far), z up; its
origin is the centre of the picture on the base plane.
"""

from dataclasses import dataclass
from typing import Literal, NamedTuple


class Force(NamedTuple):
    """Newtons in the workspace frame, on the user's hand."""

    x: float
    y: float
    z: float


NO_FORCE = Force(0.0, 0.0, 0.0)


class HapticState(NamedTuple):
    """Where the device's tip is: metres, metres per second and seconds, in the workspace frame."""

    position_m: tuple[float, float, float]
    velocity_m_per_s: tuple[float, float, float] = (0.0, 0.0, 0.0)
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
    workspace_m: tuple[float, float, float]
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
