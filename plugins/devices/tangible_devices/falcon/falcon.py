"""The Novint Falcon over USB."""

import time
from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Annotated

from pydantic import BaseModel, Field

from tangible_core.data import DeviceSpec, Finding, Unit
from tangible_core.plugins import Adjustable, HapticDevice, Link, Serviceable

from .calibration import Calibration, Settings
from .usb.image import read_image


class Falcon(HapticDevice, Serviceable, Adjustable):
    """A Novint Falcon on USB, driven from Python: firmware, homing, exact kinematics, forces that keep their sign.

    `falcon-simulated` is the same device without hardware, for tests, down to its USB packets.

    >>> from tangible import Falcon
    >>> Falcon().spec().max_force_n, Falcon().spec().axes
    (6.09, 3)

    Opening a Falcon takes as long as you need to home it: pull the grip all the way out and push it all the way in. The
    device gives no force before it is homed, and after it has lost its homing.
    """

    firmware: Path | None = None
    """Firmware image, sent if the device has none since power-on; you must supply it, such as nvent_firmware.bin."""
    serial: str | None = None
    """Serial number of the Falcon to open; null selects by `index`."""
    index: Annotated[int, Field(ge=0)] = 0
    """Number of the Falcon to open, in bus order from 0, if no serial number is given."""
    calibration: Calibration | None = None
    """Figures that differ between devices or are uncertain; null uses what `tangible devices calibrate falcon` saved
    for this device, or else the published figures."""
    home_within_s: Annotated[float, Field(gt=0, le=3600)] = 120.0
    """Time allowed for homing."""
    leds: bool = True
    """Light the LEDs: red until the device is homed, then green."""
    velocity_samples: Annotated[int, Field(ge=2, le=64)] = 16
    """Longest window for velocity estimates; it shortens while the tip moves fast."""
    in_flight: Annotated[int, Field(ge=1, le=4)] = 2
    """Packets in flight: 2 reach 1 kHz, as the USB chip delays an answer by up to a millisecond; 1 waits for each
    answer, for the shortest delay at a lower rate."""
    event_character: bool = False
    """Let the USB chip send an answer as soon as it is complete, instead of a millisecond later; some chips may not
    support it."""

    def spec(self) -> DeviceSpec:
        """Return a Falcon's limits, as in CHAI3D's table; the force is what its motors can give in every direction."""
        return self.settings().find_calibration(self.serial or "").spec()

    def open(self) -> Link:
        """Find the Falcon, load its firmware if it has none, and wait until it is homed. Raises: DeviceError."""
        from .opening import open_falcon

        return open_falcon(self.settings(), self.image(), None, time.perf_counter)

    def image(self) -> bytes | None:
        """Return the firmware, read and checked as a whole; None if no file is given. Raises: DeviceError."""
        return None if self.firmware is None else read_image(self.firmware)

    def settings(self) -> Settings:
        """Return all options but the firmware."""
        return Settings(**{name: value for name, value in self if name != "firmware"})

    def connected(self) -> tuple[Unit, ...]:
        """Return every Falcon on the bus. Raises: DeviceAbsent without libusb, DeviceError if it fails."""
        from .service import units

        return units(None)

    def examine(self) -> Iterator[Finding]:
        """Check libusb, the firmware's file, then each Falcon: permission, driver, firmware, rate."""
        from .service import findings

        return findings(self.settings(), self.firmware, None, time.perf_counter)

    def home(self, say: Callable[[str], None]) -> None:
        """Try the homing: open the Falcon, which homes it, and close it, which unhomes it. Raises: as `open`."""
        from .opening import GUIDE

        say(f"Novint Falcon: {GUIDE}")
        self.open().close()

    def calibrate(self, ask: Callable[[str], str]) -> tuple[str, BaseModel]:
        """Measure axes, zeros of the arms and strength of the motors. Raises: DeviceError as `open`, or if it fails."""
        from .service import calibrate

        return calibrate(self.settings(), self.image(), ask, None, time.perf_counter)
