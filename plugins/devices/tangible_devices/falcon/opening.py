"""From settings to a Falcon that is homed and ready. Imports pyusb and numba."""

from collections.abc import Callable
from functools import partial
from typing import Any

from tangible_core.mapping.device_calibrations import any_calibration

from .firmware import running
from .homing import home
from .link import FalconLink
from .port import open_port
from .settings import Settings


def open_falcon(settings: Settings, image: bytes | None, backend: Any, clock: Callable[[], float]) -> FalconLink:
    """Find it, load its firmware if none answers, and home it; backend: pyusb's, None for the system's libusb.

    Raises: DeviceError if it is not there, not permitted, in use, has no firmware, is not homed in time, or fails.
    """
    opener = partial(open_port, settings.serial, settings.index, backend)
    port = running(opener, image, settings.event_character)
    try:
        calibration = settings.calibrated(port.serial() if any_calibration("falcon") else "")
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
