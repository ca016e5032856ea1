"""Opening a Falcon: firmware, calibration, and guided homing, without force meanwhile. Imports pyusb and numba."""

import logging
from collections.abc import Callable
from functools import partial
from typing import Any

from tangible_core.data import NO_FORCE
from tangible_core.errors import DeviceError

from ..device_calibrations import any_calibration
from .calibration import Settings
from .link import FalconLink
from .usb.firmware import open_running
from .usb.port import open_port

log: logging.Logger = logging.getLogger(__name__)
GUIDE = "pull its grip all the way out, then push it all the way in; its light turns from red to green"
AT_ONCE_S = 0.1  # time before the user is asked to home the device: it may be homed already


def open_falcon(settings: Settings, image: bytes | None, backend: Any, clock: Callable[[], float]) -> FalconLink:
    """Find a Falcon, load its firmware if none answers, and home it; backend: pyusb's. Raises: DeviceError."""
    opener = partial(open_port, settings.serial, settings.index, backend)
    port = open_running(opener, image, settings.event_character)
    try:
        calibration = settings.find_calibration(port.serial() if any_calibration("falcon") else "")
    except BaseException:
        port.close()
        raise
    link = FalconLink(
        port,
        arms=calibration.arms(),
        frame=calibration.frame(),
        max_force_n=calibration.spec().max_force_n,
        clock=clock,
        samples=settings.velocity_samples,
        in_flight=settings.in_flight,
        leds=settings.leds,
    )
    try:
        home(link, settings.home_within_s, clock)
    except BaseException:
        link.close()
        raise
    return link


def home(link: FalconLink, seconds: float, clock: Callable[[], float]) -> None:
    """Exchange packets without force until the device is homed and force has faded in. Raises: DeviceError."""
    start, has_guide = clock(), False
    while not link.is_homed:
        link.write(NO_FORCE)
        link.look()
        seconds_so_far = clock() - start
        if seconds_so_far > seconds:
            raise DeviceError(f"{link.place}: {link.arms_homed} of 3 arms are homed after {seconds:g} s; {GUIDE}")
        if seconds_so_far > AT_ONCE_S and not has_guide and link.arms_homed < 3:
            has_guide = True
            log.warning("%s: %s", link.place, GUIDE)
