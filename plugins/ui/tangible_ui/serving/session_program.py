"""The session as its tabs use it: their events, requests, and the hand."""

from collections.abc import Coroutine
from typing import Any, final

from tangible_web.framing import RECORDING
from tangible_web.hand import Hand
from tangible_web.live import LiveTab
from tangible_web.parsing import Request

from ..requests import find_request
from ..state.session import Session
from .translating import in_language, language_of


@final
class SessionProgram:
    """The program behind the page of `tangible ui`."""

    def __init__(self, session: Session) -> None:
        self.state: Session = session
        self.hand: Hand = session.feeling.hand

    def find_request(self, name: str, /) -> Request:
        """Return what answers a request of this name: the server, or else the worker, which may refuse it."""
        return find_request(name)

    @property
    def running(self) -> bool:
        """True while forces are given."""
        return self.state.feeling.running

    def greeting(self) -> dict[str, Any]:
        """Return what happened before, the surface, and whether no file was opened yet."""
        session = self.state
        empty = session.waits_for_file and not session.document.text
        return {"history": session.tabs.history, "scene": session.tabs.scene, "empty": empty}

    def enter(self, tab: LiveTab) -> None:
        """Add a tab; it gets the hand if no other tab holds it."""
        self.state.tabs.enter(tab)

    def leave(self, tab: LiveTab) -> None:
        """Remove a tab; a hand that it held is released."""
        self.state.tabs.leave(tab)

    def holds(self, tab: LiveTab) -> bool:
        """Return True if this tab moves the hand."""
        return self.state.tabs.holder is tab

    def frame(self, seq: int, status: int) -> bytes | None:
        """Return the newest tick, with the force of a second law and whether ticks are recorded."""
        recorder = self.state.recorder
        recording = recorder is not None and recorder.recording
        return self.state.feeling.frame(seq, status | RECORDING * recording, self.state.laws.other_law())

    def begin(self, work: Coroutine[Any, Any, None]) -> None:
        """Run a coroutine in the background; its errors are sent to all tabs."""
        self.state.begin(work)

    def translate(self, event: dict[str, Any], language: str) -> dict[str, Any]:
        """Return an event in the language of a tab."""
        return in_language(event, language_of(language))
