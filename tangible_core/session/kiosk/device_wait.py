"""The wait for an unplugged device: it is searched for less and less often, and each reason is reported once."""

import time
from collections.abc import Callable
from typing import final

from ..live import LOOK_EVERY_S

FIRST_PAUSE_S, LONGEST_PAUSE_S = 1.0, 8.0
"""First and longest pause between two searches for a device; each is twice as long, as a search starts a process."""


@final
class DeviceWait:
    """The reason for which a session waits, and the pause until the next search."""

    def __init__(self, notify: Callable[[str], None]) -> None:
        """notify: called with a sentence, once for each reason and when the device is back."""
        self._notify = notify
        self._reason, self._pause_s = "", FIRST_PAUSE_S

    def end(self) -> None:
        """End the wait, if there was one: the device is open."""
        if self._reason:
            self._notify("the device is back; the session goes on")
        self._reason, self._pause_s = "", FIRST_PAUSE_S

    def pause(self, why: str, end_reason: Callable[[], str]) -> str:
        """Wait until the next search for the device; return why the session ends, if it does."""
        if why != self._reason:
            self._reason = why
            self._notify(f"no force; waiting for the device: {why}")
        until_s = time.monotonic() + self._pause_s
        self._pause_s = min(2 * self._pause_s, LONGEST_PAUSE_S)
        while not (ended := end_reason()) and time.monotonic() < until_s:
            time.sleep(LOOK_EVERY_S)
        return ended
