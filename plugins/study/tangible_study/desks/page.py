"""A page in the browser as the desk of a participant: it speaks and shows no picture, and answers by keys."""

import json
import secrets
from collections.abc import Callable, Mapping
from contextlib import suppress
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from threading import Condition, Event, Thread
from types import TracebackType
from typing import Any, Self, final
from urllib.parse import parse_qs, urlsplit

from .desk import LEAVE, Desk, Left

HOST = "127.0.0.1"
"""The address of this computer alone: no other one reaches the page."""
POLL_S = 20.0
"""The longest time for which a request of the page waits for something to say, s."""
LAST_S = 2.0
"""The longest time for which the end of a session waits for the page, s."""
MOST_BYTES = 1000
"""The most bytes of an answer."""
POLICY = "default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; connect-src 'self'"


@final
class Page(Desk):
    """A server of the page, as a context manager. Reloading the page goes on with the current question."""

    def __init__(self, language: str, translate: Callable[[str], str]) -> None:
        """language: of the participant. translate: to that language.

        The page does not show the title of a study, which may name conditions.
        """
        self._translate, self._stop, self._changed = translate, Event(), Condition()
        self._events: list[dict[str, Any]] = []
        self._answer: str | None = None
        self._fetched = 0
        self._token = secrets.token_urlsafe(16)
        html = files("tangible_study.desks").joinpath("page.html").read_text(encoding="utf-8")
        self.html: str = html.replace("LANGUAGE", language)
        self._server = ThreadingHTTPServer((HOST, 0), _handler(self, self._token))
        self._server.daemon_threads = True
        self._thread = Thread(target=self._server.serve_forever, daemon=True)

    @property
    def address(self) -> str:
        """Address of the page; nobody can guess it."""
        return f"http://{HOST}:{self._server.server_port}/{self._token}/"

    @property
    def stop(self) -> Event:
        """An event that Esc and the stop button set."""
        return self._stop

    def __enter__(self) -> Self:
        self._thread.start()
        return self

    def __exit__(
        self, kind: type[BaseException] | None, error: BaseException | None, trace: TracebackType | None
    ) -> None:
        with self._changed:  # the last sentence reaches the page first
            self._changed.wait_for(lambda: self._fetched >= len(self._events), LAST_S)
        self._server.shutdown()
        self._server.server_close()

    def say(self, text: str) -> None:
        """Say a text on the page."""
        self._add(self._translate(text), None)

    def ask(self, text: str, choices: Mapping[str, str]) -> str:
        """Ask on the page, and wait for one of the keys."""
        with self._changed:
            self._answer = None
            self._add(self._translate(text), [[key, self._translate(meaning)] for key, meaning in choices.items()])
            while self._answer is None:
                self._changed.wait(1.0)  # so that Ctrl-C at the terminal is heard
            if self._answer == LEAVE:
                raise Left
            return self._answer

    def _add(self, text: str, choices: list[list[str]] | None) -> None:
        with self._changed:
            self._events.append({"number": len(self._events) + 1, "text": text, "choices": choices})
            self._changed.notify_all()

    def events_after(self, number: int) -> list[dict[str, Any]]:
        """Return the events after a number, once there are any; [] after POLL_S."""
        with self._changed:
            self._fetched = max(self._fetched, number)
            self._changed.notify_all()
            self._changed.wait_for(lambda: len(self._events) > number, POLL_S)
            return self._events[number:]

    def take(self, number: int, key: str) -> bool:
        """Take the answer to a question, if it is the current one and has this key."""
        with self._changed:
            question = self._events[-1] if self._events else {}
            keys = [LEAVE, *(each for each, _ in question.get("choices") or [])]
            if question.get("number") != number or key not in keys or self._answer is not None:
                return False
            self._answer = key
            self._changed.notify_all()
            return True


def _handler(page: Page, token: str) -> type[BaseHTTPRequestHandler]:
    """Return the class that answers requests for a page."""

    class Handler(BaseHTTPRequestHandler):
        protocol_version = "HTTP/1.1"

        def do_GET(self) -> None:
            url = urlsplit(self.path)
            after = parse_qs(url.query).get("after", ["0"])[0]
            if url.path == f"/{token}/":
                nonce = secrets.token_urlsafe(16)
                policy = {"Content-Security-Policy": POLICY.format(nonce=nonce)}
                self._send("text/html;charset=utf-8", page.html.replace("NONCE", nonce).encode(), policy)
            elif url.path == f"/{token}/events" and after.isdecimal():
                self._send("application/json", json.dumps(page.events_after(int(after))).encode())
            else:
                self.send_error(HTTPStatus.NOT_FOUND)

        def do_POST(self) -> None:
            size = self.headers.get("Content-Length", "")
            body = self.rfile.read(int(size)) if size.isdecimal() and int(size) <= MOST_BYTES else b""
            if self.path == f"/{token}/stop":
                page.stop.set()
                self._send("application/json", b"true")
            elif self.path == f"/{token}/answer":
                self._send("application/json", json.dumps(_take(page, body)).encode())
            else:
                self.send_error(HTTPStatus.NOT_FOUND)

        def _send(self, kind: str, body: bytes, headers: Mapping[str, str] | None = None) -> None:
            self.send_response(HTTPStatus.OK)
            common = {"Content-Type": kind, "Content-Length": str(len(body)), "Cache-Control": "no-store"}
            safe = {"X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer"}
            for name, value in {**common, **safe, **(headers or {})}.items():
                self.send_header(name, value)
            with suppress(ConnectionError):  # the page was closed or loaded again meanwhile
                self.end_headers()
                self.wfile.write(body)

        def log_message(self, format: str, *args: object) -> None:
            """Print nothing: the terminal is the experimenter's."""

    return Handler


def _take(page: Page, body: bytes) -> bool:
    try:
        answer = json.loads(body)
        return page.take(int(answer["number"]), str(answer["key"]))
    except (ValueError, KeyError, TypeError):
        return False
