"""A force loop that stays open from interval to interval: the device is opened once, and no force is left between."""

import time
from collections.abc import Callable
from types import TracebackType
from typing import Self, final

import numpy as np

from tangible_core.errors import DeviceError
from tangible_core.pipeline import Feeling
from tangible_core.plugins import HapticDevice
from tangible_core.servo import Servo, beacon_to, null_touch
from tangible_core.session import STOPPED, RingDrain

from ..desks.desk import Desk

LOOK_EVERY_S = 0.05
"""Interval at which ticks are taken from the loop, and so the most that a crash can lose of a recording."""


@final
class HeldLoop:
    """The loop of a session, as a context manager that leaves no force."""

    def __init__(self) -> None:
        self._servo: Servo | None = None
        self._device: HapticDevice | None = None

    def __enter__(self) -> Self:
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        self.close()

    def close(self) -> str:
        """End the loop, if one runs, and return why it ended. Raises: whatever a faulty plugin raised in it."""
        servo, self._servo = self._servo, None
        return "" if servo is None else servo.stop().stopped

    def feel(
        self,
        feeling: Feeling,
        seconds: float,
        keep: Callable[[np.ndarray], None],
        desk: Desk,
        on_start: Callable[[], None],
        part: str | None,
    ) -> None:
        """Present a surface for some seconds, then nothing.

        keep: called with all ticks. desk: may have a hand of its own; its `stop` ends the force at once. on_start:
        called when the surface is there. part: a part to which the hand is pulled.
        Raises: DeviceError if the device fails, or after `stop`; whatever `keep` or a faulty plugin raises. The loop
        has ended then, and the next call opens the device anew.
        """
        try:
            servo = self._servo_on(feeling)
            servo.swap(feeling.touch, feeling.engine.config.safety)
            servo.pull_to(None if part is None else beacon_to(feeling.pipeline.make("surface"), part))
            with desk.exploring(feeling, servo, part):
                drain, stop = RingDrain(servo, keep, servo.ring.count), desk.stop
                until_s = time.monotonic() + seconds
                on_start()
                while servo.running and (left_s := until_s - time.monotonic()) > 0 and not stop.is_set():
                    stop.wait(min(left_s, LOOK_EVERY_S))
                    drain.look()
                if stop.is_set() or not servo.running:
                    ended = self.close()
                    drain.look()
                    raise DeviceError(STOPPED if stop.is_set() else ended)
            servo.pull_to(None)
            servo.swap(null_touch())
        except BaseException:
            self.close()
            raise

    def _servo_on(self, feeling: Feeling) -> Servo:
        """Return the loop on the device of a surface, which is started if none runs on this device."""
        device = feeling.device
        if self._servo is None or not self._servo.running or device != self._device:
            self.close()
            servo = Servo(null_touch(), device, feeling.engine.config.safety)
            servo.__enter__()
            self._servo, self._device = servo, device
        return self._servo
