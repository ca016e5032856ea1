"""Guided homing: the user moves the grip until every arm has found its zero, and feels nothing meanwhile."""

import logging
from collections.abc import Callable

from tangible_core.data import NO_FORCE
from tangible_core.errors import DeviceError

from .link import FalconLink

log = logging.getLogger(__name__)
GUIDE = "pull its grip all the way out, then push it all the way in; its light turns from red to green"
AT_ONCE_S = 0.1
"""A device that is homed by then needs no guidance."""


def home(link: FalconLink, seconds: float, clock: Callable[[], float]) -> None:
    """Exchange packets without force until the device is homed and force may be given.

    Raises: DeviceError if it is not within so many seconds, or USB fails.
    """
    start, told = clock(), False
    while not link.homed:
        link.write(NO_FORCE)
        link.look()
        waited = clock() - start
        if waited > seconds:
            raise DeviceError(f"{link.place}: {link.arms_homed} of 3 arms are homed after {seconds:g} s; {GUIDE}")
        if waited > AT_ONCE_S and not told and link.arms_homed < 3:
            told = True
            log.warning("%s: %s", link.place, GUIDE)
