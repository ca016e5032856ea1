"""The connected Falcons, and what keeps them from working, in the order of the cures. Imports pyusb and numba."""

from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any

from tangible_core.data import Finding, Unit
from tangible_core.errors import DeviceAbsent, DeviceError

from .calibration import Calibration, Settings
from .link import FalconLink
from .measuring import measure
from .opening import open_falcon
from .usb.firmware import firmware_answers
from .usb.image import WHENCE, read_image
from .usb.port import INTERFACE, Port, choose_device, connected_devices, device_place, read_serial, run_time

ENOUGH_HZ = 900.0  # lowest rate that is reported as fine
PACKETS = 500  # packets exchanged, without force, to measure the rate
FASTER = (
    "plug it into a USB port of the machine itself, with no hub between; keep option in_flight at 2; a rate of about "
    "60 is the USB chip's latency timer of 16 ms, which it did not change to 1 ms: unplug it and plug it in again"
)


def units(backend: Any) -> tuple[Unit, ...]:
    """Return every Falcon on the bus; each is opened for a moment to read its serial number."""
    return tuple(_unit(device) for device in connected_devices(backend))


def findings(settings: Settings, firmware: Path | None, backend: Any, clock: Callable[[], float]) -> Iterator[Finding]:
    """Check libusb, the firmware's file, then each Falcon: permission, driver, firmware, rate. No force is given."""
    try:
        devices = connected_devices(backend)
    except DeviceError as error:
        yield _failure("libusb", error, "not asked" if isinstance(error, DeviceAbsent) else "failed")
        return
    yield Finding("libusb", "fine", "is there")
    checks = [check for device in devices for check in _device_findings(device, settings, firmware, clock)]
    yield _file(firmware, [check.verdict for check in checks if check.check.endswith(": firmware")])
    yield from checks
    if not devices:
        yield Finding("device", "not asked", "none is plugged in; it needs its USB cable and its power supply")


def calibrate(
    settings: Settings, image: bytes | None, ask: Callable[[str], str], backend: Any, clock: Callable[[], float]
) -> tuple[str, Calibration]:
    """Calibrate the Falcon that the settings select; return its serial number and the calibration."""
    serial = read_serial(choose_device(connected_devices(backend), settings.serial, settings.index)[0]) or ""

    def opener(calibration: Calibration) -> FalconLink:
        return open_falcon(replace(settings, calibration=calibration), image, backend, clock)

    return serial, measure(opener, ask, settings.find_calibration(serial))


def _device_findings(
    device: Any, settings: Settings, firmware: Path | None, clock: Callable[[], float]
) -> Iterator[Finding]:
    place = f"bus {device.bus}, address {device.address}"
    try:
        serial = read_serial(device)
        yield Finding(f"{place}: permission", "fine", f"may be used; serial number {serial or 'none'}")
        yield Finding(f"{place}: driver", "fine", _driver(device))
        with closing(Port(device, device_place(device))) as port:
            port.claim()
            run_time(port, settings.event_character)
            yield Finding(f"{place}: in use", "fine", "by nobody else")
            if not firmware_answers(port):
                if firmware is not None:
                    yield Finding(f"{place}: firmware", "fine", "has none yet; the file is sent when it is opened")
                    return
                fault = "has none since it was powered, and no file is given"
                cure = f"--set firmware=FILE, or option firmware; {WHENCE}"
                yield Finding(f"{place}: firmware", "failed", fault, cure)
                return
            yield Finding(f"{place}: firmware", "fine", "answers")
            yield _rate(place, port, settings, clock)
    except DeviceError as error:
        yield _failure(place, error)


def _unit(device: Any) -> Unit:
    place = f"USB bus {device.bus}, address {device.address}"
    try:
        return Unit("Novint Falcon", read_serial(device) or "", place)
    except DeviceError as error:
        return Unit("Novint Falcon", "", place, f"{str(error).splitlines()[0]} (tangible devices doctor falcon)")


def _file(firmware: Path | None, answers: Sequence[str]) -> Finding:
    """Check the firmware's file. answers: verdicts on the firmware of each device."""
    if firmware is None:
        needless = set(answers) == {"fine"}
        says = "none is given; one is needed after each time the device was powered: --set firmware=FILE"
        return Finding("firmware file", "fine" if needless else "not asked", says)
    try:
        return Finding("firmware file", "fine", f"{firmware}: {len(read_image(firmware))} bytes, whole")
    except DeviceError as error:
        return _failure("firmware file", error)


def _driver(device: Any) -> str:
    try:
        if device.is_kernel_driver_active(INTERFACE):
            return "the system's serial driver has it; it is taken over while it is used, and given back"
    except NotImplementedError:
        return "is WinUSB or the like, or none is needed"
    except OSError as error:
        return f"cannot be queried ({error})"
    return "no other driver has it"


def _rate(place: str, port: Port, settings: Settings, clock: Callable[[], float]) -> Finding:
    calibration = Calibration()
    link = FalconLink(
        port, calibration.arms(), calibration.frame(), 0.0, clock, in_flight=settings.in_flight, leds=settings.leds
    )
    for _ in range(PACKETS):
        link.exchange()
    health = link.health()
    counts = f"{health.rate_hz:.0f} packets a second, {health.lost} lost, {health.dropped_bytes} stray bytes"
    if health.rate_hz < ENOUGH_HZ:
        return Finding(f"{place}: rate", "failed", counts, FASTER)
    return Finding(f"{place}: rate", "fine", counts)


def _failure(check: str, error: DeviceError, verdict: Any = "failed") -> Finding:
    first, *_ = str(error).splitlines()
    return Finding(check, verdict, first.rstrip(":"), str(error))
