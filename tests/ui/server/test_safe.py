"""Access to the page's server, and floods: otherwise another page reads files, or nobody can stop the force."""

import asyncio
import os
import socket
import time
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any
from urllib.parse import quote

import pytest
from starlette.routing import Mount, Route, WebSocketRoute
from websockets.exceptions import InvalidStatus

from page_server import KEY, PageServer
from tangible_core.files.reading import MAX_BYTES
from tangible_ui.serving import routes
from tangible_ui.serving.routes import WRONG_KEY
from tangible_web import connection, server
from tangible_web.address import Address, new_key
from tangible_web.connection import AT_ONCE_BYTES, MAX_STRANGERS
from tangible_web.framing import ACK, ACK_FRAME, POINTER, POINTER_FRAME
from tangible_web.live import IN_FLIGHT, MAX_ASKS
from tangible_web.server import HEADERS
from waiting import LONGEST_S, until

NAMES = {"digest": "abc", "name": "a.f32", "batch": "0" * 16, "folder": "export-1", "panel": "glove"}


@pytest.fixture
def page(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Iterator[PageServer]:
    static = tmp_path / "static"
    static.mkdir()
    (static / "index.html").write_text("<title>t</title>")
    (static / "app.js").write_text("1")
    monkeypatch.setattr(routes, "static", lambda: static)
    monkeypatch.setattr(server, "PING_S", 600.0)  # a page that answers no ping is cut off for that alone
    with PageServer(tmp_path, monkeypatch) as page:
        yield page


def test_tab_is_told_of_a_start_without_a_file_until_one_is_opened(page: PageServer) -> None:
    for waits, text, empty in ((True, "", True), (True, "scene: builtin/brick\n", False), (False, "", False)):
        page.session.waits_for_file, page.session.document.text = waits, text
        with page.tab() as tab:
            assert tab.until(event="hello")["empty"] is empty, (waits, text)


def with_key(path: str) -> str:
    return f"{path}?token={KEY}"


class TestWhoIsLetIn:
    def test_routes_but_the_built_page_need_the_key(self, page: PageServer) -> None:
        seen = set()
        for route in routes.routes(lambda: page.session, KEY):
            if isinstance(route, WebSocketRoute | Mount):
                seen.add(route.path)
                continue
            assert isinstance(route, Route), f"{route}: is not looked at here"
            for method in route.methods or ():
                for key in ("", "?token=", "?token=wrong", f"?token={KEY}x", "?token=%00", f"?token={KEY}&token=x"):
                    answer = page.ask(route.path.format(**NAMES) + key, method)
                    assert answer.status == 403, (route.path, method, key)
                    assert "the address it printed" in answer.text or method == "HEAD"
        assert seen == {"/live", ""}
        for key in ("", "wrong"):
            with page.tab(key) as tab:
                assert tab.closed() == WRONG_KEY

    def test_key_is_long_and_new_each_time(self, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.delenv("TANGIBLE_UI_TOKEN", raising=False)
        keys = {new_key() for _ in range(50)}
        assert len(keys) == 50
        assert all(len(key) * 6 >= 128 for key in keys)

    def test_address_returns_after_a_kill_alone(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.delenv("TANGIBLE_UI_TOKEN", raising=False)
        memory = tmp_path / "data" / "address"
        with Address.again(memory) as first:
            killed = memory.read_bytes()
            assert os.name == "nt" or memory.stat().st_mode & 0o777 == 0o600
            with Address.again(memory) as beside:
                assert beside.port != first.port
                assert beside.key != first.key
            assert memory.read_bytes() == killed
        assert not memory.exists(), "a new key after a program that ended"
        memory.write_bytes(killed)
        with Address.again(memory) as second:
            assert f"{second.port} {second.key}" == killed.decode()
        for damage in (b"", b"99999 key", b"\xff\xfe", b"a b c"):
            memory.write_bytes(damage)
            with Address.again(memory) as other:
                assert len(other.key) * 6 >= 128

    def test_hosts_and_origins_of_others_are_refused(self, page: PageServer) -> None:
        for host in ("evil.example", "127.0.0.1", "127.0.0.1:1", "", None):
            for path in ("/", with_key("/scene/abc/a.f32")):
                answer = page.ask(path, host=host)
                assert answer.status in (400, 403)
                assert answer.status == 400 or answer.headers["content-security-policy"]  # h11 itself refuses no host
            with handshake(page, host or "x") as raw:
                assert raw.recv(100).startswith(b"HTTP/1.1 403")
        for name in ("127.0.0.1", "localhost", "LocalHost", "[::1]"):
            host = f"{name}:{page.port}"
            assert page.ask("/", host=host).status == 200
            for origin in (f"http://{host}", f"http://{page.host}"):
                assert page.ask(with_key("/stop"), "POST", b"", host=host, origin=origin).status == 204
            assert page.ask("/", host=name).status == 403
        for origin in (None, "null", "http://evil.example", f"https://{page.host}", f"http://{page.host}.evil"):
            for method, path in (("PUT", f"/upload/{NAMES['batch']}/a.png"), ("POST", "/stop")):
                assert page.ask(with_key(path), method, b"x", origin=origin).text == "another page may not do that"
            with pytest.raises(InvalidStatus, match="403"):
                page.tab(origin=origin)

    def test_port_that_addresses_leave_out_is_optional(self) -> None:
        class Port80(socket.socket):
            def getsockname(self) -> tuple[str, int]:
                return "127.0.0.1", 80

        with Port80() as listening:
            hosts = Address(listening, "").hosts
        assert hosts == {f"{name}{port}" for name in ("127.0.0.1", "localhost", "[::1]") for port in ("", ":80")}

    @pytest.mark.parametrize(
        ("path", "status", "cached"),
        [
            ("/", 200, "no-cache"),
            ("/app.js", 200, "no-cache"),
            ("/nothing", 404, "no-store"),
            (with_key("/scene/abc/a.f32"), 200, routes.FOREVER),
            (with_key("/scene/abc/b.f32"), 404, "no-store"),
            (with_key("/fails"), 500, "no-store"),
            ("/scene/abc/a.f32", 403, "no-store"),
        ],
    )
    def test_answers_have_the_strict_headers(
        self, page: PageServer, path: str, status: int, cached: str, monkeypatch: pytest.MonkeyPatch
    ) -> None:
        (page.folder / "abc").mkdir()
        (page.folder / "abc" / "a.f32").write_bytes(b"1")
        if status == 500:
            monkeypatch.setattr(page.session, "folder", None)
            path = with_key("/scene/abc/a.f32")
        answer = page.ask(path)
        assert answer.status == status
        assert {name: answer.headers.get_all(name) for name in HEADERS} == {
            name: [text] for name, text in HEADERS.items()
        }
        assert answer.headers.get_all("cache-control") == [cached]
        assert "server" not in answer.headers

    def test_path_that_leads_elsewhere_is_not_found(self, page: PageServer, tmp_path: Path) -> None:
        (tmp_path / "secret").write_text("secret")
        (page.folder / "abc").mkdir()
        (page.folder / "abc" / "a.stl").write_text("of no export")
        (page.folder / "export-1").mkdir()
        for name in ("link", "export-link"):
            (page.folder / name).symlink_to(tmp_path)
        for path in (
            "/scene/../secret", "/scene/%2e%2e/secret", "/scene/abc/..%2f..%2fsecret", "/scene/abc%2f../x",
            "/scene/link/secret", "/scene/abc/%00", f"/scene/abc/{'x' * 5000}", "/scene/abc/", "/scene/incoming/x",
            "/export/abc/%2e%2e", "/export/export-1/..%2f..%2fsecret", "/export/export-link/secret",
            "/export/export-1/", "/export/abc/a.stl", "/export/export-1/%00", f"/export/export-{'x' * 5000}/a",
            "/scene//secret", "/../secret", "/%2e%2e/secret", "/..%2fsecret", "//secret", "/scene", "/scene/",
        ):  # fmt: skip
            assert page.ask(with_key(path)).status == 404, path

    def test_exported_file_is_downloaded_and_never_shown(self, page: PageServer) -> None:
        """A page that an exporter wrote would otherwise be one of this address, with its key."""
        (page.folder / "export-1").mkdir()
        for name in ("a.html", "ä b.svg", "50 % #1?.stl", "a%23b.stl"):
            (page.folder / "export-1" / name).write_text("<script>")
            answer = page.ask(with_key(f"/export/export-1/{quote(name)}"))
            assert (answer.status, answer.text) == (200, "<script>")
            assert answer.headers["content-disposition"].startswith("attachment; filename")
            assert answer.headers["cache-control"] == "no-store"
            assert page.ask(f"/export/export-1/{quote(name)}").status == 403
            assert page.ask(with_key(f"/scene/export-1/{quote(name)}")).status == 404

    def test_other_methods_and_large_uploads_are_refused(self, page: PageServer) -> None:
        for method in ("POST", "DELETE", "PUT", "OPTIONS", "TRACE"):
            assert page.ask(with_key("/scene/abc/a"), method).status == 405
            assert page.ask("/", method).status == 405
        assert page.ask(with_key("/stop")).status == 404
        answer = page.ask(with_key(f"/upload/{NAMES['batch']}/a.png"), "PUT", content_length=str(MAX_BYTES + 1))
        assert (answer.status, "holds more than" in answer.text) == (413, True)


def handshake(page: PageServer, host: str) -> socket.socket:
    """Open a websocket as a browser does, without reading."""
    raw = socket.create_connection(("127.0.0.1", page.port), timeout=LONGEST_S)
    raw.sendall(
        f"GET {with_key('/live')} HTTP/1.1\r\nHost: {host}\r\nOrigin: http://{host}\r\nUpgrade: websocket\r\n"
        f"Connection: Upgrade\r\nSec-WebSocket-Key: {'A' * 22}==\r\nSec-WebSocket-Version: 13\r\n\r\n".encode()
    )
    return raw


def ack(seq: int) -> bytes:
    return ACK_FRAME.pack(ACK, seq)


def pointer(*at: float) -> bytes:
    return POINTER_FRAME.pack(POINTER, 1, 7, 0.0, *at)


class TestFloods:
    def test_tab_that_draws_nothing_is_sent_two_states(self, page: PageServer) -> None:
        with page.tab() as tab:
            sent = partial(_frames, tab)
            until(lambda: sent() == IN_FLIGHT)
            assert sent() == IN_FLIGHT
            tab.socket.send(ack(1))
            until(lambda: sent() == IN_FLIGHT + 1)
            assert sent() == IN_FLIGHT + 1
            tab.socket.send(ack(4_000_000_000))  # of none that was sent
            until(lambda: sent() == 2 * IN_FLIGHT + 1)
            assert sent() == 2 * IN_FLIGHT + 1

    def test_tab_that_reads_nothing_is_cut_off(self, page: PageServer) -> None:
        raw = handshake(page, page.host)
        with page.tab() as other:
            until(lambda: page.done(lambda: len(page.session.tabs.open)) == 2)
            said = 0
            while page.done(lambda: len(page.session.tabs.open)) == 2:
                said += 1
                assert said < 100  # megabytes
                page.done(lambda: page.session.tabs.tell("log", text="x" * 1_000_000))
                other.until(event="log")
        raw.close()

    def test_browser_that_answers_no_ping_is_removed(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(server, "PING_S", 0.1)
        monkeypatch.setattr(routes, "static", lambda: tmp_path)
        with PageServer(tmp_path, monkeypatch) as page, handshake(page, page.host) as raw:
            assert raw.recv(4) == b"HTTP"
            page.done(
                lambda: page.session.tabs.tell("log", text="x" * 4_000_000)
            )  # more than is sent ahead of a reader
            until(lambda: page.done(lambda: not page.session.tabs.open))

    def test_flood_of_pointers_keeps_the_hand_moving(self, page: PageServer) -> None:
        pointers = b"".join(mask_frame(pointer(0.01, 0.0, k * 1e-6)) for k in range(500))
        with page.tab() as tab:
            tab.until(event="holding", holding=True)
            for _ in range(20):
                tab.socket.socket.sendall(pointers)
                until(lambda: page.done(lambda: page.session.feeling.hand.holding))
            assert page.done(lambda: {each.transport.max_size for each in page.server.server_state.connections}) == {
                AT_ONCE_BYTES
            }

    def test_requests_are_bounded_and_stop_is_not(self, page: PageServer) -> None:
        worker: Any = page.session.worker
        page.done(lambda: setattr(worker, "wait", asyncio.Event()))
        with page.tab() as tab:
            for _ in range(MAX_ASKS):
                tab.ask("examples")
            refused = tab.ask("examples")
            assert "not done yet" in tab.until(event="refused", number=refused)["text"]
            stop = tab.ask("stop")
            tab.until(event="loop", running=False)
            tab.until(event="answer", number=stop)
            page.done(worker.wait.set)
            tab.until(event="answer", number=MAX_ASKS)
            tab.until(event="answer", number=tab.ask("examples"))

    def test_unfinished_connections_stop_nobody(self, page: PageServer) -> None:
        with page.tab() as tab:
            tab.until(event="holding", holding=True)
            slow = [socket.create_connection(("127.0.0.1", page.port)) for _ in range(MAX_STRANGERS + 44)]
            for each in slow:
                each.sendall(b"GET / HT")
            tab.socket.send(pointer(0.01, 0, 0))
            tab.ask(None)
            tab.until(event="refused")
            assert page.done(lambda: page.session.feeling.hand.holding)
            assert page.ask(with_key("/stop"), "POST", b"").status == 204
            tab.until(event="loop", running=False, stopped=True)
            assert page.ask("/").status == 200
            slow[0].settimeout(LONGEST_S)
            assert is_closed(slow[0])  # the one that was open longest
            assert not is_closed(slow[-1])
            tab.until(event="answer", number=tab.ask("stop"))
            for each in slow:
                each.close()

    @pytest.mark.whole
    def test_head_of_a_request_has_a_time_limit(self, page: PageServer, monkeypatch: pytest.MonkeyPatch) -> None:
        monkeypatch.setattr(connection, "HEAD_S", 0.2)
        for said in (b"", b"GET / HT", f"GET / HTTP/1.1\r\nHost: {page.host}\r\n\r\nGET / HT".encode()):
            with socket.create_connection(("127.0.0.1", page.port), timeout=LONGEST_S) as raw:
                raw.sendall(said)
                assert is_closed(raw)
        with page.tab() as tab:
            time.sleep(0.6)  # longer than the limit, which ends with the head
            tab.until(event="answer", number=tab.ask("examples"))


def is_closed(raw: socket.socket) -> bool:
    """Read all that is sent; return False if nothing more comes within the socket's time, or for a moment without."""
    raw.settimeout(raw.gettimeout() or 0.2)
    try:
        while raw.recv(4096):
            pass
    except TimeoutError:
        return False
    except ConnectionError:
        pass
    return True


def _frames(tab: Any) -> int:
    """The states that a tab was sent, after it has listened for a while."""
    tab.next(0.3)
    return tab.frames


def mask_frame(body: bytes) -> bytes:
    """A binary frame of a client, with a mask of zeros."""
    return bytes([0x82, 0x80 | len(body), 0, 0, 0, 0]) + body
