"""A second force law on the same hand: its own force loop computes it, and the page shows its force."""

import math
from contextlib import suppress
from threading import Lock
from typing import final

from tangible_core.data import Vector
from tangible_core.errors import DeviceError
from tangible_core.servo import PAGE_SERVER_SILENCE_S, Packed, Safety, Servo, null_touch
from tangible_devices.pointer import PointerClient
from tangible_devices.pointer.pointer import Pointer

from .feeling import end_loop

NOTHING: Vector = (0.0, 0.0, 0.0)
# Time constant with which the loop follows the hand, s; the hand arrives every 10 ms, and this law lags by so much.
FOLLOW_S = 0.008
HIGHEST_M = 0.5  # height above which the hand counts as released, m


@final
class ComparisonLoop:
    """A force loop that computes a law on the hand of another loop and moves no motor. Slow methods block."""

    def __init__(self, channel: str) -> None:
        """channel: of this loop's own pointer device."""
        self._channel = channel
        self._servo: Servo | None = None
        self._client: PointerClient | None = None
        self._reported_loop: Servo | None = None
        self._lock = Lock()

    @property
    def running(self) -> bool:
        """True while the loop runs."""
        return self._servo is not None and self._servo.running

    def feel(self, touch: Packed, safety: Safety) -> None:
        """Compute this law from now on, within these limits. Raises: DeviceError if its loop cannot run."""
        with self._lock:
            if not self.running:
                self._start()
            assert self._servo is not None
            self._servo.swap(touch, safety)

    def follow(self, position_m: Vector) -> None:
        """Move this loop's hand to that of the other loop. Returns at once."""
        client = self._client
        if client is None:
            return
        with suppress(DeviceError):  # its loop has just ended
            if position_m[2] < HIGHEST_M:
                client.send(position_m)
            else:
                client.release()

    @property
    def force_n(self) -> Vector:
        """The current force; zero while the loop does not run."""
        servo = self._servo
        if servo is None or not servo.running or (row := servo.ring.latest()) is None:
            return NOTHING
        x, y, z = row[11:14].tolist()
        return (x, y, z) if math.isfinite(x + y + z) else NOTHING

    def loop_end(self) -> str:
        """Return once why the loop ended by itself; else "". Meant to be polled."""
        servo = self._servo
        if servo is None or servo.running or servo is self._reported_loop:
            return ""
        self._reported_loop = servo
        return end_loop(servo)

    def close(self) -> None:
        """End the loop; a second call does nothing."""
        with self._lock:
            self._end()

    def _start(self) -> None:
        self._end()
        device = Pointer(channel=self._channel, stale_after_s=PAGE_SERVER_SILENCE_S, follow_s=FOLLOW_S)
        servo = Servo(null_touch(), device, Safety())
        servo.__enter__()
        self._servo = servo
        self._client = PointerClient(self._channel, 5.0)

    def _end(self) -> None:
        client, self._client = self._client, None
        servo, self._servo = self._servo, None
        if client is not None:
            client.close()
        if servo is not None:
            end_loop(servo)
