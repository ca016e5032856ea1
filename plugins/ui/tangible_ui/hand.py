"""The hand that a page moves: its pointer, kept alive while the page is, and let go when it falls silent."""

import math
import time
from typing import final

from tangible_core.data import Vector
from tangible_core.errors import DeviceError
from tangible_core.mapping import WorkspaceMapping
from tangible_devices.pointer import PointerClient

from .wire import BUTTON_BITS, TAGS

SILENT_S = 0.1
"""A page that has not moved its hand for so long is taken for gone: no force."""
FARTHEST_M = 1.0
HIGH_M: Vector = (0.0, 0.0, FARTHEST_M)


@final
class Hand:
    """Moves the pointer device of this page's server."""

    def __init__(self, channel: str) -> None:
        self._channel = channel
        self.mapping = WorkspaceMapping()
        """How the picture lies under the hand."""
        self._client: PointerClient | None = None
        self._at: Vector = HIGH_M
        self._buttons = 0
        self._heard_s = -math.inf

    @property
    def holding(self) -> bool:
        """Whether a page moves it now."""
        return time.monotonic() - self._heard_s < SILENT_S

    def open(self) -> None:
        """Take hold of the device, which must be open. Raises: DeviceError."""
        self.close()
        self._client = PointerClient(self._channel, 5.0)
        self.release()

    def point(self, at: Vector, buttons: int, tag: int) -> None:
        """Where a page has it; what is not finite, or farther than a metre, is not heard."""
        if all(abs(part) < FARTHEST_M for part in at):
            self._at, self._buttons = at, (tag & TAGS) << BUTTON_BITS | buttons & 0xFF
            self._heard_s = time.monotonic()
            self._send()

    def release(self) -> None:
        """Let go: nothing is felt."""
        self._heard_s, self._at, self._buttons = -math.inf, HIGH_M, 0
        self._send()

    def keep(self) -> None:
        """Say that the server lives; a page that fell silent lets go. To be called often."""
        if self._at != HIGH_M and not self.holding:
            self.release()
        else:
            self._send()

    def close(self) -> None:
        """Leave the device."""
        if self._client is not None:
            self._client.close()
            self._client = None

    def _send(self) -> None:
        if self._client is None:
            return
        try:
            self._client.send(self._at, self._buttons)
        except DeviceError:  # the loop ended
            self.close()
