"""A simulated Novint Falcon under the real driver."""

from typing import Annotated, Literal

from pydantic import Field

from tangible_core.data import DeviceSpec
from tangible_core.plugins.interfaces import HapticDevice, Link

from ..hand import VirtualHand
from ..paths import DRAWN, walk
from .calibration import Calibration
from .falcon import Falcon
from .simulator.faults import Fault

Size = Annotated[float, Field(ge=1e-3, le=0.06)]
Height = Annotated[float, Field(ge=-0.03, le=0.03)]


class FalconSimulated(HapticDevice):
    """A Novint Falcon that is not there, byte by byte: the real driver loads its firmware, homes it and feels.

    Simulated are the USB chip, the boot loader, the packets, the homing, the mass and friction of the mechanics, and a
    hand that follows a path and yields to the force. Time is simulated too: it goes on as fast as it can be computed.
    Every `open` is a Falcon of its own.
    """

    driver: Falcon = Falcon()
    """Options of the driver, as of device falcon; without firmware one is made up."""
    path: Literal["raster", "circle", "spiral", "press"] = "raster"
    """Way of the hand, over the surface or straight down and up."""
    size_m: tuple[Size, Size] = (0.05, 0.035)
    """Width and length of raster, circle and spiral, centred."""
    lines: Annotated[int, Field(ge=2, le=200)] = 8
    """Lines of the raster, turns of the spiral."""
    z_m: Height = -0.005
    """Height of the path over the base plane; the lowest point of a press."""
    lift_m: Height = 0.02
    """Where the hand comes from."""
    speed_m_per_s: Annotated[float, Field(ge=1e-4, le=1)] = 0.08
    """Along the path."""
    hand: VirtualHand = VirtualHand()
    """The hand on the grip; its mass adds to that of the mechanics."""
    faults: tuple[Fault, ...] = ()
    """What is to go wrong, and when."""
    real_time: bool = False
    """Run by the clock on the wall, to try what needs one."""

    def spec(self) -> DeviceSpec:
        """As of device falcon, but that no motor moves."""
        return (self.driver.calibration or Calibration()).spec(simulated=True)

    def open(self) -> Link:
        """A new Falcon, its firmware loaded and homed by the hand.

        Raises: DeviceError as device falcon does, where a fault or an option is the cause.
        """
        from .opening import open_falcon
        from .simulator.bus import Bus
        from .simulator.clock import RealClock, SimulatedClock
        from .simulator.falcons import simulated_falcon
        from .simulator.firmware_image import synthetic_image

        clock = RealClock() if self.real_time else SimulatedClock()
        points = DRAWN[self.path](self.size_m, self.lines, self.z_m, self.lift_m)
        unit = simulated_falcon(clock, walk(points, self.speed_m_per_s, 0.001), self.lift_m, self.hand)
        image = self.driver.image() or synthetic_image()
        return open_falcon(self.driver.settings(), image, Bus([unit], self.faults), clock)
