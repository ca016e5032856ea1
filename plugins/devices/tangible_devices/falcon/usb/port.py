"""The USB side of a Falcon: an FTDI serial chip that is found, claimed, set up and given back. Imports pyusb."""

import logging
from array import array
from collections.abc import Generator
from contextlib import contextmanager, suppress
from typing import Any, final

import usb.core
import usb.util

from tangible_core.errors import DeviceAbsent, DeviceError

from ..kernels.framing import STATUS, USB_PACKET
from .errors import NO_LIBUSB, NO_PERMISSION, device_error, worded

log = logging.getLogger(__name__)
VENDOR, PRODUCT = 0x0403, 0xCB48
INTERFACE, IN, OUT = 0, 0x81, 0x02
READ_BYTES = 512
"""Asked for at once: whole USB packets, as less than what comes is an overflow."""
TIMEOUT_MS = 250
"""The chip sends at least its status every 16 ms, so that nothing means that it is gone; a force may stay meanwhile."""

RESET, MODEM, FLOW, BAUD, LINE, LATENCY, EVENT = 0, 1, 2, 3, 4, 9, 6
"""Requests to the chip."""
PURGE_IN, PURGE_OUT = 1, 2
BAUD_9600, BAUD_142857, BAUD_1500000 = 0x4138, 0x0015, 0x0002
"""Divisors of 3 MHz."""


@final
class Port:
    """An open chip. Every error of USB is a DeviceError that names the place and the cure."""

    def __init__(self, device: Any, place: str) -> None:
        self.place = place
        self._device = device
        self._detached = False
        self._chunk = array("B", bytes(READ_BYTES))

    def claim(self) -> None:
        """Take the interface, from the system's serial driver if that has it; configure the chip only if it is not."""
        with said(self.place, "opening it"):
            with suppress(NotImplementedError):  # only Linux has a driver to be detached
                if self._device.is_kernel_driver_active(INTERFACE):
                    self._device.detach_kernel_driver(INTERFACE)
                    self._detached = True
            if not _configured(self._device):
                self._device.set_configuration(1)
            usb.util.claim_interface(self._device, INTERFACE)

    def request(self, request: int, value: int) -> None:
        """A vendor request without data."""
        with said(self.place, "setting it up"):
            self._device.ctrl_transfer(0x40, request, value, 0, None, TIMEOUT_MS)

    def serial(self) -> str:
        """The serial number; empty where the chip has none."""
        with said(self.place, "reading its serial number"):
            try:
                return usb.util.get_string(self._device, self._device.iSerialNumber) or ""
            except ValueError:  # how pyusb says that there are no strings
                return ""

    def purge(self) -> None:
        """Forget what was received and what is to be sent."""
        self.request(RESET, PURGE_IN)
        self.request(RESET, PURGE_OUT)

    def write(self, data: array) -> None:
        """Send bytes."""
        try:
            sent = self._device.write(OUT, data, TIMEOUT_MS)
        except (usb.core.USBError, NotImplementedError) as error:
            raise device_error(error, self.place, "sending to it") from error
        if sent != len(data):
            raise DeviceError(f"{self.place}: it took {sent} of {len(data)} bytes; open it again")

    def read(self, chunk: array) -> int:
        """One IN transfer, as it comes: packets of 64 bytes, 2 of them status, the last one perhaps shorter."""
        try:
            return self._device.read(IN, chunk, TIMEOUT_MS)
        except (usb.core.USBError, NotImplementedError) as error:
            raise device_error(error, self.place, "reading from it") from error

    def payload(self) -> bytes:
        """One IN transfer without the status bytes; nothing if the chip had nothing for us."""
        chunk = self._chunk[: self.read(self._chunk)].tobytes()
        return b"".join(chunk[at + STATUS : at + USB_PACKET] for at in range(0, len(chunk), USB_PACKET))

    def close(self) -> None:
        """Give the interface back, also to the system's driver; whatever fails of it is passed over."""
        failures = (usb.core.USBError, NotImplementedError)
        with suppress(*failures):
            usb.util.release_interface(self._device, INTERFACE)
        if self._detached:
            with suppress(*failures):
                self._device.attach_kernel_driver(INTERFACE)
            self._detached = False
        with suppress(*failures):
            usb.util.dispose_resources(self._device)


def open_port(serial: str | None, index: int, backend: Any) -> Port:
    """The Falcon of this serial number, or the one of this index in the order of the bus.

    Raises: DeviceError if it is not there, not permitted, in use, or fails.
    """
    device, place = chosen(attached(backend), serial, index)
    port = Port(device, place)
    try:
        port.claim()
    except BaseException:
        port.close()
        raise
    return port


def attached(backend: Any) -> list[Any]:
    """Every Falcon on the bus, as pyusb's devices; nothing is opened.

    Raises: DeviceAbsent if libusb is missing, DeviceError if it fails.
    """
    with said("Novint Falcon", "looking for it"):
        try:
            return list(usb.core.find(find_all=True, backend=backend, idVendor=VENDOR, idProduct=PRODUCT) or ())
        except usb.core.NoBackendError as error:
            raise DeviceAbsent(f"Novint Falcon: {NO_LIBUSB}") from error


def serial_of(device: Any) -> str | None:
    """The serial number; None where the chip has none. Opens the device.

    Raises: DeviceError where reading it is not permitted or fails.
    """
    with said(place_of(device), "reading its serial number"):
        try:
            return device.serial_number
        except ValueError as error:  # how pyusb says that no string at all can be read
            raise worded(place_of(device), "reading its serial number", NO_PERMISSION) from error
        finally:
            usb.util.dispose_resources(device)


def place_of(device: Any) -> str:
    """How a message names a device."""
    return f"Novint Falcon (USB bus {device.bus}, address {device.address})"


def chosen(devices: list[Any], serial: str | None, index: int) -> tuple[Any, str]:
    """One of them, and how it is named. Raises: DeviceAbsent if there is none, DeviceError if not this one."""
    if not devices:
        raise DeviceAbsent(
            "Novint Falcon: none is connected; plug in its USB cable and its power supply, "
            "or use device falcon-simulated"
        )
    if serial is not None:
        serials = [serial_of(device) for device in devices]
        if serial not in serials:
            raise DeviceError(
                f"Novint Falcon: none has the serial number {serial}; connected are {', '.join(map(str, serials))}"
            )
        index = serials.index(serial)
    if index >= len(devices):
        raise DeviceError(f"Novint Falcon: index {index} does not exist, {len(devices)} are connected; count from 0")
    return devices[index], place_of(devices[index])


@contextmanager
def said(place: str, doing: str) -> Generator[None]:
    """Whatever pyusb raises in this block becomes a DeviceError."""
    try:
        yield
    except (usb.core.USBError, NotImplementedError) as error:
        raise device_error(error, place, doing) from error


def _configured(device: Any) -> bool:
    try:
        return device.get_active_configuration().bConfigurationValue == 1
    except usb.core.USBError as error:
        if error.errno is not None:
            raise
        return False  # pyusb's own way to say that there is no configuration


def run_time(port: Port, event_character: bool) -> None:
    """Set up for packets: 1.5 Mbaud, and what came is sent after 1 ms.

    With the event character the chip sends at once what ends in `>`, which is not known to work on every chip.
    """
    port.request(LATENCY, 1)
    if event_character:
        port.request(EVENT, 0x0100 | ord(">"))
    port.request(BAUD, BAUD_1500000)
    port.purge()
