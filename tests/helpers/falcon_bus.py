"""Simulated Falcons for the tests, on lines with faults."""

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np

from tangible_devices.falcon.falcon import Falcon
from tangible_devices.falcon.link import FalconLink
from tangible_devices.falcon.opening import open_falcon
from tangible_devices.falcon.simulator.body import Body
from tangible_devices.falcon.simulator.bus import Bus, Unit
from tangible_devices.falcon.simulator.chip import Chip, SimulatedClock
from tangible_devices.falcon.simulator.falcons import simulated_falcon, synthetic_image
from tangible_devices.falcon.simulator.faults import Fault
from tangible_devices.falcon.simulator.processor import Processor
from tangible_devices.falcon.usb.port import Port, open_port
from tangible_devices.paths import press, walk
from tangible_devices.simulated import VirtualHand


class StillHand:
    """A hand that holds the grip still."""

    buttons = 0

    def wants(self, tip_m: np.ndarray, homing: bool, homed: bool) -> np.ndarray:
        return np.array([0.0, 0.0, 0.125])


class Line:
    """The faults of a line: damage to the byte at this place from the processor, once unless `again`; late replies."""

    def __init__(
        self, damage: str = "", at: int = 0, again: bool = False, late_reply: int = -1, swallowed: int = 0
    ) -> None:
        self.damage, self.at, self.again, self.late_reply = damage, at, again, late_reply
        self.swallowed = swallowed
        self.resets = 0
        self._sent_bytes = 0

    def spoil(self, sent: int, data: bytes) -> bytes:
        if data.endswith(b"\x0aD,\x0d"):
            self.resets += 1
            self._sent_bytes = 0
        at = self.at - self._sent_bytes
        self._sent_bytes += len(data)
        if not self.damage or not 0 <= at < len(data):
            return data
        changed = {"flip": bytes([data[at] ^ 0x10]), "drop": b"", "double": data[at : at + 1] * 2}[self.damage]
        self.damage = self.damage if self.again else ""
        return data[:at] + changed + data[at + 1 :]

    def delay(self, replies: int) -> float:
        return 0.3 if replies == self.late_reply else 0.0


def bus_of(line: Line) -> Bus:
    """Return a bus with one Falcon on this line, held still."""
    processor = Processor(Body(StillHand(), np.array([0.3, 1.0, 0.4, 300.0, 6.0])), line.swallowed)
    return Bus([Unit(Chip(processor, SimulatedClock(), line.spoil, line.delay))])


def opener_of(bus: Bus) -> Callable[[], Port]:
    """Return a function that opens the first Falcon of a bus."""
    return partial(open_port, None, 0, bus)


def held_bus(serials: tuple[str, ...] = ("SIM0001",), faults: tuple[Fault, ...] = ()) -> tuple[Bus, SimulatedClock]:
    """Return a bus with Falcons, each held by a hand that homes it, and its clock."""
    clock = SimulatedClock()
    stroke = walk(press((0.05, 0.035), 2, -0.005, 0.02), 0.08, 0.001)
    return Bus([simulated_falcon(clock, stroke, 0.02, VirtualHand(), serial) for serial in serials], faults), clock


def open_on(bus: Bus, clock: SimulatedClock, **options: Any) -> FalconLink:
    """Open the first Falcon of a bus by the driver, with these options."""
    return open_falcon(Falcon(**options).settings(), synthetic_image(), bus, clock)
