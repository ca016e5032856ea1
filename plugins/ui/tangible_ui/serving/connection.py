"""A bounded websocket connection of uvicorn: small reads, and a way to cut off a tab that reads nothing."""

from asyncio import BaseTransport
from collections.abc import Callable
from typing import Any, final

from starlette.websockets import WebSocket
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

AT_ONCE_BYTES = 8192
"""Bytes of one read: of a flood of small messages, what is handled before anything else has its turn."""
PING_S = 5.0
"""Interval of pings, s; a tab whose browser does not answer for twice as long is gone."""


@final
class Connection(WebSocketsSansIOProtocol):
    """A connection that reads little at once and can be cut off."""

    def connection_made(self, transport: BaseTransport) -> None:
        """Bound the reads: by default one read takes a quarter of a megabyte, thousands of messages."""
        super().connection_made(transport)
        bounded: Any = transport
        bounded.max_size = AT_ONCE_BYTES

    async def run_asgi(self) -> None:
        """Run the app, with a function that cuts the connection off: a regular close first reads all that waits."""
        scope: Any = self.scope
        scope["state"]["cut_off"] = self.transport.abort
        await super().run_asgi()

    def keepalive_timeout(self) -> None:
        """Cut the connection off: nobody would read the rest."""
        super().keepalive_timeout()
        self.transport.abort()


def cut_off(socket: WebSocket) -> None:
    """End a connection at once, whatever waits to be sent."""
    end: Callable[[], None] = socket.scope["state"]["cut_off"]
    end()
