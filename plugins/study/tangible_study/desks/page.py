"""A page in the browser as the desk of a participant: it speaks, shows no picture, and may be the device as well."""

import json
import re
import secrets
import sys
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from http import HTTPStatus
from http.server import BaseHTTPRequestHandler, ThreadingHTTPServer
from importlib.resources import files
from socket import SHUT_RDWR
from threading import Condition, Event, Thread
from types import TracebackType
from typing import Any, Self, final

from pydantic import BaseModel

from tangible_core.errors import DeviceError
from tangible_core.pipeline.feeling import Feeling
from tangible_core.servo import Servo
from tangible_core.servo.beacon import part_number
from tangible_web.access import refusal_text
from tangible_web.address import HOST, Address, page_file
from tangible_web.connection import HEAD_S, MOST_STRANGERS, Strangers

from .desk import LEAVE, Desk, Left
from .page_hand import PageHand
from .page_surface import surface_for_page

POLL_S = 20.0
"""The longest time for which a request of the page waits for something to say, s."""
LAST_S = 2.0
"""The longest time for which the end of a session waits for the page, s."""
SURFACE_S = 5.0
"""The longest time for which an interval waits for the page to fetch its surface, s."""
MOST_BYTES = 1000
"""The most bytes of an answer."""
POLICY = "default-src 'none'; script-src 'nonce-{nonce}'; style-src 'nonce-{nonce}'; connect-src 'self'"
NUMBER = re.compile("[0-9]{1,9}")
"""A number in a request; one of more digits is of nothing that there is."""
NO_SURFACE: Mapping[str, Any] = {"surface": 0}


@final
class Page(Desk):
    """A server of the page, as a context manager. Reloading the page goes on with the current question."""

    def __init__(
        self,
        language: str,
        translate: Callable[[str], str],
        hand: PageHand | None = None,
        sounds: Sequence[str] = (),
    ) -> None:
        """Build the page; nothing is served yet.

        language: of the participant. translate: to that language. hand: moves the device from the page; None if
        another device is felt. sounds: by which the page renders touch.
        The page does not show the title of a study, which may name conditions.
        Raises: ConfigError if the page was not built.
        """
        self._translate, self._stop, self._changed = translate, Event(), Condition()
        self._events: list[dict[str, Any]] = []
        self._answer: str | None = None
        self._fetched = 0
        self.hand = hand
        self._sounds = list(sounds)
        self._surfaces = self._seen = 0
        self._surface: dict[str, Any] | None = None
        html = files("tangible_study.desks").joinpath("page.html").read_text(encoding="utf-8")
        html = html.replace("LANGUAGE", language).replace("STYLE", page_file("study.css"), 1)
        self.html: str = html.replace("SCRIPT", page_file("study.js"), 1)
        self._server = _Server(self)
        self._thread = Thread(target=self._server.serve_forever, daemon=True)

    @property
    def address(self) -> str:
        """Address of the page; nobody can guess it."""
        return f"http://{HOST}:{self._server.server_port}{self._server.root}"

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

    @contextmanager
    def exploring(self, feeling: Feeling, servo: Servo, part: str | None) -> Iterator[None]:
        """Put a surface under the hand of the page, if that is the device; it begins once the page has it."""
        device = feeling.device
        if self.hand is None or not self.hand.moves(device):
            yield
            return
        surface = feeling.pipeline.make("surface")
        lead = None if part is None else part_number(surface, part)
        with self._changed:
            self._surfaces += 1
            number = self._surfaces
            self._surface = surface_for_page(surface, number)
            self._add("", None, {"surface": number, "sounds": self._sounds, "lead": lead})
            there = self._changed.wait_for(lambda: self._seen >= number or self._stop.is_set(), SURFACE_S)
        try:
            if not there:
                raise DeviceError("the page of the participant does not answer; open it again")
            with self.hand.within(servo, device):
                yield
        finally:
            self._surface = None
            self._add("", None, NO_SURFACE)

    def surface(self, number: int) -> bytes | None:
        """Return the surface of this number as JSON; None if it is not the present one."""
        surface = self._surface
        if surface is None or number != self._surfaces:
            return None
        with self._changed:
            self._seen = number
            self._changed.notify_all()
        return json.dumps(surface).encode()

    def _add(self, text: str, choices: list[list[str]] | None, more: Mapping[str, Any] | None = None) -> None:
        with self._changed:
            event = {"number": len(self._events) + 1, "text": text, "choices": choices}
            self._events.append({**event, **(more or {})})
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


