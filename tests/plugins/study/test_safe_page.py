"""Strangers at a participant's page: who is let in, and that nothing they send keeps a participant from the stop."""

import socket
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from random import Random
from urllib.parse import urlsplit

import pytest

from broken_messages import broken_request, send_broken
from participants import Participant
from tangible_study.desks.page import Page
from tangible_web import connection
from tangible_web.connection import MAX_STRANGERS
from waiting import LONGEST_S, until


@pytest.fixture
def page(capfd: pytest.CaptureFixture[str]) -> Iterator[Page]:
    """A page that prints nothing: the terminal is the experimenter's."""
    with Page("en", str) as page:
        yield page
        until(lambda: not page._server._server.server_state.connections, "the end of all connections")
    assert capfd.readouterr() == ("", "")


class Browser:
    """A connection to a page, on which requests are bytes."""

    def __init__(self, page: Page) -> None:
        url = urlsplit(page.address)
        self.host, self.path = url.netloc, url.path
        self.socket = socket.create_connection(("127.0.0.1", url.port or 0), timeout=LONGEST_S)

    def __enter__(self) -> "Browser":
        return self

    def __exit__(self, *_: object) -> None:
        self.socket.close()

    def send(self, method: str, path: str, body: bytes = b"", **headers: str | None) -> None:
        """Send a request, with the headers of the page's own; None omits one."""
        said = {"Host": self.host, "Origin": f"http://{self.host}", "Content_Length": str(len(body)), **headers}
        lines = [f"{name.replace('_', '-')}: {value}\r\n" for name, value in said.items() if value is not None]
        self.socket.sendall(f"{method} {path} HTTP/1.1\r\n{''.join(lines)}\r\n".encode("latin-1") + body)

    def status(self) -> int:
        """The status of the next answer, which is read whole; 0 if the connection is closed."""
        try:
            with self.socket.makefile("rb") as file:
                _, status, *_ = file.readline().split() or (b"", b"0")
                size = 0
                while (line := file.readline()).strip():
                    name, _, value = line.partition(b":")
                    size = int(value) if name.lower() == b"content-length" else size
                file.read(size)
        except ConnectionError:
            return 0
        return int(status)

    def ask(self, method: str, path: str, body: bytes = b"", **headers: str | None) -> int:
        """Send a request; the status of the answer."""
        self.send(method, path, body, **headers)
        return self.status()


def test_half_open_connections_keep_nobody_from_the_stop(page: Page, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(connection, "HEAD_S", LONGEST_S)  # on a busy machine all of this takes longer
    with ExitStack() as open_ones:
        known = open_ones.enter_context(Browser(page))
        assert known.ask("GET", known.path) == 200
        strangers = [open_ones.enter_context(Browser(page)) for _ in range(MAX_STRANGERS + 20)]
        for stranger, said in zip(strangers, (b"", b"GET / HT", b"POST / HTTP/1.1\r\nHost: ") * 1000, strict=False):
            stranger.socket.sendall(said)
        assert all(not each.status() for each in strangers[:20]), "the longest open are cut off"
        for browser in (known, open_ones.enter_context(Browser(page))):
            page.stop.clear()
            assert browser.ask("POST", f"{browser.path}stop") == 204
            assert page.stop.is_set()
        with Participant(page) as tab:
            page.stop.clear()
            tab.ask("stop")
            assert page.stop.is_set()
        strangers[-1].socket.settimeout(0.05)
        with pytest.raises(TimeoutError):
            strangers[-1].status()


FOREIGN_HOSTS = ("evil.example", "127.0.0.1", "127.0.0.1:1", "", None)
FOREIGN_ORIGINS = (None, "null", "http://evil.example", "https://{host}", "http://{host}.evil")


def test_page_answers_itself_alone(page: Page):
    def ask(method: str, name: str, **headers: str | None) -> int:
        page.stop.clear()
        with Browser(page) as browser:
            said = {name: value and value.format(host=browser.host) for name, value in headers.items()}
            return browser.ask(method, browser.path + name, b"", **said)

    assert ask("GET", "") == ask("GET", "", Origin=None) == 200
    for host in FOREIGN_HOSTS:
        assert ask("GET", "", Host=host) == (400 if host is None else 403), host
    for told in ({"Host": "evil.example", "Origin": "http://evil.example"}, *({"Origin": o} for o in FOREIGN_ORIGINS)):
        assert (ask("POST", "stop", **told), page.stop.is_set()) == (403, False), told
        assert ask("OPTIONS", "stop", **told) == 403, told
    for method in ("GET", "PUT", "OPTIONS", "TRACE", "get", "X" * 1000):
        assert ask(method, "stop") in (404, 405) and not page.stop.is_set(), method
    for name in ("127.0.0.1", "localhost", "LocalHost", "[::1]"):
        with Browser(page) as browser:
            host = f"{name}:{browser.host.partition(':')[2]}"
            page.stop.clear()
            assert browser.ask("POST", f"{browser.path}stop", Host=host, Origin=f"http://{host}") == 204, name
            assert page.stop.is_set()
    for name in ("nothing", "live", "../", "%00", "x" * 5000):
        assert ask("GET", name) == 404, name


NO_ANSWERS = (
    {}, {"question": 1}, {"key": "1"}, {"question": 1, "key": 1}, {"question": True, "key": "1"},
    {"question": 1.0, "key": "1"}, {"question": "1", "key": "1"}, {"question": 1, "key": "1", "page": 1},
)  # fmt: skip


def test_answer_that_is_none_is_refused(page: Page):
    with ThreadPoolExecutor(1) as background, Participant(page) as tab:
        asked = background.submit(page.ask, "Which?", {"1": ""})
        question = tab.hear()
        try:
            for told in NO_ANSWERS:
                with pytest.raises(AssertionError, match="'refused'"):
                    tab.ask("answer", **told)
            assert not tab.answer({"line": 10**900}, "1")
            assert not asked.done()
            assert tab.answer(question, "1")
            assert asked.result() == "1"
        finally:
            page.take(1, "1")


@pytest.mark.parametrize("count", [100, pytest.param(4000, marks=pytest.mark.nightly)])
def test_page_survives_broken_requests(page: Page, count: int):
    random = Random(53)
    with Browser(page) as known:
        for _ in range(count):
            name = random.choice(["", "stop", "live", "study.js"])
            path = random.choice([known.path, "/"]) + name
            send_broken(random, broken_request(random, path, known.host), *known.socket.getpeername())
    with Browser(page) as browser:
        assert browser.ask("GET", browser.path) == 200
