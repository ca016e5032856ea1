"""Another law on the same hand: a force loop of its own, whose force is shown beside the one that is felt."""

import math
from contextlib import suppress
from threading import Lock
from typing import final

from tangible_core.data import Vector
from tangible_core.errors import DeviceError
from tangible_core.servo import Packed, Safety, Servo, still
from tangible_devices.pointer import PointerClient
from tangible_devices.pointer.pointer import Pointer

NOTHING: Vector = (0.0, 0.0, 0.0)
STALE_AFTER_S = 0.3
FOLLOW_S = 0.008
"""The hand is handed on every 8 ms, and followed smoothly in between: this law is that much behind."""
HIGHEST_M = 0.5
"""Above, nobody holds the hand."""


@final
class ComparisonLoop:
    """A law that is computed on the hand of another loop, and pushes nobody. What takes long blocks."""

    def __init__(self, channel: str) -> None:
        """channel: of a pointer device of its own."""
        self._channel = channel
        self._servo: Servo | None = None
        self._client: PointerClient | None = None
        self._lock = Lock()

    @property
    def running(self) -> bool:
        """Whether it gives forces."""
        return self._servo is not None and self._servo.running

    def feel(self, touch: Packed, safety: Safety) -> None:
        """Compute this law from now on, within these limits. Raises: DeviceError if its loop cannot run."""
        with self._lock:
            if not self.running:
                self._start()
            assert self._servo is not None
            self._servo.swap(touch, safety)

    def follow(self, position_m: Vector) -> None:
        """Where the other loop's hand is. Returns at once."""
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
        """What it gives now; nothing while it does not run."""
        servo = self._servo
        if servo is None or not servo.running or (row := servo.ring.latest()) is None:
            return NOTHING
        x, y, z = row[11:14].tolist()
        return (x, y, z) if math.isfinite(x + y + z) else NOTHING

    def close(self) -> None:
        """End its loop; a second call does nothing."""
        with self._lock:
            self._end()

    def _start(self) -> None:
        self._end()
        device = Pointer(channel=self._channel, stale_after_s=STALE_AFTER_S, follow_s=FOLLOW_S)
        servo = Servo(still(), device, Safety())
        servo.__enter__()
        self._servo = servo
        self._client = PointerClient(self._channel, 5.0)

    def _end(self) -> None:
        client, self._client = self._client, None
        servo, self._servo = self._servo, None
        if client is not None:
            client.close()
        if servo is not None:
            servo.stop()
