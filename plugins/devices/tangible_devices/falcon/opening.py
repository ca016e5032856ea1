"""From options to a Falcon that is homed and ready. Imports pyusb and numba."""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import TYPE_CHECKING, Any

from tangible_core.scene.calibrations import any_calibration

from .firmware import running
from .homing import home
from .link import FalconLink
from .port import open_port

if TYPE_CHECKING:
    from .falcon import Falcon


def open_falcon(options: Falcon, image: bytes | None, backend: Any, clock: Callable[[], float]) -> FalconLink:
    """Find it, load its firmware if none answers, and home it; backend: pyusb's, None for the system's libusb.

    Raises: DeviceError if it is not there, not permitted, in use, has no firmware, is not homed in time, or fails.
    """
    opener = partial(open_port, options.serial, options.index, backend)
    port = running(opener, image, options.event_character)
    try:
        calibration = options.calibrated(port.serial() if any_calibration("falcon") else "")
    except BaseException:
        port.close()
        raise
    link = FalconLink(
        port,
        arms=calibration.arms(),
        frame=calibration.frame(),
        max_force_n=calibration.spec().max_force_n,
        clock=clock,
        samples=options.velocity_samples,
        in_flight=options.in_flight,
        leds=options.leds,
    )
    try:
        home(link, options.home_within_s, clock)
    except BaseException:
        link.close()
        raise
    return link
