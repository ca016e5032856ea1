"""A page in the browser as the desk of a participant: it speaks, shows no picture, and may be the device as well."""

import asyncio
import secrets
import time
from base64 import b64encode
from collections.abc import Callable, Coroutine, Iterator, Mapping, Sequence
from contextlib import ExitStack, contextmanager
from dataclasses import asdict
from importlib.resources import files
from threading import Condition, Event
from typing import Any, Self, final

import numpy as np
from starlette.requests import HTTPConnection, Request
from starlette.responses import HTMLResponse, Response
from starlette.routing import Mount, Route, Router, WebSocketRoute
from starlette.types import Receive, Scope, Send
from starlette.websockets import WebSocket

from tangible_core.data import HapticSurface
from tangible_core.errors import DeviceError
from tangible_core.mapping import placement_of
from tangible_core.pipeline import Feeling
from tangible_core.scene import middle_pixels, reduced_map, reduced_shape
from tangible_core.servo import Servo, part_number
from tangible_web.address import HOST, Address, static
from tangible_web.connection import show_key
from tangible_web.hand import Hand
from tangible_web.live import LiveTab
from tangible_web.materials import surface_facts
from tangible_web.parsing import FindRequest
from tangible_web.server import BuiltPage, ServerThread
from tangible_web.state_frame import OtherLaw, frame_without_loop, newest_frame

from .desk import LEAVE, Desk, ParticipantLeft

LAST_S = 2.0  # the longest time for which the end of a session waits for the page, s
SURFACE_S = 5.0  # the longest time for which an interval waits for the page to fetch its surface, s
NO_SURFACE: Mapping[str, Any] = {"surface": 0}
BLIND = OtherLaw(blind=True)  # the page shows no proxy, which not every force law has


def new_hand() -> Hand:
    """Return the hand of one session, by which a page is the device."""
    return Hand(f"study-{secrets.token_hex(6)}")


def hand_changes(hand: Hand) -> tuple[str, ...]:
    """Return the changes of a pipeline, `key.key=value` each, that choose this hand as its device."""
    return tuple(f"device.{key}={value}" for key, value in hand.device.items())


