"""A websocket's connection as uvicorn has it, bounded: what a tab sends at once, and one that reads nothing."""

from asyncio import BaseTransport
from collections.abc import Callable
from typing import Any, final

from starlette.websockets import WebSocket
from uvicorn.protocols.websockets.websockets_sansio_impl import WebSocketsSansIOProtocol

AT_ONCE_BYTES = 8192
"""Read in one go: of a flood of small messages, what is handled before anything else has its turn."""
PING_S = 5.0
"""A tab whose browser does not answer for twice as long is gone, though nobody said so."""


@final
class Connection(WebSocketsSansIOProtocol):
    """Reads little at once, and can be cut off."""

    def connection_made(self, transport: BaseTransport) -> None:
        """By default a quarter of a megabyte is read in one go: thousands of messages."""
        super().connection_made(transport)
        bounded: Any = transport
        bounded.max_size = AT_ONCE_BYTES

    async def run_asgi(self) -> None:
        """With a way to cut it off: to close it, everything that waits would have to be read first."""
        scope: Any = self.scope
        scope["state"]["cut_off"] = self.transport.abort
        await super().run_asgi()

    def keepalive_timeout(self) -> None:
        """Nobody is there who would read the rest."""
        super().keepalive_timeout()
        self.transport.abort()


def cut_off(socket: WebSocket) -> None:
    """End a connection at once, whatever waits to be sent."""
    end: Callable[[], None] = socket.scope["state"]["cut_off"]
    end()
