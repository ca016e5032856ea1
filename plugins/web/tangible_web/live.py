"""A tab's websocket: sends the newest state, never more than the tab draws; receives its hand and its requests."""

import asyncio
import json
import math
from collections.abc import Coroutine
from contextlib import suppress
from typing import Any, Protocol, final

from starlette.websockets import WebSocket, WebSocketDisconnect

from tangible_core.errors import TangibleError
from tangible_core.plugins.failures import sentence

from . import framing
from .connection import cut_off
from .hand import Hand
from .parsing import BadRequest, ParsedRequest, Request, parse

# Maximum number of states that a tab has not drawn yet; more would only queue up in the browser.
IN_FLIGHT = 2
PAUSE_S = 0.01
"""Pause from a drawn state to the next one, s. A state sent at once would wait in a busy browser until the frame after
next, and show where the hand was; a screen draws every 17 ms."""
SPACING_S = 0.012  # minimum time between two states, s; a screen draws sixty a second
# Minimum time between two states without force, s: nothing moves, and loop and surface need the processor to start.
IDLE_SPACING_S = 0.1
# Longest time without an event or a beat, s: a page that hears nothing for three times as long says so.
BEAT_S = 1.0
# Limits of unread events, in number and characters; a tab that reads none is cut off.
MAX_WAITING, MAX_WAITING_CHARACTERS = 2000, 16_000_000
# Maximum number of requests that a tab may wait for at once; `stop` is always taken.
MAX_ASKS = 32


class Program(Protocol):
    """Views and pointers of the tabs of a page; used in the event loop's thread alone."""

    def find_request(self, name: str, /) -> Request | None:
        """Return what answers a request of this name; None if nothing does."""
        ...

    @property
    def state(self) -> Any:
        """First argument of every request."""
        ...

    @property
    def hand(self) -> Hand:
        """The hand, which the tab that holds it moves."""
        ...

    @property
    def running(self) -> bool:
        """True while forces are given."""
        ...

    def greeting(self) -> dict[str, Any]:
        """Return the values of the first event of a tab."""
        ...

    def enter(self, tab: "LiveTab") -> None:
        """Add a tab."""
        ...

    def leave(self, tab: "LiveTab") -> None:
        """Remove a tab that was closed or is gone."""
        ...

    def holds(self, tab: "LiveTab") -> bool:
        """Return True if this tab moves the hand."""
        ...

    def frame(self, seq: int, status: int) -> bytes | None:
        """Return the newest tick as a STATE frame with this status; None if it was overwritten."""
        ...

    def begin(self, work: Coroutine[Any, Any, None]) -> None:
        """Run a coroutine in the background."""
        ...

    def translate(self, event: dict[str, Any], language: str) -> dict[str, Any]:
        """Return an event in the language of a tab."""
        ...


