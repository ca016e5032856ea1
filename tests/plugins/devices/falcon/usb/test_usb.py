"""A Falcon would not be found or claimed, be set up wrongly, or be sent a wrong firmware."""

import errno
import os
import sys
from array import array
from pathlib import Path
from types import SimpleNamespace

import pytest
from usb.core import NoBackendError, USBError

from falcon_bus import Line, bus_of, held_bus, opener_of
from tangible_core.errors import DeviceAbsent, DeviceError
from tangible_devices.falcon.simulator.bus import Bus
from tangible_devices.falcon.simulator.falcons import synthetic_image
from tangible_devices.falcon.usb import firmware, port
from tangible_devices.falcon.usb.image import read_image
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


def test_payload_has_no_status_bytes_and_whole_writes():
    bus, clock = held_bus()
    port = open_port(None, 0, bus)
    chip = bus.units[0].chip
    chip.control(9, 1)
    chip._waiting.append((0.0, bytes(range(150))))
    assert port.payload() == bytes(range(150))
    assert port.payload() == b""
    assert clock() > 0
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


IMAGE = synthetic_image()


class TestImage:
    def test_image_complete_is_accepted(self, tmp_path: Path):
        path = tmp_path / "firmware.bin"
        path.write_bytes(IMAGE)
        assert read_image(path) == IMAGE

    @pytest.mark.parametrize(
        ("image", "why"),
        [
            (b"", "0 bytes"),
            (IMAGE + b"\0\0", "2 bytes follow"),
            (b"\x7fELF" + IMAGE[4:], "0x457F"),
            (IMAGE[:4] + b"\1" + IMAGE[5:], "reserved"),
            (IMAGE[:22] + b"\0\0", "no block"),
            (IMAGE[:-2], "cut off"),
            (IMAGE[:-1], "even"),
            (b"\0" * (1 << 20), "262144"),
        ],
    )
    def test_image_fault_is_named(self, image: bytes, why: str, tmp_path: Path):
        path = tmp_path / "some.bin"
        path.write_bytes(image)
        with pytest.raises(DeviceError, match=why):
            read_image(path)

    @pytest.mark.timeout(20)
    def test_image_missing_or_from_pipe_is_refused_at_once(self, tmp_path: Path):
        os.mkfifo(tmp_path / "pipe.bin")
        for name in ("nothing.bin", "pipe.bin"):
            with pytest.raises(DeviceError, match="cannot be read"):
                read_image(tmp_path / name)


def load(line: Line, image: bytes | None = IMAGE) -> int:
    """Start a Falcon over this line; return the number of resets."""
    bus = bus_of(line)
    firmware.open_running(opener_of(bus), image).close()
    assert bus.units[0].chip.processor.mode == "run"
    assert bus.units[0].claimed_by is None and bus.units[0].kernel_driver
    return line.resets


class TestLoad:
    def test_load_takes_one_attempt_and_is_skipped_where_firmware_runs(self):
        assert load(Line()) == 1
        line = Line()
        bus = bus_of(line)
        firmware.open_running(opener_of(bus), IMAGE).close()
        firmware.open_running(opener_of(bus), None).close()
        assert line.resets == 1

    @pytest.mark.parametrize("at", [0, 3, 4, 5, 67, 2000, len(IMAGE) + 4])
    @pytest.mark.parametrize("damage", ["flip", "drop", "double"])
    def test_load_with_damaged_echo_is_repeated(self, at: int, damage: str):
        assert load(Line(damage, at)) <= 2

    @pytest.mark.parametrize("reply", [0, 1, 2, 30])
    def test_load_with_late_echo_waits(self, reply: int):
        assert load(Line(late_reply=reply)) == 1

    @pytest.mark.parametrize("swallowed", [1, 7, 90])
    def test_load_greets_a_deaf_boot_loader_again(self, swallowed: int):
        assert load(Line(swallowed=swallowed)) == 1

    def test_load_that_fails_gives_one_message(self):
        with pytest.raises(DeviceError, match="10 attempts failed"):
            load(Line("flip", 40, again=True))
        line = Line()
        with pytest.raises(DeviceError, match="firmware"):
            load(line, None)
        assert line.resets == 0
