"""The Novint Falcon's USB: what an exchange costs, and the rate."""

import sys
from array import array
from collections.abc import Iterator
from time import thread_time
from types import SimpleNamespace
from typing import Any, final

import numpy as np
import usb.core

from tangible_core.data import NO_FORCE, Force
from tangible_devices.falcon.calibration import Calibration
from tangible_devices.falcon.link import FalconLink
from tangible_devices.falcon.simulator import bus as simulated
from tangible_devices.falcon.usb.port import IN, OUT, Port

from .figures import Figure, part
from .tests_path import falcon_bus

CYCLES = 1_000_000


def figures() -> Iterator[Figure]:
    """Yield the figures that go over USB."""
    yield from part("exchange", lambda: list(_exchange()))
    yield part("rate", _rate)


@final
class Nothing:
    """A Falcon of no cost: takes every packet, and has an answer for every read."""

    def __init__(self, answer: bytes) -> None:
        self._answer = array("B", answer)

    def __getattr__(self, name: str) -> Any:
        return lambda *_: None

    def get_device_descriptor(self, dev: Any) -> Any:
        """Of a Falcon."""
        return SimpleNamespace(**simulated.DEVICE, address=5)

    def get_configuration_descriptor(self, dev: Any, config: int) -> Any:
        """Of a Falcon."""
        return SimpleNamespace(**simulated.CONFIGURATION)

    def get_interface_descriptor(self, dev: Any, intf: int, alt: int, config: int) -> Any:
        """Of a Falcon."""
        if intf or alt:
            raise IndexError
        return SimpleNamespace(**simulated.PORT)

    def get_endpoint_descriptor(self, dev: Any, ep: int, intf: int, alt: int, config: int) -> Any:
        """Of a Falcon."""
        return SimpleNamespace(**simulated.ENDPOINT, bEndpointAddress=(IN, OUT)[ep])

    def get_configuration(self, dev_handle: Any) -> int:
        """Accept the configuration."""
        return 1

    def bulk_write(self, dev_handle: Any, ep: int, intf: int, data: array, timeout: int) -> int:
        """Taken."""
        return len(data)

    def bulk_read(self, dev_handle: Any, ep: int, intf: int, buff: array, timeout: int) -> int:
        """Give the answer of the device."""
        buff[:18] = self._answer
        return 18


def _exchange() -> Iterator[Figure]:
    times = iter(range(10**9))
    port = Port(usb.core.Device(object(), Nothing(b"\1\x60<AAAAAAAAAAAA\xb1A>")), "nothing")
    calibration = Calibration()
    link = FalconLink(port, calibration.arms(), calibration.frame(), 6.0, lambda: next(times) * 1e-3)
    force = Force(0.5, -0.25, 1.0)
    costs = np.empty(CYCLES)
    for i in range(CYCLES):
        if i == 10_000:
            before = sys.getallocatedblocks()
        start = thread_time()
        link.write(force)
        link.read()
        costs[i] = thread_time() - start
    grown = sys.getallocatedblocks() - before
    half, most = 1e6 * np.percentile(costs, (50, 99))
    link.exchange()
    yield Figure(
        "exchange over a backend of no cost: write and read",
        "p50 <= 60 us",
        f"{half:.1f} us, p99 {most:.1f}",
        half <= 60,
    )
    yield Figure("the same: blocks of memory more after 1e6 cycles", "none", f"{grown}", abs(grown) < 1000)
    costs = costs[:100_000]
    for i in range(len(costs)):
        start = thread_time()
        link.exchange()
        costs[i] = thread_time() - start
    half = 1e6 * np.median(costs)
    yield Figure("`exchange` alone, for a compiled tick", "p50 <= 60 us", f"{half:.1f} us", half <= 60)


def _rate() -> Figure:
    told = []
    for in_flight, event in ((1, False), (2, False), (1, True)):
        bus, clock = falcon_bus.held_bus()
        with falcon_bus.open_on(bus, clock, in_flight=in_flight, event_character=event) as link:
            times = [(link.write(NO_FORCE), link.read().time_s)[1] for _ in range(500)]
        told.append(1 / float(np.median(np.diff(times))))
    words = f"{told[1]:.0f} Hz with two packets on their way, {told[0]:.0f} with one, {told[2]:.0f} with one and `>`"
    return Figure("rate that the simulated USB allows", "1000 Hz", words, told[1] >= 999)