@final
class Page(Desk):
    """A server of the page as a context manager, and the program of its tabs: all of them move the hand."""

    def __init__(
        self, language: str, translate: Callable[[str], str], hand: Hand | None = None, sounds: Sequence[str] = ()
    ) -> None:
        """Build the page, which is served on entry. hand: moves the device from the page; None if another is felt."""
        self._language, self._text_of = language, translate
        self._stop, self._condition = Event(), Condition()
        self._events: list[dict[str, Any]] = []
        self._answer: str | None = None
        self._sounds = list(sounds)
        self._surfaces = self._fetched_number = 0
        self._surface: dict[str, Any] | None = None
        self._servo: Servo | None = None
        self._tabs: list[LiveTab] = []
        self._tasks: set[asyncio.Future[None]] = set()
        self._open = ExitStack()
        self.hand: Hand = hand or new_hand()
        self.state = self
        self.find_request: FindRequest = {"answer": answer, "surface": surface, "stop": stop}.get

    @property
    def address(self) -> str:
        """Address of the page, which is served; nobody can guess it."""
        return f"http://{HOST}:{self._address.port}/{self._address.key}/"

    @property
    def stop(self) -> Event:
        return self._stop

    def __enter__(self) -> Self:
        """Serve the page. Raises: ConfigError if it was not built."""
        self._address = self._open.enter_context(Address.of(0))
        self._server = self._open.enter_context(ServerThread(self._routes(), self._address, self.hand))
        return self

    def __exit__(self, *error: Any) -> None:
        if error[0] is None:  # a page that expects the end does not try to connect again
            self._server.post(lambda: [tab.say({"event": "ended"}) for tab in self._tabs])
        until_s = time.monotonic() + LAST_S  # the last sentence reaches the page first
        while time.monotonic() < until_s and self._server.call(lambda: any(tab.unread for tab in self._tabs)):
            time.sleep(0.01)
        self._open.__exit__(*error)

    def say(self, text: str) -> None:
        self._add(self._text_of(text), None)

    def ask(self, text: str, choices: Mapping[str, str]) -> str:
        with self._condition:
            self._answer = None
            self._add(self._text_of(text), [[key, self._text_of(meaning)] for key, meaning in choices.items()])
            while self._answer is None:
                self._condition.wait(1.0)  # so that Ctrl-C at the terminal is heard
            if self._answer == LEAVE:
                raise ParticipantLeft
            return self._answer

    @contextmanager
    def exploring(self, feeling: Feeling, servo: Servo, part: str | None) -> Iterator[None]:
        device = feeling.device
        if not device.follows(self.hand.channel):
            yield
            return
        surface = feeling.pipeline.make("surface")
        lead = None if part is None else part_number(surface, part)
        number = self._surfaces + 1
        message = surface_for_page(surface, number)
        with self._condition:
            self._surfaces, self._surface = number, message
            self._add("", None, {"surface": number, "sounds": self._sounds, "lead": lead})
            there = self._condition.wait_for(lambda: self._fetched_number >= number or self._stop.is_set(), SURFACE_S)
        try:
            if not there:
                raise DeviceError("the page of the participant does not answer; open it again")
            self.hand.open(placement_of(device))
            self._servo = servo
            yield
        finally:
            self._servo = self._surface = None
            self.hand.close()
            self._add("", None, NO_SURFACE)

    def fetch(self, number: int) -> dict[str, Any] | None:
        """Return the surface of this number as JSON data; None if it is not the present one."""
        surface = self._surface
        if surface is None or number != self._surfaces:
            return None
        with self._condition:
            self._fetched_number = number
            self._condition.notify_all()
        return surface

    def take(self, number: int, key: str) -> bool:
        """Take the answer to a question, if it is the current one and has this key."""
        with self._condition:
            question = self._events[-1] if self._events else {}
            keys = [LEAVE, *(choice for choice, _ in question.get("choices") or [])]
            if question.get("line") != number or key not in keys or self._answer is not None:
                return False
            self._answer = key
            self._condition.notify_all()
            return True

    def halt(self) -> None:
        """End the force at once; the trial is interrupted."""
        self._stop.set()
        self.hand.release()

    @property
    def running(self) -> bool:
        """True while a surface can be felt."""
        servo = self._servo
        return servo is not None and servo.running

    def greeting(self) -> dict[str, Any]:
        """Return all events so far."""
        return {"history": list(self._events)}

    def enter(self, tab: LiveTab) -> None:
        """Add a tab."""
        self._tabs.append(tab)

    def leave(self, tab: LiveTab) -> None:
        """Remove a tab, and release the hand: another tab that moves it takes it again."""
        self._tabs.remove(tab)
        self.hand.release()

    def holds(self, tab: LiveTab) -> bool:
        """Return True: every tab moves the hand."""
        return True

    def frame(self, seq: int, status: int) -> bytes | None:
        """Return the newest tick; without a surface, a hand that is nowhere."""
        servo = self._servo
        if servo is None or not servo.running:
            return frame_without_loop(seq, status)
        return newest_frame(servo, seq, status, BLIND)

    def begin(self, work: Coroutine[Any, Any, None]) -> None:
        """Run a coroutine in the background."""
        task = asyncio.ensure_future(work)
        self._tasks.add(task)
        task.add_done_callback(self._tasks.discard)

    def translate(self, event: dict[str, Any], language: str) -> dict[str, Any]:
        """Return an event as it is: its texts are in the language of the participant."""
        return event

    def _add(self, text: str, choices: list[list[str]] | None, more: Mapping[str, Any] | None = None) -> None:
        with self._condition:
            event = {"event": "said", "line": len(self._events) + 1, "text": text, "choices": choices, **(more or {})}
            self._events.append(event)
            self._condition.notify_all()
            self._server.post(lambda: [tab.say(event) for tab in self._tabs])

    def _routes(self) -> list[Mount]:
        html = files("tangible_study.desks").joinpath("page.html").read_text(encoding="utf-8")

        async def index(_: Request) -> Response:
            return HTMLResponse(html.replace("LANGUAGE", self._language))

        async def halt(_: Request) -> Response:
            """Stop, for a page whose websocket does not answer."""
            self.halt()
            return Response(status_code=204)

        async def live(socket: WebSocket) -> None:
            await LiveTab(self, socket).live()

        stop, page = Route("/stop", halt, methods=["POST"]), Mount("/", BuiltPage(directory=static()))
        router = Router([Route("/", index), stop, WebSocketRoute("/live", live), page])

        async def own(scope: Scope, receive: Receive, send: Send) -> None:
            show_key(HTTPConnection(scope))
            await router(scope, receive, send)

        return [Mount(f"/{self._address.key}", own)]


async def answer(page: Page, _: LiveTab, question: int, key: str) -> bool:
    """Answer the question of this number by a key; return whether the answer is taken."""
    return page.take(question, key)


async def surface(page: Page, _: LiveTab, which: int) -> dict[str, Any] | None:
    """Return the surface of this number; None if its interval is over."""
    return page.fetch(which)


async def stop(page: Page, _: LiveTab) -> None:
    """End the force at once."""
    page.halt()


# The most cells: the page draws nothing, and needs heights only to hold the hand over the surface.
MAX_CELLS = 200_000


def surface_for_page(surface: HapticSurface, number: int) -> dict[str, Any]:
    """Return heights, labels and materials as JSON data. number: of the surface in this session."""
    shape = reduced_shape(surface.height_m.shape, max(1.0, (surface.height_m.size / MAX_CELLS) ** 0.5))
    height_m = np.ascontiguousarray(reduced_map(surface.height_m, shape), "<f4")
    labels = None if surface.labels is None else middle_pixels(surface.labels, shape)
    materials = [{**asdict(material), "name": ""} for material in surface.materials or ()] if labels is not None else []
    return {
        "meta": surface_facts(str(number), "", height_m, surface.extent_m, labels, materials),
        "heights": b64encode(height_m.tobytes()).decode(),
        "labels": "" if labels is None else b64encode(labels.astype("<u2").tobytes()).decode(),
        "kinds": list(range(len(materials))),
    }
