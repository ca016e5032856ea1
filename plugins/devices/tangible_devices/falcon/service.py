"""The connected Falcons, what keeps them from working, and their calibration by hand. Imports pyusb and numba."""

import math
from collections.abc import Callable, Iterator, Sequence
from contextlib import closing
from dataclasses import replace
from pathlib import Path
from typing import Any, get_args

from tangible_core.data import NO_FORCE, Finding, Force, Unit, Vector
from tangible_core.errors import DeviceAbsent, DeviceError
from tangible_core.plugins import Link

from .calibration import Axis, Calibration, Settings
from .kernels import kinematics
from .link import FalconLink
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
Ask = Callable[[str], str]
DIRECTIONS = ("to the right", "away from you", "up")
MIN_M = 0.010  # shortest move that identifies an axis
# Reads that are skipped after a question to the user, during which no packets were sent.
SETTLING = 20
# Stiffness of the virtual spring that carries the weight, which gives 4 mm for 100 g; and the time it is held.
HOLD_N_PER_M, HOLD_TICKS = 250.0, 2000
STANDARD_GRAVITY = 9.80665
RAW = ("x", "y", "z")  # the axes of an uncalibrated device: its own


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


def measure_axes(link: Link, ask: Ask) -> tuple[Axis, Axis, Axis]:
    """Measure which of the axes are the workspace's. link: of a device whose axes are RAW. Raises: DeviceError."""
    ask("Hold the grip in the middle of its reach, and press Enter.")
    axes: list[Axis] = []
    start = _place(link)
    for direction in DIRECTIONS:
        ask(f"Move it about 3 cm {direction}, hold it there, and press Enter.")
        end = _place(link)
        axes.append(_axis([after - before for before, after in zip(start, end, strict=True)], direction))
        start = end
    if len({axis[-1] for axis in axes}) < 3:
        raise DeviceError(f"two of the three moves went along one axis ({', '.join(axes)}); calibrate again")
    return axes[0], axes[1], axes[2]


def measure_offsets(link: Link, ask: Ask, offsets_deg: Vector) -> Vector:
    """Measure the angles at 0 counts. link: of a device whose axes are RAW, and whose offsets are these."""
    ask("Push the grip all the way in, straight along the device's axis, hold it there, and press Enter.")
    x, y, z = _place(link)
    arms = [math.degrees(arm) for arm in kinematics.inverse(x, y, z + kinematics.CENTRE_M)]
    mean = sum(arms) / 3  # on the device's axis, all three are equal; their mean is left unchanged
    top, right, left = (offset - (arm - mean) for offset, arm in zip(offsets_deg, arms, strict=True))
    return top, right, left


def measure_strength(link: Link, ask: Ask, counts_per_newton_metre: float) -> float:
    """Measure the motor counts for a newton metre by a weight that the device carries; unchanged without one."""
    grams = ask(
        "Now the motors push, up to a few newtons. Type the grams of a weight (100 to 300) that you can hang on the "
        "grip, or press Enter to leave their strength as it is."
    )
    if not grams:
        return counts_per_newton_metre
    weight_n = _number(grams) / 1000 * STANDARD_GRAVITY
    ask("Hold the grip in the middle of its reach, press Enter, and let go slowly.")
    height_m = _place(link)[2]
    alone_n = _mean_lift_n(link, height_m)  # so that friction and the mechanics' own weight cancel out
    ask("Hang the weight on the grip, and press Enter.")
    return counts_per_newton_metre * strength(alone_n, _mean_lift_n(link, height_m), weight_n)


def strength(alone_n: float, laden_n: float, weight_n: float) -> float:
    """Return the force commanded for a weight, over that weight. Raises: DeviceError if it is below 0.2 or above 5."""
    factor = (laden_n - alone_n) / weight_n
    if not 0.2 <= factor <= 5:
        raise DeviceError(f"{weight_n:.2f} N of weight changed the force by {laden_n - alone_n:.2f} N; calibrate again")
    return factor


def _mean_lift_n(link: Link, height_m: float) -> float:
    """Return the mean upward force of a soft virtual spring that carries the load, over the second half of the time."""
    forces: list[float] = []
    for _ in range(HOLD_TICKS):
        state = link.read()
        up_n = HOLD_N_PER_M * (height_m - state.position_m[2]) - 4.0 * state.velocity_m_per_s[2]
        link.write(Force(0.0, 0.0, up_n))
        forces.append(link.applied.z)
    link.write(NO_FORCE)
    late = forces[HOLD_TICKS // 2 :]
    return sum(late) / len(late)


def _place(link: Link) -> Vector:
    """Return the position of the tip, after some exchanges that bring it up to date."""
    for _ in range(SETTLING):
        link.write(NO_FORCE)
        link.read()
    return link.read().position_m


def _axis(moved_m: Sequence[float], direction: str) -> Axis:
    farthest = max(range(3), key=lambda axis: abs(moved_m[axis]))
    if abs(moved_m[farthest]) < MIN_M:
        raise DeviceError(f"the grip did not move {direction} by {1000 * MIN_M:.0f} mm; calibrate again")
    return get_args(Axis)[2 * farthest + (moved_m[farthest] < 0)]


def _number(text: str) -> float:
    try:
        grams = float(text)
    except ValueError:
        grams = math.nan
    if not 20 <= grams <= 500:
        raise DeviceError(f"{text!r} is not a weight of 20 to 500 g; calibrate again")
    return grams


def measure(opener: Callable[[Calibration], Link], ask: Ask, before: Calibration) -> Calibration:
    """Measure a whole calibration. opener: opens the device with a calibration, and homes it."""
    with opener(before.model_copy(update={"axes": RAW})) as link:
        axes = measure_axes(link, ask)
        offsets = measure_offsets(link, ask, before.encoder_offset_deg)
    geometry = before.model_copy(update={"axes": axes, "encoder_offset_deg": offsets})
    with opener(geometry) as link:
        counts = measure_strength(link, ask, before.counts_per_newton_metre)
    return Calibration.model_validate({**geometry.model_dump(), "counts_per_newton_metre": counts})
