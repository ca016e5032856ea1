"""The pages in browsers: what they hear of, and which of them moves the hand."""

import time
from collections import deque
from collections.abc import Callable
from typing import Any, Protocol, final, runtime_checkable

MAX_HISTORY, MAX_LOGGED = 500, 200  # numbers of past events and of log lines that a tab opened later gets
# Events that describe a state: only the latest of each counts, and it is kept however many other events follow.
LATEST_ONLY = frozenset(
    {"restored", "document", "plan", "materials", "preflight", "legible", "exported", "beacon", "described"}
) | {"maker", "maker_gone", "opening", "fetching"}


@runtime_checkable
class Tab(Protocol):
    """A page in a browser."""

    def say(self, event: dict[str, Any]) -> None:
        """Send an event without waiting."""


@final
class Tabs:
    """All tabs of a session, and the events that they get."""

    def __init__(self, release: Callable[[], None]) -> None:
        """release: releases the hand, before another tab or none moves it."""
        self._release = release
        self.open: list[Tab] = []
        self.holder: Tab | None = None
        """The tab that moves the hand."""
        self.scene: dict[str, Any] | None = None
        self._latest: dict[str, dict[str, Any]] = {}
        """The latest event of each kind in `LATEST_ONLY`."""
        self._history: deque[dict[str, Any]] = deque(maxlen=MAX_HISTORY)
        self._log: deque[dict[str, Any]] = deque(maxlen=MAX_LOGGED)

    def tell(self, event: str, **payload: Any) -> None:
        """Send an event to all tabs, and to those opened later."""
        message = {"event": event, "at_s": round(time.time(), 3), **payload}
        if event == "scene":
            self.scene = message
        elif event in LATEST_ONLY:
            self._latest[event] = message
        else:
            (self._log if event == "log" else self._history).append(message)
        for tab in list(self.open):
            tab.say(message)

    @property
    def history(self) -> list[dict[str, Any]]:
        """The events that a tab opened now has missed, oldest first; however much is logged, the rest is there."""
        return sorted([*self._latest.values(), *self._history, *self._log], key=lambda message: message["at_s"])

    def enter(self, tab: Tab) -> None:
        """Add a tab; it gets the hand if no other tab holds it."""
        self.open.append(tab)
        if self.holder is None:
            self.hold(tab)
        else:
            self._say_who_holds()

    def leave(self, tab: Tab) -> None:
        """Remove a tab that is gone; its hand is free: a mouse may lie pressed on a page that nobody looks at."""
        self.open.remove(tab)
        if self.holder is tab:
            self.hold(None)

    def hold(self, tab: Tab | None) -> None:
        """Give the hand to this tab, or to none; the others watch."""
        self._release()
        self.holder = tab
        self._say_who_holds()

    def _say_who_holds(self) -> None:
        for tab in self.open:
            tab.say({"event": "holding", "holding": tab is self.holder, "free": self.holder is None})
