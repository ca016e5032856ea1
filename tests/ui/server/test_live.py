"""Messages of a tab: otherwise a damaged frame moves the hand, or a bad request ends the server."""

import json
import math
import socket
import time
from collections.abc import Iterator
from pathlib import Path
from random import Random
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st

from broken_messages import BINARY, CLOSE, TEXT, broken_frames, broken_request, frame, send_broken
from page_server import KEY, PageServer
from tangible_core.errors import TangibleError
from tangible_ui.requests import REQUESTS, find_request
from tangible_ui.serving import routes
from tangible_web import framing as wire
from tangible_web.address import HOST
from tangible_web.hand import Hand
from tangible_web.live import LiveTab, _as_json
from tangible_web.parsing import BadRequest, parse
from tangible_web.server import MAX_MESSAGE_BYTES
from waiting import LONGEST_S, until

JSON = st.recursive(
    st.none() | st.booleans() | st.integers() | st.floats(allow_nan=False, allow_infinity=False) | st.text(),
    lambda deeper: st.lists(deeper, max_size=3) | st.dictionaries(st.text(max_size=8), deeper, max_size=3),
    max_leaves=8,
)
WHOLE = {
    wire.POINTER: wire.POINTER_FRAME.pack(wire.POINTER, 1, 7, 1.7e12, 0.01, -0.02, 0.003),
    wire.ACK: wire.ACK_FRAME.pack(wire.ACK, 1),
    wire.RELEASE: wire.RELEASE_FRAME.pack(wire.RELEASE),
}


def tab() -> tuple[Any, Hand]:
    """A tab that holds the hand, and the hand."""
    hand = Hand("ui-test")
    tab: Any = LiveTab.__new__(LiveTab)
    tab._program, tab._seq, tab._last_drawn = SimpleNamespace(hand=hand, holds=lambda _: True), 2, 0
    tab._new_ack = SimpleNamespace(set=lambda: None)
    return tab, hand


class TestFrames:
    def test_frame_that_is_complete_is_handled(self) -> None:
        live, hand = tab()
        live._handle_frame(WHOLE[wire.POINTER])
        assert hand.holding
        live._handle_frame(WHOLE[wire.RELEASE])
        assert not hand.holding
        live._handle_frame(WHOLE[wire.ACK])
        assert live._last_drawn == 1

    @pytest.mark.parametrize("kind", WHOLE)
    def test_frame_that_is_damaged_is_ignored(self, kind: int) -> None:
        frame = WHOLE[kind]
        for damaged in [*(frame[:end] for end in range(1, len(frame))), frame + b"\0", frame * 2]:
            if damaged in WHOLE.values():
                continue
            live, hand = tab()
            hand.point((0.01, 0.0, 0.0), 0, 0)
            held = hand._position
            live._handle_frame(damaged)
            assert (hand._position, live._last_drawn) == (held, 0)

    @given(st.binary(min_size=1, max_size=100))
    def test_frame_of_any_bytes_leaves_a_finite_hand(self, frame: bytes) -> None:
        check(frame)


def check(frame: bytes) -> None:
    live, hand = tab()
    live._handle_frame(frame)
    assert all(abs(part) <= 1.0 for part in hand._position.at)
    assert 0 <= live._last_drawn <= live._seq


def ask(**said: Any) -> str:
    return json.dumps({"number": 1, **said})


class TestAsks:
    def test_requests_are_parsed_or_refused_with_a_sentence(self) -> None:
        asked = parse(ask(ask="edit", text="scene: x", apply=True), find_request)
        assert (asked.number, asked.ask, asked.arguments) == (1, REQUESTS["edit"], {"text": "scene: x", "apply": True})
        for text, number, says in (
            ("", None, "not JSON"),
            ('{"number": NaN, "ask": "stop"}', None, "not JSON"),
            ("[" * 100_000, None, "not JSON"),
            ("[]", None, '"number"'),
            ('{"ask": "stop"}', None, '"number"'),
            ('{"number": true, "ask": "stop"}', None, '"number"'),
            ('{"number": 1.0, "ask": "stop"}', None, '"number"'),
            (ask(ask=["x"]), 1, "there is no request"),
            (ask(), 1, "there is no request"),
            (ask(ask="stop", session=None), 1, "session: Extra"),
            (ask(ask="edit"), 1, "text: Field required"),
            (ask(ask="edit", text=5), 1, "text: .*string"),
            (ask(ask="edit", text="", apply=1), 1, "apply: .*bool"),
            (ask(ask="begin", files=[1]), 1, "files.0: .*string"),
        ):
            with pytest.raises(BadRequest, match=says) as refused:
                parse(text, find_request)
            assert refused.value.number == number
            assert len(str(refused.value)) < 400 and "\n" not in str(refused.value)

    @given(JSON, st.sampled_from(sorted(REQUESTS)))
    @settings(suppress_health_check=[HealthCheck.too_slow])
    def test_request_of_any_json_is_parsed_or_refused(self, told: Any, name: str) -> None:
        for said in (told, {"number": 1, "ask": told}, {"number": 1, "ask": name, "path": told, "text": told}):
            try:
                asked = parse(json.dumps(said), find_request)
            except TangibleError as error:
                assert str(error)
            else:
                assert asked.name not in REQUESTS or asked.ask is REQUESTS[asked.name]


def test_event_with_numbers_that_json_lacks_is_sent() -> None:
    event = {"a": [1.5, math.nan, {"b": (math.inf, 2)}], "c": -math.inf, "d": Path("/x")}
    found = json.loads(_as_json(event), parse_constant=lambda constant: pytest.fail(f"{constant} is not JSON"))
    assert found == {"a": [1.5, None, {"b": [None, 2]}], "c": None, "d": "/x"}


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