class _Answer(BaseModel, strict=True):
    """An answer to a question: the question's number, and a key."""

    number: int
    key: str


@final
class _Server(ThreadingHTTPServer):
    """A server that strangers cannot keep busy, nor print anything with: the terminal is the experimenter's."""

    daemon_threads = True
    request_queue_size = MOST_STRANGERS

    def __init__(self, page: Page) -> None:
        super().__init__((HOST, 0), _Handler)
        self.page = page
        self.own = Address(self.socket, secrets.token_urlsafe(16))
        self.root: str = f"/{self.own.key}/"
        self.strangers = Strangers()

    def service_actions(self) -> None:
        self.strangers.cut_late()

    def handle_error(self, request: Any, client_address: Any) -> None:
        """Report a fault of this program; that a connection broke is none."""
        if not isinstance(sys.exception(), OSError):
            super().handle_error(request, client_address)


@final
class _Handler(BaseHTTPRequestHandler):
    """A connection of a browser; it is a stranger's until a request shows the key."""

    protocol_version = "HTTP/1.1"
    timeout = HEAD_S  # of a read, so of the body too
    server: _Server  # pyright: ignore[reportIncompatibleVariableOverride] - no other one uses it

    def setup(self) -> None:
        super().setup()
        self.server.strangers.add(self)

    def finish(self) -> None:
        self.server.strangers.remove(self)
        super().finish()

    def abort(self) -> None:
        with suppress(OSError):
            self.connection.shutdown(SHUT_RDWR)

    def parse_request(self) -> bool:
        """Parse the head; refuse what is not this page's."""
        if not super().parse_request():
            return False
        said = self.headers
        if why := refusal_text(self.server.own.hosts, self.command, said.get("Host"), said.get("Origin")):
            self.send_error(HTTPStatus.FORBIDDEN, why)
        elif not self.path.startswith(self.server.root):
            self.send_error(HTTPStatus.NOT_FOUND)
        else:
            self.server.strangers.remove(self)
            return True
        return False

    def do_GET(self) -> None:
        name, _, query = self.path.removeprefix(self.server.root).partition("?")
        number = int(found[0]) if (found := NUMBER.fullmatch(query.removeprefix("after="))) else None
        page = self.server.page
        if not name:
            nonce = secrets.token_urlsafe(16)
            policy = {"Content-Security-Policy": POLICY.format(nonce=nonce)}
            self._send("text/html;charset=utf-8", page.html.replace("NONCE", nonce).encode(), policy)
        elif name == "events" and number is not None:
            self._send("application/json", json.dumps(page.events_after(number)).encode())
        elif name == "surface" and number is not None and (surface := page.surface(number)):
            self._send("application/json", surface)
        else:
            self.send_error(HTTPStatus.NOT_FOUND)

    def do_POST(self) -> None:
        page, name = self.server.page, self.path.removeprefix(self.server.root)
        if name == "stop":
            page.stop.set()  # whatever the body is
        try:
            body = self._read_body()
            answer = _Answer.model_validate_json(body) if name == "answer" else None
        except ValueError:
            self.send_error(HTTPStatus.BAD_REQUEST)
            return
        if answer:
            self._send("application/json", json.dumps(page.take(answer.number, answer.key)).encode())
        elif name == "stop":
            self._send("application/json", b"true")
        elif name == "hand" and page.hand is not None:
            self._send("application/octet-stream", page.hand.take(body))
        else:
            self.send_error(HTTPStatus.NOT_FOUND)

    def _read_body(self) -> bytes:
        """Return a body of at most MOST_BYTES. Raises: ValueError for one of another size, or of an unknown one."""
        size, *more = self.headers.get_all("Content-Length", [""])
        if more or not NUMBER.fullmatch(size) or int(size) > MOST_BYTES or "Transfer-Encoding" in self.headers:
            raise ValueError(size)
        body = self.rfile.read(int(size))
        if len(body) < int(size):
            raise ValueError("the body broke off")
        return body

    def _send(self, kind: str, body: bytes, headers: Mapping[str, str] | None = None) -> None:
        self.send_response(HTTPStatus.OK)
        common = {"Content-Type": kind, "Content-Length": str(len(body)), "Cache-Control": "no-store"}
        safe = {"X-Content-Type-Options": "nosniff", "Referrer-Policy": "no-referrer"}
        for name, value in {**common, **safe, **(headers or {})}.items():
            self.send_header(name, value)
        self.end_headers()
        self.wfile.write(body)

    def log_message(self, format: str, *args: object) -> None:
        """Print nothing: the terminal is the experimenter's."""
