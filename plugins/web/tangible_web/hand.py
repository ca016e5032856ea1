"""The page's hand: the pointer device of this server, kept alive with the page, released when the page falls silent."""

import math
import time
from typing import Any, NamedTuple, final

from tangible_core.data import Vector
from tangible_core.errors import DeviceError
from tangible_core.mapping import Placement
from tangible_core.servo import PAGE_FOLLOW_S, PAGE_SERVER_SILENCE_S, PAGE_SILENCE_S
from tangible_devices.pointer import PointerClient

from .framing import BUTTON_BITS, TAGS

FARTHEST_M = 1.0
KEEP_S = 0.01  # interval at which a program polls `Hand.keep`, s
# Longest wait for the pointer's channel, s; a running loop has opened its device long before.
OPENING_S = 1.0
HIGH_M: Vector = (0.0, 0.0, FARTHEST_M)
"""Position of a released hand in the picture's frame, above every surface."""
# Minimum height of a released pointer in the picture, m; a lower one is held up from here.
CLEAR_M = 0.5


class HandPosition(NamedTuple):
    """A position of the hand; by default high above, which is a released hand."""

    at: Vector = HIGH_M
    buttons: int = 0
    heard_s: float = -math.inf


NOBODY = HandPosition()


@final
class Hand:
    """The client of this server's pointer device; positions are those in the picture."""

    def __init__(self, channel: str) -> None:
        self.channel = channel
        self._to = Placement()
        self._client: PointerClient | None = None
        self._position = NOBODY

    @property
    def device(self) -> dict[str, Any]:
        """The device that this hand moves, as a pipeline file writes it."""
        return {
            "use": "pointer",
            "channel": self.channel,
            "stale_after_s": PAGE_SERVER_SILENCE_S,
            "follow_s": PAGE_FOLLOW_S,
        }

    @property
    def holding(self) -> bool:
        """True while a page moves the hand."""
        return time.monotonic() - self._position.heard_s < PAGE_SILENCE_S

    def open(self, to: Placement) -> None:
        """Connect to the device, which must be open. to: the picture's place under it. Raises: DeviceError."""
        self.close()
        self._to = to
        self._client = PointerClient(self.channel, OPENING_S)
        self.release()

    def point(self, at: Vector, buttons: int, tag: int) -> None:
        """Move the hand to where a page has it; ignored if not finite, or farther than a metre."""
        if all(abs(part) < FARTHEST_M for part in at):
            self._position = HandPosition(at, (tag & TAGS) << BUTTON_BITS | buttons & 0xFF, time.monotonic())
            self._send()

    def release(self) -> None:
        """Release the hand: no force from the next tick on."""
        self._position = NOBODY
        self._send()

    def keep(self) -> None:
        """Tell the loop that the server lives; release the hand of a page that fell silent. Meant to be polled."""
        if self._position is not NOBODY and not self.holding:
            self.release()
        else:
            self._send()

    def close(self) -> None:
        """Disconnect from the device."""
        client, self._client = self._client, None
        if client is not None:
            client.close()

    def _send(self) -> None:
        """Send the position; another thread may disconnect meanwhile, and the loop may end."""
        if (client := self._client) is None:
            return
        position = self._position
        try:
            if position is NOBODY and high_without_client(self._to):
                client.release()
            else:
                client.send(self._to.under_hand(position.at), position.buttons)
        except DeviceError:
            if self._client is client:
                self.close()


def high_without_client(to: Placement) -> bool:
    """Return True if a pointer without a client, a metre up in its own frame, is above every surface."""
    return (FARTHEST_M - to.offset_z_m) / to.scale >= CLEAR_M
