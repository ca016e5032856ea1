"""The hand that a page moves: its pointer, kept alive while the page is, and let go when it falls silent."""

import math
import time
from typing import NamedTuple, final

from tangible_core.data import Vector
from tangible_core.errors import DeviceError
from tangible_core.mapping import Placement
from tangible_devices.pointer import PointerClient

from ..framing import BUTTON_BITS, TAGS

SILENT_S = 0.1
"""A page that has not moved its hand for so long is taken for gone: no force."""
FARTHEST_M = 1.0
OPENING_S = 1.0
"""A loop that runs has opened its device long ago."""
HIGH_M: Vector = (0.0, 0.0, FARTHEST_M)
"""Where the hand is that nobody holds: in the picture's frame, over every surface."""
CLEAR_M = 0.5
"""A pointer that nobody holds is at least so high in the picture, or it is held there from here."""


class Held(NamedTuple):
    """A hand that was let go of is high."""

    at: Vector = HIGH_M
    """In the picture's frame, metres."""
    buttons: int = 0
    heard_s: float = -math.inf


NOBODY = Held()


@final
class Hand:
    """Moves the pointer device of this page's server. The page says places of the picture, the pointer is told those
    of its own frame, which lie under them by the document's mapping: the loop feels at the place that the page said.
    """

    def __init__(self, channel: str) -> None:
        self._channel = channel
        self._to = Placement()
        self._client: PointerClient | None = None
        self._held = NOBODY

    @property
    def holding(self) -> bool:
        """Whether a page moves it now."""
        return time.monotonic() - self._held.heard_s < SILENT_S

    def open(self, to: Placement) -> None:
        """Take hold of the device, which must be open; to: how the picture lies under it. Raises: DeviceError."""
        self.close()
        self._to = to
        self._client = PointerClient(self._channel, OPENING_S)
        self.release()

    def point(self, at: Vector, buttons: int, tag: int) -> None:
        """Where a page has it; what is not finite, or farther than a metre, is not heard."""
        if all(abs(part) < FARTHEST_M for part in at):
            self._held = Held(at, (tag & TAGS) << BUTTON_BITS | buttons & 0xFF, time.monotonic())
            self._send()

    def release(self) -> None:
        """Let go: nothing is felt from the next tick on."""
        self._held = NOBODY
        self._send()

    def keep(self) -> None:
        """Say that the server lives; a page that fell silent lets go. To be called often."""
        if self._held is not NOBODY and not self.holding:
            self.release()
        else:
            self._send()

    def close(self) -> None:
        """Leave the device."""
        client, self._client = self._client, None
        if client is not None:
            client.close()

    def _send(self) -> None:
        """Another thread may close it meanwhile, and the loop may end."""
        if (client := self._client) is None:
            return
        held = self._held
        try:
            if held is NOBODY and high_without_client(self._to):
                client.release()
            else:
                client.send(self._to.under_hand(held.at), held.buttons)
        except DeviceError:
            if self._client is client:
                self.close()


def high_without_client(to: Placement) -> bool:
    """Whether a pointer without a client, a metre up in its own frame, is over every surface in the picture's: much
    enlarged, or lifted, that metre may be inside it.
    """
    return (FARTHEST_M - to.offset_z_m) / to.scale >= CLEAR_M
