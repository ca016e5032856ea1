"""A participant's page without a browser: a websocket that hears what is said, answers, and moves the hand."""

from typing import Any

from websockets.sync.client import connect

from page_server import TestTab
from tangible_study.desks.page import Page
from tangible_web.framing import ACK, ACK_FRAME, BEAT_FRAME, POINTER, POINTER_FRAME, RELEASE, RELEASE_FRAME, STATE_FRAME


class Participant(TestTab):
    """A tab of a participant's page."""

    def __init__(self, page: Page) -> None:
        address = f"ws{page.address.removeprefix('http')}live"
        origin: Any = page.address.rpartition("/")[0].rpartition("/")[0]
        super().__init__(connect(address, origin=origin, compression=None, max_size=None, proxy=None))
        self._waiting: list[dict[str, Any]] = self.until(event="hello")["history"]

    def hear(self) -> dict[str, Any]:
        """The next event of the program."""
        return self._waiting.pop(0) if self._waiting else self.until(event="said")

    def ask(self, name: Any, **told: Any) -> Any:
        """Send a request, and return its answer; what is said meanwhile is heard afterwards."""
        super().ask(name, **told)
        while (event := self.next() or {})["event"] == "said":
            self._waiting.append(event)
        assert event["event"] == "answer", event
        return event["value"]

    def answer(self, question: dict[str, Any], key: str) -> bool:
        """Answer a question, and return whether that is taken."""
        return self.ask("answer", question=question["line"], key=key)

    def begin(self) -> dict[str, Any]:
        """Fetch the surface as the page does, and return the event that told of it."""
        while not (event := self.hear()).get("surface"):
            pass
        assert self.ask("surface", which=event["surface"])
        return event

    def press(self) -> float:
        """Press in the middle of the surface; return the force of the next state, newtons."""
        self.socket.send(POINTER_FRAME.pack(POINTER, 1, 7, 0.0, 0.0, 0.0, 0.002))
        self.socket.send(ACK_FRAME.pack(ACK, 2**32 - 1))  # all that came so far
        while not isinstance(state := self.socket.recv(), bytes) or state == BEAT_FRAME:
            pass
        return STATE_FRAME.unpack(state)[15]

    def release(self) -> None:
        """Let the hand go."""
        self.socket.send(RELEASE_FRAME.pack(RELEASE))
