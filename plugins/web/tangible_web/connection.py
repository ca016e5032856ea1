"""Bounded connections: strangers cannot keep the holder of the key out, and a tab that reads nothing is cut off."""

from asyncio import BaseTransport, TimerHandle
from collections.abc import Callable
from functools import partial
from typing import Any, final

import h11
from starlette.requests import HTTPConnection
from starlette.websockets import WebSocket
from uvicorn.protocols.http.h11_impl import H11Protocol
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

MAX_STRANGERS = 256  # maximum number of connections that have not shown the key
HEAD_S = 10.0  # time within which the head of a request must be complete, s
# Bytes of one read: of a flood of small messages, what is handled before anything else has its turn.
AT_ONCE_BYTES = 8192
# Interval of pings, s; a tab whose browser does not answer for twice as long is gone.
PING_S = 5.0


@final
class Strangers:
    """The connections that have not shown the key, in the order of acceptance; of too many, the oldest is cut off."""

    def __init__(self) -> None:
        self._open: dict[Any, None] = {}

    def add(self, transport: Any) -> None:
        """Add the transport of a new connection."""
        self._open[transport] = None
        if len(self._open) > MAX_STRANGERS:
            longest = next(iter(self._open))
            del self._open[longest]
            longest.abort()

    def remove(self, transport: Any) -> None:
        """Remove a connection that has shown the key, or is closed."""
        self._open.pop(transport, None)


@final
class Exchange(H11Protocol):
    """A connection for requests; it is a stranger's until one of them shows the key."""

    def __init__(self, strangers: Strangers, **options: Any) -> None:
        super().__init__(**options)
        self._strangers = strangers
        self._limit: TimerHandle | None = None

    def connection_made(self, transport: Any) -> None:
        """Note the stranger, and wait for a request."""
        super().connection_made(transport)
        self.app_state: dict[str, Any] = {**self.app_state, "show_key": partial(self._strangers.remove, transport)}
        self._strangers.add(transport)
        self._limit_head()

    def data_received(self, data: bytes) -> None:
        """Read what came, and go on waiting if the head of a request is not complete."""
        super().data_received(data)
        self._limit_head()

    def send_400_response(self, msg: str) -> None:
        """Refuse a broken request, in place of any answer to it: after a broken body, one may be under way."""
        if self.cycle is not None:
            self.cycle.disconnected = True
        try:
            super().send_400_response(msg)
        except h11.LocalProtocolError:  # an answer is sent already
            self.transport.close()

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget the connection."""
        self._end_limit()
        self._strangers.remove(self.transport)
        super().connection_lost(exc)

    def _limit_head(self) -> None:
        if self.conn.their_state is not h11.IDLE:
            self._end_limit()
        elif self._limit is None:
            self._limit = self.loop.call_later(HEAD_S, self.transport.abort)

    def _end_limit(self) -> None:
        if self._limit is not None:
            self._limit.cancel()
            self._limit = None


@final
class Connection(WebSocketsSansIOProtocol):
    """A websocket that reads little at once and can be cut off."""

    def __init__(self, strangers: Strangers, **options: Any) -> None:
        super().__init__(**options)
        self._strangers = strangers

    def connection_made(self, transport: BaseTransport) -> None:
        """Bound the reads: by default one read takes a quarter of a megabyte, thousands of messages."""
        super().connection_made(transport)
        limits: Any = transport
        limits.max_size = AT_ONCE_BYTES

    def connection_lost(self, exc: Exception | None) -> None:
        """Forget the connection."""
        self._strangers.remove(self.transport)
        super().connection_lost(exc)

    def send_receive_event_to_app(self) -> None:
        """Hand a message on; close the connection for a text that is not UTF-8, of which uvicorn logs a traceback."""
        if self.curr_msg_data_type == "text" and not self.close_sent:
            self.frames[:] = [b"".join(self.frames)]
            try:
                self.frames[0].decode()
            except UnicodeDecodeError:
                self.conn.fail(1007)
                self.handle_parser_exception()
        super().send_receive_event_to_app()  # which drops what comes after a close

    async def run_asgi(self) -> None:
        """Run the app, with a function that cuts the connection off: a regular close first reads all that waits."""
        scope: Any = self.scope
        scope["state"]["cut_off"] = self.transport.abort
        await super().run_asgi()

    def keepalive_timeout(self) -> None:
        """Cut the connection off: nobody would read the rest."""
        super().keepalive_timeout()
        self.transport.abort()


def show_key(connection: HTTPConnection) -> None:
    """Note that a connection belongs to the holder of the key."""
    note_key: Callable[[], None] = connection.scope["state"]["show_key"]
    note_key()


def cut_off(socket: WebSocket) -> None:
    """End a connection at once, whatever waits to be sent."""
    end: Callable[[], None] = socket.scope["state"]["cut_off"]
    end()
