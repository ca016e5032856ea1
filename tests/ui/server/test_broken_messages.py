"""Broken frames and requests: otherwise one of them ends the server under a hand, or fills its log."""

import socket
import time
from collections.abc import Iterator
from pathlib import Path
from random import Random

import pytest

from broken_messages import BINARY, CLOSE, TEXT, broken_frames, broken_request, frame, send_broken
from page_server import KEY, PageServer
from tangible_ui.serving import routes
from tangible_web.address import HOST
from tangible_web.server import MAX_MESSAGE_BYTES
from waiting import LONGEST_S, until


@pytest.fixture
def page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, caplog: pytest.LogCaptureFixture) -> Iterator[PageServer]:
    """A server that logs no traceback, and still serves at the end."""
    (tmp_path / "static").mkdir()
    (tmp_path / "static/index.html").write_text("<title>t</title>")
    monkeypatch.setattr(routes, "static", lambda: tmp_path / "static")
    with PageServer(tmp_path, monkeypatch) as page:
        yield page
        assert page.ask("/").status == 200
    assert not [record for record in caplog.get_records("call") if record.exc_info]


FRAMES = {
    "text that is not UTF-8": (frame(TEXT, b"\xff"), 1007),
    "text that is cut within a letter": (frame(TEXT, "é".encode()[:1]), 1007),
    "parts that are not UTF-8 together": (frame(TEXT, b"\xc3", last=False) + frame(0, b"("), 1007),
    "text that is not UTF-8, and a close": (frame(TEXT, b"\xff") + frame(CLOSE, b"\x03\xe8"), 1000),
    "close with a code that nobody may send": (frame(CLOSE, b"\x03\xed"), 1002),
    "text of one byte too many": (frame(TEXT, size=MAX_MESSAGE_BYTES + 1), 1009),
    "parts of one byte too many": (frame(BINARY, bytes(MAX_MESSAGE_BYTES), last=False) + frame(0, b"\0"), 1009),
    "compressed text, which was not agreed": (frame(TEXT, b"x", rsv=4), 1002),
    "frame without a mask": (frame(TEXT, b"x", mask=False), 1002),
}
"""Frames, and the code that RFC 6455 gives to their fault."""


def test_frame_that_breaks_the_standard_closes_the_connection(page: PageServer) -> None:
    for name, (said, code) in FRAMES.items():
        with page.tab() as tab:
            tab.until(event="hello")
            tab.socket.socket.sendall(said)
            assert tab.closed() == code, name


@pytest.mark.parametrize("path", [f"/stop?token={KEY}", f"/upload/{'0' * 16}/a.png?token={KEY}"])
@pytest.mark.parametrize("after_answer", [False, True], ids=["at once", "after an answer"])
def test_body_that_breaks_off_is_refused(page: PageServer, path: str, after_answer: bool) -> None:
    method = "PUT" if "upload" in path else "POST"
    head = f"{method} {path} HTTP/1.1\r\nHost: {page.host}\r\nOrigin: http://{page.host}\r\nTransfer-Encoding: chunked"
    with socket.create_connection((HOST, page.port), timeout=LONGEST_S) as raw:
        raw.sendall(f"{head}\r\n\r\n".encode() + b"" if after_answer else f"{head}\r\n\r\nzz\r\n".encode())
        if after_answer:
            time.sleep(0.2)  # an upload has no answer yet, and waits for its body
            raw.sendall(b"zz\r\n")
        said = b""
        while more := raw.recv(4096):
            said += more
        assert said.startswith(b"HTTP/1.1 ")
    until(lambda: page.done(lambda: not page.server.server_state.tasks), "the end of the request")


@pytest.mark.parametrize("count", [40, pytest.param(2000, marks=pytest.mark.nightly)])
def test_server_survives_broken_messages(page: PageServer, count: int) -> None:
    random = Random(53)
    paths = ("/", "/stop", f"/stop?token={KEY}", f"/live?token={KEY}", f"/scene/a/b?token={KEY}")
    with page.tab() as witness:
        for _ in range(count):
            send_broken(random, broken_request(random, random.choice(paths), page.host), HOST, page.port)
            with page.tab() as tab:
                tab.socket.socket.sendall(broken_frames(random))
            witness.until(event="answer", number=witness.ask("examples"))
        until(lambda: page.done(lambda: len(page.session.tabs.open)) == 1, "the end of broken tabs")
