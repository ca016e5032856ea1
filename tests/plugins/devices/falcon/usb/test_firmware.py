"""A Falcon would be sent a wrong firmware, or not start on a bad line."""

import os
from pathlib import Path

import pytest

from falcon_bus import Line, bus_of, opener_of
from tangible_core.errors import DeviceError
from tangible_devices.falcon.simulator.falcons import synthetic_image
from tangible_devices.falcon.usb import firmware
from tangible_devices.falcon.usb.image import read_image

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
    def test_load_on_good_line_takes_one_attempt(self):
        assert load(Line()) == 1

    def test_load_of_running_firmware_is_skipped(self):
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

    def test_load_failing_always_gives_one_message(self):
        with pytest.raises(DeviceError, match="10 attempts failed"):
            load(Line("flip", 40, again=True))

    def test_load_without_image_names_its_source(self):
        line = Line()
        with pytest.raises(DeviceError, match="firmware"):
            load(line, None)
        assert line.resets == 0
