"""A USB bus with simulated Falcons on it, as a backend of pyusb. Imports pyusb."""

import struct
from array import array
from collections import Counter
from collections.abc import Iterable, Mapping
from types import SimpleNamespace
from typing import TYPE_CHECKING, Any, final

from usb.core import USBError, USBTimeoutError

from ..usb.port import IN, OUT, PRODUCT, VENDOR, Octets
from .chip import PACKET_BYTES, Chip, StallError
from .faults import ERRORS, Fault, Step

if TYPE_CHECKING:
    Backend = object
    """The base class of pyusb's backends; pyusb has no annotations."""
else:
    from usb.backend import IBackend as Backend

PRODUCT_NAME = "FALCON HAPTIC"
DEVICE: Mapping[str, Any] = {
    **{"bLength": 18, "bDescriptorType": 1, "bcdUSB": 0x0200, "bDeviceClass": 0, "bDeviceSubClass": 0},
    **{"bDeviceProtocol": 0, "bMaxPacketSize0": 8, "idVendor": VENDOR, "idProduct": PRODUCT, "bcdDevice": 0x0600},
    **{"iManufacturer": 0, "iProduct": 2, "iSerialNumber": 3, "bNumConfigurations": 1},
    **{"bus": 1, "port_number": 1, "port_numbers": (1,), "speed": 2},
}
CONFIGURATION: Mapping[str, Any] = {
    **{"bLength": 9, "bDescriptorType": 2, "wTotalLength": 32, "bNumInterfaces": 1, "bConfigurationValue": 1},
    **{"iConfiguration": 0, "bmAttributes": 0x80, "bMaxPower": 45, "extra_descriptors": []},
}
PORT: Mapping[str, Any] = {
    **{"bLength": 9, "bDescriptorType": 4, "bInterfaceNumber": 0, "bAlternateSetting": 0, "bNumEndpoints": 2},
    **{"bInterfaceClass": 255, "bInterfaceSubClass": 255, "bInterfaceProtocol": 255, "iInterface": 2},
    "extra_descriptors": [],
}
ENDPOINT: Mapping[str, Any] = {
    **{"bLength": 7, "bDescriptorType": 5, "bmAttributes": 2, "wMaxPacketSize": PACKET_BYTES, "bInterval": 0},
    **{"bRefresh": 0, "bSynchAddress": 0, "extra_descriptors": []},
}


@final
class Unit:
    """A Falcon on the bus: its chip and its state in the system."""

    def __init__(self, chip: Chip, serial: str = "SIM0001", kernel_driver: bool = True) -> None:
        self.chip = chip
        self.serial = serial
        self.kernel_driver: bool = kernel_driver
        """True while the system's serial driver has it."""
        self.plugged: bool = True
        self.configuration: int = 0
        self.claimed_by: Handle | None = None

    def unplug(self) -> None:
        """Remove the unit from the bus; its firmware is lost."""
        self.plugged = False
        self.chip.processor.unpower()

    def plug_in(self) -> None:
        """Plug the unit in; the system's serial driver takes it."""
        self.plugged = self.kernel_driver = True
        self.configuration, self.claimed_by = 0, None


@final
class Handle:
    """An opened unit."""

    def __init__(self, unit: Unit) -> None:
        self.unit = unit


