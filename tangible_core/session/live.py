"""A session in real time: the force loop in its own process, watched and recorded from here."""

import logging
import time
from collections.abc import Callable

import numpy as np

from ..data import ServoReport
from ..interfaces import HapticDevice, Touch
from ..servo import Safety, Servo
from .recording import INTERRUPTED

log = logging.getLogger(__name__)
LOOK_EVERY_S = 0.05
"""How often what was felt is taken from the loop's ring: what a crash of this process can lose of a recording."""
REPORT_EVERY_S = 0.1


def feel(
    touch: Touch,
    device: HapticDevice,
    seconds: float | None,
    limits: Safety,
    on_report: Callable[[ServoReport], None],
    keep: Callable[[np.ndarray], None],
    on_start: Callable[[Servo], None] = lambda _: None,
) -> ServoReport:
    """Feel in real time, until the seconds are over, Ctrl-C, or what else ends a `Servo`; then the force is zero.

    on_report: called ten times a second, and at the end. keep: given all ticks, as rows of `data.TICK_COLUMNS`. What
    these raise ends the session, such as a full disk.
    Raises: ConfigError if seconds is not above 0 and finite, DeviceError if the device cannot be opened, and what a
    plugin raises.
    """
    with Servo(touch, device, limits, seconds) as servo:
        on_start(servo)
        kept, next_s = 0, time.monotonic()
        try:
            while servo.running:
                time.sleep(LOOK_EVERY_S)
                kept = _keep(servo, kept, keep)
                if time.monotonic() >= next_s:
                    next_s += REPORT_EVERY_S
                    on_report(servo.report())
            last = servo.stop()
        except KeyboardInterrupt:
            last = servo.stop(INTERRUPTED)
        _keep(servo, kept, keep)
        on_report(last)
    return last


def _keep(servo: Servo, first: int, keep: Callable[[np.ndarray], None]) -> int:
    """Hand on the ticks from this number on; the number of the next."""
    rows, following = servo.ring.since(first)
    if lost := following - first - len(rows):
        log.warning("%d ticks were overwritten before they could be recorded; the machine is too busy", lost)
    if len(rows):
        keep(rows)
    return following