@final
class LiveTab:
    """A connected tab."""

    def __init__(self, program: Program, socket: WebSocket) -> None:
        self._program, self._socket = program, socket
        self._language = socket.query_params.get("language", "")
        self._events: asyncio.Queue[str] = asyncio.Queue()
        self._waiting = self._asks = 0
        self._seq = self._last_drawn = 0
        self._new_ack = asyncio.Event()
        self._is_gone = False

    @property
    def unread(self) -> bool:
        """True while events wait to be sent."""
        return self._waiting > 0

    def say(self, event: dict[str, Any]) -> None:
        """Send an event; a tab that does not read is cut off."""
        if self._is_gone:
            return
        text = _as_json(self._program.translate(event, self._language))
        self._waiting += len(text)
        if self._events.qsize() >= MAX_WAITING or self._waiting > MAX_WAITING_CHARACTERS:
            self._is_gone = True
            cut_off(self._socket)
        else:
            self._events.put_nowait(text)

    async def live(self) -> None:
        """Serve the tab until it is closed."""
        await self._socket.accept()
        self.say({"event": "hello", "version": framing.VERSION, **self._program.greeting()})
        self._program.enter(self)
        try:
            with suppress(WebSocketDisconnect):
                async with asyncio.TaskGroup() as group:
                    senders = [group.create_task(self._send_states()), group.create_task(self._send_events())]
                    await self._hear()
                    for sender in senders:
                        sender.cancel()
        finally:
            self._is_gone = True
            self._program.leave(self)

    async def _hear(self) -> None:
        while (message := await self._socket.receive())["type"] != "websocket.disconnect":
            if body := message.get("bytes"):
                self._handle_frame(body)
            elif text := message.get("text"):
                self._begin_request(text)

    def _handle_frame(self, body: bytes) -> None:
        """Handle a binary frame; one that is incomplete or of an unknown kind is ignored."""
        kind, hand = body[0], self._program.hand
        if kind == framing.ACK and len(body) == framing.ACK_FRAME.size:
            self._last_drawn = max(self._last_drawn, min(framing.ACK_FRAME.unpack(body)[1], self._seq))
            self._new_ack.set()
        elif kind == framing.POINTER and len(body) == framing.POINTER_FRAME.size and self._program.holds(self):
            _, buttons, tag, _, x, y, z = framing.POINTER_FRAME.unpack(body)
            hand.point((x, y, z), buttons, tag)
        elif kind == framing.RELEASE and len(body) == framing.RELEASE_FRAME.size and self._program.holds(self):
            hand.release()

    def _begin_request(self, text: str) -> None:
        """Begin a request, or refuse it with a sentence."""
        try:
            request = parse(text, self._program.find_request)
        except BadRequest as error:
            self._refuse(error.number, str(error))
            return
        if self._asks < MAX_ASKS or request.name == "stop":
            self._asks += 1
            self._program.begin(self._answer(request))
        else:
            self._refuse(request.number, f"{MAX_ASKS} requests are not done yet; wait for them")

    async def _answer(self, request: ParsedRequest) -> None:
        try:
            value = await request.ask(self._program.state, self, **request.arguments)
        except Exception as error:  # noqa: BLE001 - whatever a plugin raises is for the page to say
            self._refuse(request.number, await describe_error(error))
        else:
            self.say({"event": "answer", "number": request.number, "value": value})
        finally:
            self._asks -= 1

    def _refuse(self, number: int | None, text: str) -> None:
        self.say({"event": "refused", "number": number, "text": text})

    async def _send_events(self) -> None:
        with suppress(WebSocketDisconnect, RuntimeError):
            while True:
                try:
                    text = await asyncio.wait_for(self._events.get(), BEAT_S)
                except TimeoutError:
                    await self._socket.send_bytes(framing.BEAT_FRAME)
                    continue
                self._waiting -= len(text)
                await self._socket.send_text(text)

    async def _send_states(self) -> None:
        """Send the newest state soon after one was drawn, as late as it still arrives before the page draws again."""
        loop, sent_s, idle = asyncio.get_running_loop(), 0.0, False
        with suppress(WebSocketDisconnect, RuntimeError):
            while True:
                while self._seq - self._last_drawn >= IN_FLIGHT:
                    self._new_ack.clear()
                    await self._new_ack.wait()
                    await asyncio.sleep(PAUSE_S)
                await asyncio.sleep(sent_s + SPACING_S - loop.time())
                while idle and not self._program.running and loop.time() < sent_s + IDLE_SPACING_S:
                    await asyncio.sleep(SPACING_S)
                sent_s, idle = loop.time(), not self._program.running
                holding = framing.HOLDING * self._program.holds(self)
                if frame := self._program.frame(self._seq + 1, framing.RUNNING * self._program.running | holding):
                    self._seq += 1
                    await self._socket.send_bytes(frame)


async def describe_error(error: BaseException) -> str:
    """Return the sentence that a page shows for an error; of one that nobody foresaw, a file gets the traceback."""
    return str(error) if isinstance(error, TangibleError) else await asyncio.to_thread(sentence, error)


def _as_json(event: dict[str, Any]) -> str:
    try:
        return json.dumps(event, allow_nan=False, default=str)
    except ValueError:
        return json.dumps(_without_nan(event), default=str)


def _without_nan(value: Any) -> Any:
    """Replace NaN by None: JSON has no NaN."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: _without_nan(item) for key, item in value.items()}
    if isinstance(value, list | tuple):
        return [_without_nan(item) for item in value]
    return value
