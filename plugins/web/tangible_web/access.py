"""Access control: the server answers this machine's own page alone, with strict headers."""

from starlette.requests import HTTPConnection
from starlette.responses import PlainTextResponse
from starlette.types import ASGIApp, Message, Receive, Scope, Send

POLICY = (
    "default-src 'none'; script-src 'self'; style-src 'self'; img-src 'self' data: blob:; connect-src 'self'; "
    "media-src 'self' blob:; base-uri 'none'; form-action 'none'; frame-ancestors 'none'"
)
HEADERS = {
    "content-security-policy": POLICY,
    "x-content-type-options": "nosniff",
    "referrer-policy": "no-referrer",
    "cross-origin-opener-policy": "same-origin",
    "cross-origin-resource-policy": "same-origin",
}
NEVER = "no-store"
READING = ("GET", "HEAD")


class Guarded:
    """An ASGI app that refuses foreign hosts and origins, and adds strict headers to every answer."""

    def __init__(self, app: ASGIApp, hosts: frozenset[str]) -> None:
        """hosts: all names of this server, with the port, in small letters."""
        self._app, self._hosts = app, hosts

    async def __call__(self, scope: Scope, receive: Receive, send: Send) -> None:
        """Answer a request; errors have the headers too."""
        if scope["type"] not in ("http", "websocket"):
            await self._app(scope, receive, send)
            return

        async def with_headers(message: Message) -> None:
            if message["type"] == "http.response.start":
                message = {**message, "headers": _strict(message["headers"])}
            await send(message)

        headers = HTTPConnection(scope).headers
        why = refusal_text(self._hosts, scope.get("method", ""), headers.get("host"), headers.get("origin"))
        if not why:
            await self._app(scope, receive, with_headers)
        elif scope["type"] == "websocket":
            await send({"type": "websocket.close", "code": 1008})
        else:
            await PlainTextResponse(why, 403)(scope, receive, with_headers)


def refusal_text(hosts: frozenset[str], method: str, host: str | None, origin: str | None) -> str:
    """Return why a request is refused, "" if it is not. hosts: names of the server. method: "" for a websocket."""
    if (host or "").lower() not in hosts:
        return "this address is not served"
    if method not in READING and (origin or "").lower() not in {f"http://{name}" for name in hosts}:
        return "another page may not do that"
    return ""


def _strict(headers: list[tuple[bytes, bytes]]) -> list[tuple[bytes, bytes]]:
    has_rule = any(name.lower() == b"cache-control" for name, _ in headers)
    extra = HEADERS if has_rule else {**HEADERS, "cache-control": NEVER}
    return [*headers, *((name.encode(), value.encode()) for name, value in extra.items())]
