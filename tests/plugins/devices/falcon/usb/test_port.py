"""A Falcon would not be found or claimed, be set up wrongly, or its user get a wrong reason for an error."""

import errno
import sys
from array import array
from types import SimpleNamespace

import pytest
from usb.core import NoBackendError, USBError

from falcon_bus import held_bus
from tangible_core.errors import DeviceAbsent, DeviceError
from tangible_devices.falcon.simulator.bus import Bus
from tangible_devices.falcon.usb import port
from tangible_devices.falcon.usb.port import UDEV_RULE, connected_devices, device_error, open_port, run_time

LATENCY_1, BAUD, PURGES = (9, 1), (3, 0x0002), [(0, 1), (0, 2)]


def requests(bus: Bus, monkeypatch: pytest.MonkeyPatch) -> list[tuple[int, int]]:
    """The requests to the chip from now on."""
    asked: list[tuple[int, int]] = []
    chip = bus.units[0].chip
    control = chip.control
    monkeypatch.setattr(chip, "control", lambda *request: (asked.append(request), control(*request))[1])
    return asked


@pytest.mark.parametrize(("event_character", "more"), [(False, []), (True, [(6, 0x013E)])])
def test_run_time_sets_the_chip_up_for_packets(event_character: bool, more: list, monkeypatch: pytest.MonkeyPatch):
    bus, _ = held_bus()
    asked = requests(bus, monkeypatch)
    run_time(open_port(None, 0, bus), event_character)
    assert asked == [LATENCY_1, *more, BAUD, *PURGES]


def test_payload_has_no_status_bytes():
    bus, clock = held_bus()
    port = open_port(None, 0, bus)
    chip = bus.units[0].chip
    chip.control(9, 1)
    chip._waiting.append((0.0, bytes(range(150))))
    assert port.payload() == bytes(range(150))
    assert port.payload() == b""
    assert clock() > 0


def test_port_write_cut_short_is_refused():
    bus, _ = held_bus()
    port = open_port(None, 0, bus)
    bus.bulk_write = lambda *_: 7  # pyright: ignore[reportAttributeAccessIssue]
    with pytest.raises(DeviceError, match="took 7 of 16 bytes"):
        port.write(array("B", bytes(16)))


@pytest.mark.parametrize(
    ("number", "word"),
    [
        (errno.ENODEV, "unplugged"),
        (errno.EACCES, "permission"),
        (errno.EBUSY, "another program"),
        (errno.EPIPE, "stall"),
    ]
    + [(each, "time-out") for each in (errno.ETIMEDOUT, 60, 10060)]
    + [(each, "overflow") for each in (errno.EOVERFLOW, 84, 132)]
    + [(errno.EIO, "the transfer failed"), (None, "check its plug"), (9999, "check its plug")],
)
def test_device_error_of_each_number_has_its_words(number: int | None, word: str):
    message = str(device_error(USBError("what libusb says", -1, number), "the Falcon", "reading"))
    assert message.startswith("the Falcon, reading: ") and word in message and ";" in message


def test_device_error_of_permission_has_rule_on_its_own_line():
    message = str(device_error(USBError("what libusb says", -1, errno.EACCES), "the Falcon", "reading"))
    assert UDEV_RULE in [line.strip() for line in message.splitlines()]


@pytest.mark.parametrize("shipped", [True, False])
def test_libusb_of_the_package_is_used_where_the_system_has_none(shipped: bool, monkeypatch: pytest.MonkeyPatch):
    bus, _ = held_bus()
    find = port.usb.core.find

    def without_libusb(*words: object, backend: object = None, **options: object) -> object:
        if backend is None:
            raise NoBackendError("No backend available")
        return find(*words, backend=backend, **options)

    monkeypatch.setattr(port.usb.core, "find", without_libusb)
    package = SimpleNamespace(get_libusb1_backend=lambda: bus) if shipped else None
    monkeypatch.setitem(sys.modules, "libusb_package", package)
    if shipped:
        assert len(connected_devices(None)) == 1
    else:
        with pytest.raises(DeviceAbsent, match="pip install libusb-package"):
            connected_devices(None)
