"""The USB port of a Falcon: an FTDI serial chip that is found, claimed, set up and released. Imports pyusb."""

import logging
from array import array
from collections.abc import Generator
from contextlib import contextmanager, suppress
from importlib import import_module
from typing import TYPE_CHECKING, Any, final

import usb.core
import usb.util

from tangible_core.errors import DeviceAbsent, DeviceError

from ..kernels.framing import STATUS, USB_PACKET

if TYPE_CHECKING:
    Octets = array[int]
    """An array of bytes; it takes no brackets before Python 3.12."""
else:
    Octets = array

log: logging.Logger = logging.getLogger(__name__)
VENDOR, PRODUCT = 0x0403, 0xCB48
INTERFACE, IN, OUT = 0, 0x81, 0x02
# Size of a read: whole USB packets, as more data than the size is an overflow.
READ_BYTES = 512
# Time-out of a transfer: the chip sends at least its status every 16 ms. A force may stay for as long.
TIMEOUT_MS = 250

RESET, MODEM, FLOW, BAUD, LINE, LATENCY, EVENT = 0, 1, 2, 3, 4, 9, 6  # requests to the chip
PURGE_IN, PURGE_OUT = 1, 2
BAUD_9600, BAUD_142857, BAUD_1500000 = 0x4138, 0x0015, 0x0002  # divisors of 3 MHz

UDEV_FILE = "/etc/udev/rules.d/70-novint-falcon.rules"
# Rule for Linux: the user at the machine and the group plugdev may use a Falcon.
UDEV_RULE = (
    'SUBSYSTEM=="usb", ATTR{idVendor}=="0403", ATTR{idProduct}=="cb48", MODE="0660", GROUP="plugdev", TAG+="uaccess"'
)

REPLUG = "check its plug and its power supply, then open it again"
NO_PERMISSION = (
    f"there is no permission to use it; write this line to {UDEV_FILE}:\n  {UDEV_RULE}\n"
    "then run `sudo udevadm control --reload-rules && sudo udevadm trigger`, and plug it in again"
)
NO_DRIVER = "the system's driver for it cannot be used; on Windows give it the WinUSB driver with Zadig (zadig.akeo.ie)"
NO_LIBUSB = (
    "libusb is missing; install it (Debian, Ubuntu: `apt install libusb-1.0-0`; Fedora: `dnf install libusb1`; "
    "macOS: `brew install libusb`; Windows: `pip install libusb-package`)"
)
# Causes by the number of the system's error; two errors have other numbers on macOS and on Windows.
CAUSES = {
    2: f"it was unplugged; {REPLUG}",
    5: f"the transfer failed; {REPLUG}",
    13: NO_PERMISSION,
    16: "another program is using it; close that one, or give the serial or the index of another Falcon",
    19: f"it was unplugged; {REPLUG}",
    32: f"it refused the request (stall); {REPLUG}",
    **dict.fromkeys((75, 84, 132), f"it sent more than was requested (overflow); {REPLUG}"),
    **dict.fromkeys((60, 110, 138, 10060), f"it does not answer (time-out); {REPLUG}"),
}


@final
class Port:
    """An open chip; every error of USB becomes a DeviceError that names the place and the cure."""

    def __init__(self, device: Any, place: str) -> None:
        self.place = place
        self._device = device
        self._has_driver_to_return = False
        self._chunk = array("B", bytes(READ_BYTES))

    def claim(self) -> None:
        """Claim the interface, if need be from the system's serial driver; configure the chip unless it is already."""
        with usb_errors(self.place, "opening it"):
            with suppress(NotImplementedError):  # only Linux has a driver to be detached
                if self._device.is_kernel_driver_active(INTERFACE):
                    self._device.detach_kernel_driver(INTERFACE)
                    self._has_driver_to_return = True
            if not _is_configured(self._device):
                self._device.set_configuration(1)
            usb.util.claim_interface(self._device, INTERFACE)

    def request(self, request: int, value: int) -> None:
        """Make a vendor request without data."""
        with usb_errors(self.place, "setting it up"):
            self._device.ctrl_transfer(0x40, request, value, 0, None, TIMEOUT_MS)

    def serial(self) -> str:
        """Return the serial number; empty if the chip has none."""
        with usb_errors(self.place, "reading its serial number"):
            try:
                return usb.util.get_string(self._device, self._device.iSerialNumber) or ""
            except ValueError:  # pyusb's error if there are no strings
                return ""

    def purge(self) -> None:
        """Clear the chip's buffers for both directions."""
        self.request(RESET, PURGE_IN)
        self.request(RESET, PURGE_OUT)

    def write(self, data: Octets) -> None:
        """Send bytes."""
        try:
            count = self._device.write(OUT, data, TIMEOUT_MS)
        except (usb.core.USBError, NotImplementedError) as error:
            raise device_error(error, self.place, "sending to it") from error
        if count != len(data):
            raise DeviceError(f"{self.place}: it took {count} of {len(data)} bytes; open it again")

    def read(self, chunk: Octets) -> int:
        """Make one IN transfer, unchanged: packets of 64 bytes, 2 of them status, the last one perhaps shorter."""
        try:
            return self._device.read(IN, chunk, TIMEOUT_MS)
        except (usb.core.USBError, NotImplementedError) as error:
            raise device_error(error, self.place, "reading from it") from error

    def payload(self) -> bytes:
        """Make one IN transfer and return it without the status bytes; empty if the chip has nothing."""
        chunk = self._chunk[: self.read(self._chunk)].tobytes()
        return b"".join(chunk[at + STATUS : at + USB_PACKET] for at in range(0, len(chunk), USB_PACKET))

    def close(self) -> None:
        """Release the interface, and give it back to the system's driver; failures are ignored."""
        failures = (usb.core.USBError, NotImplementedError)
        with suppress(*failures):
            usb.util.release_interface(self._device, INTERFACE)
        if self._has_driver_to_return:
            with suppress(*failures):
                self._device.attach_kernel_driver(INTERFACE)
            self._has_driver_to_return = False
        with suppress(*failures):
            usb.util.dispose_resources(self._device)


