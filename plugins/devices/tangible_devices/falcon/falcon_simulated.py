"""A simulated Novint Falcon under the real driver."""

from typing import Annotated, Literal

import numpy as np
from jaxtyping import Int64
from pydantic import Field

from tangible_core.data import DeviceSpec
from tangible_core.plugins import HapticDevice, Link, Scripted

from ..paths import DRAWN, path_size, walk
from ..simulated import VirtualHand
from .calibration import Calibration
from .falcon import Falcon
from .simulator.faults import Fault

Size = Annotated[float, Field(ge=1e-3, le=0.06)]
Height = Annotated[float, Field(ge=-0.03, le=0.03)]
MAX_M = (0.05, 0.035)


class FalconSimulated(HapticDevice, Scripted):
    """A simulated Novint Falcon, byte by byte, under the real driver, which loads its firmware and homes it.

    The USB chip, the boot loader, the packets, the homing, the mass and friction of the mechanics are simulated, and a
    hand that follows a path and yields to the force. Time is simulated too: it runs as fast as it can be computed.
    Every `open` gives a new Falcon.
    """

    driver: Falcon = Falcon()
    """Options of the driver, the same as those of `falcon`; without firmware, a synthetic one is used."""
    path: Literal["raster", "circle", "spiral", "press"] = "raster"
    """Path of the hand, over the surface or straight down and up."""
    size_m: tuple[Size, Size] | None = None
    """Width and length of raster, circle and spiral, which are centred; null: 50 x 35 mm, or three quarters of
    a smaller surface."""
    lines: Annotated[int, Field(ge=2, le=200)] = 8
    """Number of lines of the raster, or turns of the spiral."""
    z_m: Height = -0.005
    """Height of the path above the base plane; the lowest point of `press`."""
    lift_m: Height = 0.02
    """Height at which the hand starts."""
    speed_m_per_s: Annotated[float, Field(ge=1e-4, le=1)] = 0.08
    """Speed along the path."""
    hand: VirtualHand = VirtualHand()
    """The hand on the grip; its mass adds to the device's."""
    faults: tuple[Fault, ...] = ()
    """Faults to inject, and when."""
    real_time: bool = False
    """Run in real time instead of simulated time."""

    def spec(self) -> DeviceSpec:
        """Return the limits of device falcon, marked as simulated."""
        return (self.driver.calibration or Calibration()).spec(simulated=True)

    def over(self, extent_m: tuple[float, float]) -> "FalconSimulated":
        """Return the device with its path within this width and length, unless it has a `size_m`."""
        return self if self.size_m else self.model_copy(update={"size_m": path_size(extent_m, MAX_M)})

    def wanted(self, ticks: Int64[np.ndarray, " n"]) -> None:
        """Return None, as the path begins when the device is homed, at a tick that is not known before."""

    def open(self) -> Link:
        """Open a new Falcon: its firmware is loaded, and the hand homes it. Raises: DeviceError as device falcon."""
        from .opening import open_falcon
        from .simulator.bus import Bus
        from .simulator.chip import RealClock, SimulatedClock
        from .simulator.falcons import simulated_falcon, synthetic_image

        clock = RealClock() if self.real_time else SimulatedClock()
        points = DRAWN[self.path](self.size_m or MAX_M, self.lines, self.z_m, self.lift_m)
        unit = simulated_falcon(clock, walk(points, self.speed_m_per_s, 0.001), self.lift_m, self.hand)
        image = self.driver.image() or synthetic_image()
        return open_falcon(self.driver.settings(), image, Bus([unit], self.faults), clock)