@final
class Bus(Backend):
    """A backend of pyusb, in place of libusb; `faults` may be changed at any time."""

    def __init__(self, units: Iterable[Unit], faults: Iterable[Fault] = ()) -> None:
        self.units: list[Unit] = list(units)
        self.faults: list[Fault] = list(faults)
        self._steps: Counter[str] = Counter()

    def fail(self, fault: Fault) -> None:
        """Add a fault, counted from now on."""
        self.faults.append(fault.model_copy(update={"after": fault.after + self._steps[fault.at]}))

    def enumerate_devices(self) -> list[Unit]:
        """Return the units that are plugged in."""
        self._step("look", None)
        return [unit for unit in self.units if unit.plugged]

    def get_device_descriptor(self, dev: Unit) -> SimpleNamespace:
        """Return the descriptor of a Falcon."""
        return SimpleNamespace(**DEVICE, address=5 + self.units.index(dev))

    def get_configuration_descriptor(self, dev: Unit, config: int) -> SimpleNamespace:
        """Return the only configuration's descriptor."""
        if config:
            raise IndexError(f"there is no configuration {config}")
        return SimpleNamespace(**CONFIGURATION)

    def get_interface_descriptor(self, dev: Unit, intf: int, alt: int, config: int) -> SimpleNamespace:
        """Return the only interface's descriptor."""
        if intf or alt:
            raise IndexError(f"there is no interface {intf}.{alt}")
        return SimpleNamespace(**PORT)

    def get_endpoint_descriptor(self, dev: Unit, ep: int, intf: int, alt: int, config: int) -> SimpleNamespace:
        """Return the descriptor of one of the two bulk endpoints, in and out."""
        return SimpleNamespace(**ENDPOINT, bEndpointAddress=(IN, OUT)[ep])

    def open_device(self, dev: Unit) -> Handle:
        """Return a new handle."""
        self._step("open", dev)
        return Handle(dev)

    def close_device(self, dev_handle: Handle) -> None:
        """Release the interface."""
        self.release_interface(dev_handle, 0)

    def get_configuration(self, dev_handle: Handle) -> int:
        """Return the configuration; 0 before it is set."""
        self._step("configure", dev_handle.unit)
        return dev_handle.unit.configuration

    def set_configuration(self, dev_handle: Handle, config_value: int) -> None:
        """Set the configuration."""
        self._step("configure", dev_handle.unit)
        dev_handle.unit.configuration = config_value

    def is_kernel_driver_active(self, dev_handle: Handle, intf: int) -> bool:
        """Tell whether the system's driver has it."""
        self._step("driver", dev_handle.unit)
        return dev_handle.unit.kernel_driver

    def detach_kernel_driver(self, dev_handle: Handle, intf: int) -> None:
        """Take the unit from the system's driver."""
        self._step("driver", dev_handle.unit)
        dev_handle.unit.kernel_driver = False

    def attach_kernel_driver(self, dev_handle: Handle, intf: int) -> None:
        """Give the unit back to the system's driver."""
        self._step("driver", dev_handle.unit)
        dev_handle.unit.kernel_driver = True

    def claim_interface(self, dev_handle: Handle, intf: int) -> None:
        """Claim the interface. Raises: USBError while another handle or the system's driver has it."""
        unit = dev_handle.unit
        self._step("claim", unit)
        if unit.kernel_driver or unit.claimed_by not in (None, dev_handle):
            raise failure("busy")
        unit.claimed_by = dev_handle

    def release_interface(self, dev_handle: Handle, intf: int) -> None:
        """Release the interface for other handles."""
        if dev_handle.unit.claimed_by is dev_handle:
            dev_handle.unit.claimed_by = None

    def ctrl_transfer(
        self,
        dev_handle: Handle,
        bmRequestType: int,
        bRequest: int,
        wValue: int,
        wIndex: int,
        data: Octets,
        timeout: int,
    ) -> int:
        """Pass vendor requests to the chip, and return strings. Raises: USBError for all other requests."""
        self._step("control", dev_handle.unit)
        if (bmRequestType, bRequest, wValue >> 8) == (0x80, 0x06, 0x03):
            return _write_string(dev_handle.unit, wValue & 0xFF, data)
        if bmRequestType != 0x40 or wIndex or data:
            raise failure("stall")
        try:
            dev_handle.unit.chip.control(bRequest, wValue)
        except StallError as error:
            raise failure("stall") from error
        return 0

    def bulk_write(self, dev_handle: Handle, ep: int, intf: int, data: Octets, timeout: int) -> int:
        """Write all bytes to the chip."""
        self._step("write", dev_handle.unit)
        self._check(dev_handle, ep == OUT)
        dev_handle.unit.chip.write(data.tobytes())
        return len(data)

    def bulk_read(self, dev_handle: Handle, ep: int, intf: int, buff: Octets, timeout: int) -> int:
        """Read the chip's data, at least its status. Raises: USBError if the buffer is not whole packets long."""
        self._step("read", dev_handle.unit)
        self._check(dev_handle, ep == IN)
        if len(buff) % PACKET_BYTES:
            raise failure("overflow")
        data = dev_handle.unit.chip.read(len(buff))
        buff[: len(data)] = array("B", data)
        return len(data)

    def clear_halt(self, dev_handle: Handle, ep: int) -> None:
        """Do nothing, as no endpoint is ever halted."""

    def _check(self, handle: Handle, right_endpoint: bool) -> None:
        if not right_endpoint or handle.unit.claimed_by is not handle:
            raise USBError("Entity not found", -5, 2)

    def _step(self, step: Step, unit: Unit | None) -> None:
        if unit is not None and not unit.plugged:
            raise failure("unplugged")
        nth = self._steps[step]
        self._steps[step] += 1
        for fault in self.faults:
            if fault.at == step and fault.after <= nth < fault.after + fault.times:
                if unit is not None and fault.error == "unplugged":
                    unit.unplug()
                raise failure(fault.error)


def failure(error: str) -> OSError:
    """Return the error that libusb would raise."""
    kind = USBTimeoutError if error == "timeout" else USBError
    return kind(error, -1, ERRORS[error])


def _write_string(unit: Unit, index: int, data: Octets) -> int:
    text = {2: PRODUCT_NAME, 3: unit.serial}.get(index, "")
    body = struct.pack("<H", 0x0409) if index == 0 else text.encode("utf-16-le")
    descriptor = bytes([2 + len(body), 3]) + body
    data[: len(descriptor)] = array("B", descriptor)
    return len(descriptor)
