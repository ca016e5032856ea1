"""A participant's own hand on the page: it moves the device `pointer`, and hears and reads what the force loop does."""

import secrets
from collections.abc import Iterator
from contextlib import contextmanager
from threading import Event, Thread
from typing import final

from tangible_core.mapping import placement_of
from tangible_core.plugins.interfaces import HapticDevice
from tangible_core.servo import Servo
from tangible_core.servo.limits import PAGE_FOLLOW_S, PAGE_SERVER_SILENCE_S
from tangible_web.framing import HOLDING, POINTER, POINTER_FRAME, RELEASE, RUNNING
from tangible_web.hand import Hand
from tangible_web.state_frame import OtherLaw, frame_of, frame_without_loop

KEEP_S = 0.02
"""Interval at which the loop hears from this program; it releases the hand after `PAGE_SERVER_SILENCE_S` without."""
BLIND = OtherLaw(blind=True)
"""The page shows no proxy, which not every force law has."""


@final
class PageHand:
    """The hand of one session: the channel of its device, and the loop that it is in."""

    def __init__(self) -> None:
        self.channel: str = f"study-{secrets.token_hex(6)}"
        self._hand = Hand(self.channel)
        self._servo: Servo | None = None
        self._seq = 0

    @property
    def device(self) -> tuple[str, ...]:
        """Changes of a pipeline, `key.key=value` each, that choose this hand as its device."""
        return (
            "device.use=pointer",
            f"device.channel={self.channel}",
            f"device.stale_after_s={PAGE_SERVER_SILENCE_S}",
            f"device.follow_s={PAGE_FOLLOW_S}",
        )

    def moves(self, device: HapticDevice) -> bool:
        """Return True if a device is this hand's pointer."""
        return device.follows(self.channel)

    @contextmanager
    def within(self, servo: Servo, device: HapticDevice) -> Iterator[None]:
        """Hold the device of a loop while the block lasts; it is released at the end. Raises: DeviceError."""
        self._hand.open(placement_of(device))
        self._servo, over = servo, Event()
        keeper = Thread(target=self._keep, args=(over,), daemon=True)
        keeper.start()
        try:
            yield
        finally:
            over.set()
            keeper.join()
            self._servo = None
            self._hand.close()

    def take(self, message: bytes) -> bytes:
        """Take a position or a release from the page, and return the state of the loop; no bytes for anything else."""
        kind = message[:1]
        if kind == bytes([POINTER]) and len(message) == POINTER_FRAME.size:
            _, buttons, tag, _, x, y, z = POINTER_FRAME.unpack(message)
            self._hand.point((x, y, z), buttons, tag)
        elif message == bytes([RELEASE]):
            self._hand.release()
        else:
            return b""
        self._seq += 1
        servo = self._servo
        if servo is None or not servo.running:
            return frame_without_loop(self._seq, 0)
        return frame_of(servo, self._seq, RUNNING | HOLDING, BLIND) or b""

    def _keep(self, over: Event) -> None:
        while not over.wait(KEEP_S):
            self._hand.keep()
