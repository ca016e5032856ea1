"""Strangers at a participant's page: who is let in, and that nothing they send keeps a participant from the stop."""

import socket
import struct
from collections.abc import Iterator
from concurrent.futures import ThreadPoolExecutor
from contextlib import ExitStack, suppress
from random import Random
from urllib.parse import urlsplit

import pytest

from broken_messages import broken_request, send_broken
from tangible_study.desks.page import MOST_BYTES, Page
from tangible_study.desks.page_hand import PageHand
from tangible_ui.serving import connection
from tangible_ui.serving.connection import MOST_STRANGERS
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


def test_head_that_drips_has_a_time_limit(page: Page, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(connection, "HEAD_S", 0.3)
    with Browser(page) as known, Browser(page) as slow:
        assert known.ask("GET", known.path) == 200

        def is_cut_off() -> bool:
            try:
                slow.socket.sendall(b"x")
            except ConnectionError:
                return True
            return False

        until(is_cut_off, "the end of a head that never ends")
        assert known.ask("POST", f"{known.path}stop", b"{}") == 200, "who showed the key stays"


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
    assert (ask("POST", "stop"), page.stop.is_set()) == (200, True)


def test_every_name_of_this_machine_is_served(page: Page):
    for name in ("127.0.0.1", "localhost", "LocalHost", "[::1]"):
        with Browser(page) as browser:
            host = f"{name}:{browser.host.partition(':')[2]}"
            assert browser.ask("POST", f"{browser.path}stop", b"{}", Host=host, Origin=f"http://{host}") == 200, name


WHOLE = b'{"number": 1, "key": "1"}'


SIZES = (
    "9" * 5000,
    str(MOST_BYTES + 1),
    "-1",
    "+25",
    "2_5",
    "0x19",
    "",
    " ",
    "24, 24",
    "24\r\nContent-Length: 24",
    None,
)
NUMBERS = (b"Infinity", b"-Infinity", b"NaN", b"1e999", b"1.0", b"true", b'"1"', b"null", b"[1]", b"-", b"")
BODIES = (
    b"", b"nonsense", b"\xff\xfe", b"[" * MOST_BYTES, b'{"a":' * 200, b"[]", b"1", b'"x"', b"null", b"{}",
    b'{"number": 1, "key": 1}', b'{"number": 1}', b'{"number": 1, "key": "\xff"}', b'{"number": 1, "key": "1"',
    *(b'{"number": %s, "key": "1"}' % number for number in NUMBERS),
)  # fmt: skip
NO_ANSWERS: tuple[tuple[bytes, dict[str, str | None]], ...] = (
    *((WHOLE, {"Content_Length": size}) for size in SIZES),
    (b"18\r\n" + WHOLE + b"\r\n0\r\n\r\n", {"Content_Length": None, "Transfer_Encoding": "chunked"}),
    (WHOLE, {"Transfer_Encoding": "chunked"}),
    *((body, {}) for body in BODIES),
)


def test_body_that_is_no_answer_is_refused(page: Page):
    """The question stays open: the right answer is taken afterwards, whatever type it says it has."""
    with ThreadPoolExecutor(1) as background:
        asked = background.submit(page.ask, "Which?", {"1": ""})
        until(lambda: len(page.events_after(0)) == 1, "the question")
        try:
            for body, headers in NO_ANSWERS:
                with Browser(page) as browser:
                    assert browser.ask("POST", f"{browser.path}answer", body, **headers) == 400, (body, headers)
            with Browser(page) as browser:
                large = b'{"number": %s, "key": "1"}' % (b"1" * 900)
                assert browser.ask("POST", f"{browser.path}answer", large) == 200
                assert not asked.done()
                assert browser.ask("POST", f"{browser.path}answer", WHOLE, Content_Type="image/png") == 200
        finally:
            page.take(1, "1")
        assert asked.result() == "1"


def test_stop_is_heard_whatever_its_body(page: Page):
    for headers in ({"Content_Length": "9" * 5000}, {"Transfer_Encoding": "chunked"}, {"Content_Length": "x"}):
        page.stop.clear()
        with Browser(page) as browser:
            browser.ask("POST", f"{browser.path}stop", b"", **headers)
        assert page.stop.is_set(), headers


NOWHERE = (
    *(f"events?after={number}" for number in ("9" * 5000, "-1", "1.0", "x", "%D9%A3", "")),
    *(f"surface?{number}" for number in ("9" * 5000, "0", "-1", "", "x")),
    "nothing", "answer", "../", "%00", "x" * 5000, "events",
)  # fmt: skip


def test_address_of_nothing_is_not_there(page: Page):
    for path in NOWHERE:
        with Browser(page) as browser:
            assert browser.ask("GET", browser.path + path) == 404, path


BROKEN = (
    b"GET http://[/ HTTP/1.1\r\n\r\n", b"GET //[/ HTTP/1.1\r\nHost: x\r\n\r\n", b"GET / HTTP/1.\xb2\r\n\r\n",
    b"GET /\r\n\r\n", b"GET / HTTP/2.0\r\n\r\n", b"\x16\x03\x01\x02\x00\x01\x00\x01\xfc\x03\x03\r\n\r\n",
    b"GET / HTTP/1.1\r\n" + b"a: b\r\n" * 200 + b"\r\n", b"GET / HTTP/1.1\r\na: " + b"x" * 70_000 + b"\r\n\r\n",
    b"GET / HTTP/1.1\r\n\xff\xfe: \x00\r\n: \r\n x\r\n\r\n", b"G" * 70_000, b"\r\n", b"\0" * 100 + b"\r\n\r\n",
)  # fmt: skip


def test_head_that_is_broken_is_refused(page: Page):
    for said in BROKEN:
        with Browser(page) as browser, suppress(ConnectionError):  # it may be closed before all is read
            browser.socket.sendall(said)
            browser.socket.shutdown(socket.SHUT_WR)
            with browser.socket.makefile("rb") as file:
                answer = file.read()
            assert not answer or b"Error code: 4" in answer or b"Error code: 505" in answer, (said[:80], answer)
    with Browser(page) as browser:
        assert browser.ask("GET", browser.path) == 200


def test_connection_that_breaks_prints_nothing(page: Page):
    """It is reset, as when a browser is killed, with answers under way."""
    for name in ("stop", "answer", "nothing", None):
        with Browser(page) as browser, suppress(ConnectionError):  # the page may have ended it first
            for _ in range(20):
                if name is None:
                    browser.socket.sendall(b"GET / HT")
                else:
                    browser.send("POST", browser.path + name)
            browser.socket.setsockopt(socket.SOL_SOCKET, socket.SO_LINGER, struct.pack("ii", 1, 0))


def test_body_that_breaks_off_is_no_answer(page: Page):
    with Browser(page) as browser:
        browser.send("POST", f"{browser.path}answer", WHOLE, Content_Length="500")
        browser.socket.shutdown(socket.SHUT_WR)
        assert browser.status() == 400


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