def open_port(serial: str | None, index: int, backend: Any) -> Port:
    """Open the Falcon with this serial number, or this index in the order of the bus. Raises: DeviceError."""
    device, place = choose_device(connected_devices(backend), serial, index)
    port = Port(device, place)
    try:
        port.claim()
    except BaseException:
        port.close()
        raise
    return port


def connected_devices(backend: Any) -> list[Any]:
    """Return every Falcon on the bus, as pyusb's unopened devices. Raises: DeviceAbsent, DeviceError."""
    with usb_errors("Novint Falcon", "looking for it"):
        try:
            return _find(backend)
        except usb.core.NoBackendError as error:
            if (own_libusb := _shipped_libusb()) is None:
                raise DeviceAbsent(f"Novint Falcon: {NO_LIBUSB}") from error
            return _find(own_libusb)


def _find(backend: Any) -> list[Any]:
    return list(usb.core.find(find_all=True, backend=backend, idVendor=VENDOR, idProduct=PRODUCT) or ())


def _shipped_libusb() -> Any:
    """Return the libusb of the package `libusb-package` (extra `falcon`) as pyusb's backend; None if there is none."""
    try:
        package = import_module("libusb_package")
    except ImportError:
        return None
    return package.get_libusb1_backend()


def read_serial(device: Any) -> str | None:
    """Open the device and return its serial number; None if the chip has none. Raises: DeviceError."""
    with usb_errors(device_place(device), "reading its serial number"):
        try:
            return device.serial_number
        except ValueError as error:  # pyusb's error if no string at all can be read
            raise error_of_cause(device_place(device), "reading its serial number", NO_PERMISSION) from error
        finally:
            usb.util.dispose_resources(device)


def device_place(device: Any) -> str:
    """Return a device's name and place, for messages."""
    return f"Novint Falcon (USB bus {device.bus}, address {device.address})"


def choose_device(devices: list[Any], serial: str | None, index: int) -> tuple[Any, str]:
    """Choose a device, and return it with its name. Raises: DeviceAbsent if there is none, DeviceError if not this."""
    if not devices:
        raise DeviceAbsent(
            "Novint Falcon: none is connected; plug in its USB cable and its power supply, "
            "or use device falcon-simulated"
        )
    if serial is not None:
        serials = [read_serial(device) for device in devices]
        if serial not in serials:
            raise DeviceError(
                f"Novint Falcon: none has the serial number {serial}; connected are {', '.join(map(str, serials))}"
            )
        index = serials.index(serial)
    if index >= len(devices):
        raise DeviceError(f"Novint Falcon: index {index} does not exist, {len(devices)} are connected; count from 0")
    return devices[index], device_place(devices[index])


@contextmanager
def usb_errors(place: str, doing: str) -> Generator[None]:
    """Turn all errors of pyusb in this block into DeviceErrors."""
    try:
        yield
    except (usb.core.USBError, NotImplementedError) as error:
        raise device_error(error, place, doing) from error


def _is_configured(device: Any) -> bool:
    try:
        return device.get_active_configuration().bConfigurationValue == 1
    except usb.core.USBError as error:
        if error.errno is not None:
            raise
        return False  # pyusb's error for a missing configuration has no number


def run_time(port: Port, event_character: bool) -> None:
    """Set up the chip for packets: 1.5 Mbaud, a latency timer of 1 ms, and the event character where it works."""
    port.request(LATENCY, 1)
    if event_character:  # the chip sends at once after a `>`; not known to work on every chip
        port.request(EVENT, 0x0100 | ord(">"))
    port.request(BAUD, BAUD_1500000)
    port.purge()


def device_error(error: Exception, place: str, doing: str) -> DeviceError:
    """Return the DeviceError for an error of pyusb: the place, the activity, the cause and the cure."""
    if isinstance(error, NotImplementedError):
        return error_of_cause(place, doing, NO_DRIVER)
    number = error.errno if isinstance(error, OSError) else None
    cause = CAUSES.get(number or 0, f"{error}; {REPLUG}")
    return error_of_cause(place, doing, cause)


def error_of_cause(place: str, doing: str, cause: str) -> DeviceError:
    """Return the DeviceError for a cause; its lines are kept, as one of them is to be copied."""
    return DeviceError(*f"{place}, {doing}: {cause}".splitlines())
