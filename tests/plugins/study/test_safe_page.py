"""Strangers at a participant's page: who is let in, and that nothing they send keeps a participant from the stop."""

import socket
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack
from random import Random
from urllib.parse import urlsplit

import pytest

from broken_messages import broken_request, send_broken
from tangible_study.desks.page import MOST_BYTES, Page
from tangible_study.desks.page_hand import PageHand
from tangible_web import connection
from tangible_web.connection import MOST_STRANGERS
from waiting import LONGEST_S, until


@pytest.fixture
def page(capfd: pytest.CaptureFixture[str]) -> Iterator[Page]:
    """A page that prints nothing: the terminal is the experimenter's."""
    with Page("en", str, PageHand()) as page:
        yield page
        until(lambda: not page._server.strangers._open, "the end of all connections")
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


@pytest.mark.whole
def test_half_open_connections_keep_nobody_from_the_stop(page: Page, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(connection, "HEAD_S", LONGEST_S)  # on a busy machine all of this takes longer
    monkeypatch.setattr("tangible_study.desks.page._Handler.timeout", LONGEST_S)
    with ExitStack() as open_ones:
        known = open_ones.enter_context(Browser(page))
        assert known.ask("GET", known.path) == 200
        strangers = [open_ones.enter_context(Browser(page)) for _ in range(MOST_STRANGERS + 20)]
        for stranger, said in zip(strangers, (b"", b"GET / HT", b"POST / HTTP/1.1\r\nHost: ") * 1000, strict=False):
            stranger.socket.sendall(said)
        assert all(not each.status() for each in strangers[:20]), "the longest open are cut off"
        for browser in (known, open_ones.enter_context(Browser(page))):
            page.stop.clear()
            assert browser.ask("POST", f"{browser.path}stop", b"{}") == 200
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
        assert ask("GET", "", Host=host) == 403, host
    for told in ({"Host": "evil.example", "Origin": "http://evil.example"}, *({"Origin": o} for o in FOREIGN_ORIGINS)):
        assert (ask("POST", "stop", **told), page.stop.is_set()) == (403, False), told
        assert ask("OPTIONS", "stop", **told) == 403, told
    for method in ("HEAD", "PUT", "OPTIONS", "TRACE", "get", "X" * 1000):
        assert (ask(method, "stop"), page.stop.is_set()) == (501, False), method
    for name in ("127.0.0.1", "localhost", "LocalHost", "[::1]"):
        with Browser(page) as browser:
            host = f"{name}:{browser.host.partition(':')[2]}"
            page.stop.clear()
            assert browser.ask("POST", f"{browser.path}stop", Host=host, Origin=f"http://{host}") == 200, name
            assert page.stop.is_set()
    for said in ({"Content_Length": "9" * 5000}, {"Transfer_Encoding": "chunked"}, {"Content_Length": "x"}):
        ask("POST", "stop", **said)
        assert page.stop.is_set(), "whatever the body is"
    nowhere = (f"{name}{number}" for name in ("events?after=", "surface?") for number in ("9" * 5000, "-1", "x", ""))
    for name in (*nowhere, "surface?0", "nothing", "answer", "../", "%00", "x" * 5000, "events"):
        assert ask("GET", name) == 404, name


WHOLE = b'{"number": 1, "key": "1"}'
SIZES = ("9" * 5000, str(MOST_BYTES + 1), "-1", "+25", "0x19", "", "24, 24", "24\r\nContent-Length: 24", "500", None)
BODIES = (
    b"", b"nonsense", b"\xff\xfe", b"[" * MOST_BYTES, b"[]", b"null", b"{}", b'{"number": 1, "key": 1}',
    b'{"number": 1}', b'{"number": 1, "key": "\xff"}', b'{"number": 1, "key": "1"',
    *(b'{"number": %s, "key": "1"}' % number for number in (b"Infinity", b"NaN", b"1e999", b"1.0", b"true", b'"1"')),
)  # fmt: skip


def test_body_that_is_no_answer_is_refused(page: Page):
    """The question stays open: the right answer is taken afterwards, whatever type it says it has."""
    with ThreadPoolExecutor(1) as background:
        asked = background.submit(page.ask, "Which?", {"1": ""})
        until(lambda: len(page.events_after(0)) == 1, "the question")
        try:
            chunked = (WHOLE, {"Transfer_Encoding": "chunked"})
            sizes = ((WHOLE, {"Content_Length": size}) for size in SIZES)
            for body, headers in (*sizes, chunked, *((body, {}) for body in BODIES)):
                with Browser(page) as browser:
                    browser.send("POST", f"{browser.path}answer", body, **headers)
                    browser.socket.shutdown(socket.SHUT_WR)
                    assert browser.status() == 400, (body, headers)
            for body, over in ((b'{"number": %s, "key": "1"}' % (b"1" * 900), False), (WHOLE, True)):
                assert not asked.done()
                with Browser(page) as browser:
                    assert browser.ask("POST", f"{browser.path}answer", body, Content_Type="image/png") == 200
                assert not over or asked.result() == "1"
        finally:
            page.take(1, "1")


@pytest.mark.parametrize("count", [100, pytest.param(4000, marks=pytest.mark.nightly)])
def test_page_survives_broken_requests(page: Page, count: int):
    random = Random(53)
    page.say("There is an event, so that no request waits for one.")
    with Browser(page) as known:
        for _ in range(count):
            name = random.choice(["", "stop", "answer", "hand", "surface?1", "events?after=0"])
            path = random.choice([known.path, "/"]) + name
            send_broken(random, broken_request(random, path, known.host), *known.socket.getpeername())
    with Browser(page) as browser:
        assert browser.ask("GET", browser.path) == 200
