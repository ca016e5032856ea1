"""One tab's websocket: the newest state out, never more than it draws; its hand and its asks in."""

import asyncio
import json
import math
from contextlib import suppress
from typing import Any, final

from starlette.websockets import WebSocket, WebSocketDisconnect

from tangible_core.errors import TangibleError

from .asks import ASKS
from .desk import Desk
from .wire import (
    ACK,
    ACK_FRAME,
    HOLDING,
    POINTER,
    POINTER_FRAME,
    RECORDING,
    RELEASE,
    RELEASE_FRAME,
    RUNNING,
    VERSION,
)

IN_FLIGHT = 2
"""States that a tab has not drawn yet; more would only queue up in the browser."""
HZ = 60
MOST_WAITING = 2000
"""Events that a tab may leave unread; one that reads none is closed."""


@final
class LiveTab:
    """A tab that is connected."""

    def __init__(self, desk: Desk, socket: WebSocket) -> None:
        self._desk, self._socket = desk, socket
        self._events: asyncio.Queue[str] = asyncio.Queue(MOST_WAITING)
        self._seq = self._drawn = 0
        self._acked = asyncio.Event()

    def say(self, event: dict[str, Any]) -> None:
        """Tell it something; one that does not listen is closed."""
        try:
            self._events.put_nowait(json.dumps(event, allow_nan=False, default=str))
        except asyncio.QueueFull:
            self._desk.begin(self._socket.close(1013))
        except ValueError:
            self._events.put_nowait(json.dumps(_without_nan(event), default=str))

    async def live(self) -> None:
        """Until it is closed."""
        await self._socket.accept()
        self.say({"event": "hello", "version": VERSION, "history": self._desk.history, "scene": self._desk.scene})
        self._desk.enter(self)
        senders = [asyncio.create_task(self._send_states()), asyncio.create_task(self._send_events())]
        try:
            while True:
                await self._take(await self._socket.receive())
        except WebSocketDisconnect:
            pass
        finally:
            self._desk.leave(self)
            for each in senders:
                each.cancel()

    async def _take(self, message: Any) -> None:
        if message["type"] == "websocket.disconnect":
            raise WebSocketDisconnect
        if body := message.get("bytes"):
            self._frame(body)
        elif text := message.get("text"):
            self._desk.begin(self._answer(text))

    def _frame(self, body: bytes) -> None:
        """A frame that is no whole one of a known kind is not heard."""
        kind, hand = body[0], self._desk.feeling.hand
        if kind == ACK and len(body) == ACK_FRAME.size:
            self._drawn = max(self._drawn, min(ACK_FRAME.unpack(body)[1], self._seq))
            self._acked.set()
        elif kind == POINTER and len(body) == POINTER_FRAME.size and self._desk.holder is self:
            _, buttons, tag, _, x, y, z = POINTER_FRAME.unpack(body)
            hand.point((x, y, z), buttons, tag)
        elif kind == RELEASE and len(body) == RELEASE_FRAME.size and self._desk.holder is self:
            hand.release()

    async def _answer(self, text: str) -> None:
        """Do what it asks for, and answer with its number."""
        try:
            said = json.loads(text)
            number, name = said.pop("number"), said.pop("ask")
            ask = ASKS[name]
        except (ValueError, KeyError, AttributeError, TypeError):
            return
        try:
            found = await ask(self._desk, self, **said)
        except TangibleError as error:
            self.say({"event": "refused", "number": number, "text": str(error)})
        except Exception as error:  # noqa: BLE001 - whatever a plugin raises is for the page to say
            self.say({"event": "refused", "number": number, "text": f"{type(error).__name__}: {error}"})
        else:
            self.say({"event": "answer", "number": number, "value": found})

    async def _send_events(self) -> None:
        with suppress(WebSocketDisconnect, RuntimeError):
            while True:
                await self._socket.send_text(await self._events.get())

    async def _send_states(self) -> None:
        loop, due = asyncio.get_running_loop(), 0.0
        with suppress(WebSocketDisconnect, RuntimeError):
            while True:
                due = max(due + 1 / HZ, loop.time())
                await asyncio.sleep(due - loop.time())
                while self._seq - self._drawn >= IN_FLIGHT:
                    self._acked.clear()
                    await self._acked.wait()
                if frame := self._desk.feeling.frame(self._seq + 1, self._status(), self._desk.laws.beside()):
                    self._seq += 1
                    await self._socket.send_bytes(frame)

    def _status(self) -> int:
        recorder = self._desk.recorder
        recording = recorder is not None and recorder.recording
        return RUNNING * self._desk.feeling.running | HOLDING * (self._desk.holder is self) | RECORDING * recording


def _without_nan(value: Any) -> Any:
    """JSON knows no NaN: null stands for it."""
    if isinstance(value, float):
        return value if math.isfinite(value) else None
    if isinstance(value, dict):
        return {key: _without_nan(each) for key, each in value.items()}
    if isinstance(value, list | tuple):
        return [_without_nan(each) for each in value]
    return value
