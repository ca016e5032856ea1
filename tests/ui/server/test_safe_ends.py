"""The end of a tab, a loop, the worker or the server: otherwise a hand is pushed by a program that is gone."""

import os
import signal
import socket
import subprocess
import threading
import time
from collections.abc import Callable, Iterator
from contextlib import ExitStack, suppress
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from websockets.exceptions import ConnectionClosed
from websockets.sync.client import connect

from command_line import tangible
from page_server import TestTab
from tangible_core.data import TICK_COLUMNS
from tangible_core.servo.ring import STOP, Ring
from tangible_web.framing import POINTER, POINTER_FRAME
from ui_server import START, UiServer
from waiting import LONGEST_S, until

LEVEL = """\
scene: {height: level.npy}
render: {use: penalty, stiffness_n_per_m: 500}
safety: {ramp_s: 0}
"""
HEARING = (
    "import signal; signal.signal(signal.SIGINT, signal.default_int_handler);"
    "[signal.signal(each, signal.SIG_DFL) for each in (signal.SIGHUP, signal.SIGQUIT)]; "
)
"""Default handlers, as the runner of the tests may ignore Ctrl-C, and nohup ignores the end of a terminal."""
FORCE = slice(TICK_COLUMNS.index("fx_n"), TICK_COLUMNS.index("fx_n") + 3)
AT_ONCE_S = 20.0
"""Bound on the last force, s, for a machine that may stand still; docs/explanation/safety.md has what was measured."""
DIRS = ("RUNTIME", "CONFIG", "LOG", "DATA", "SHARED", "CACHE")
FORBIDDEN = ("numba", "cv2", "torch", "scipy")


class Home:
    """Folders of a user's own, and servers that have them."""

    def __init__(self, folder: Path) -> None:
        self.folder, self.temporary = folder, folder / "tmp"
        self._open = ExitStack()
        for each in (*(folder / name.lower() for name in DIRS), self.temporary):
            each.mkdir()
        own = {f"TANGIBLE_{name}_DIR": str(folder / name.lower()) for name in DIRS}
        self.env = {**own, "TMPDIR": str(self.temporary)}
        np.save(folder / "level.npy", np.zeros((24, 32), np.float32))
        (folder / "level.yaml").write_text(LEVEL)

    def server(self, *words: object, start: str = HEARING + START) -> UiServer:
        return self._open.enter_context(UiServer(*words, cwd=self.folder, env=self.env, start=start))

    def left(self) -> list[str]:
        """Files of servers."""
        folders = [self.folder / "shared", self.folder / "runtime", self.temporary]
        return [
            str(path) for folder in folders for path in folder.iterdir() if "ui-" in path.name or "ring" in path.name
        ]

    def close(self) -> None:
        self._open.close()


@pytest.fixture
def home(tmp_path: Path) -> Iterator[Home]:
    home = Home(tmp_path)
    yield home
    home.close()


class Press:
    """A page whose hand presses a millimetre into level ground, and what the loop's ring says of it."""

    def __init__(self, home: Home, server: UiServer) -> None:
        host = server.url.split("/")[2]
        url = server.url.replace("http", "ws").replace("/?", "/live?")
        self.tab = TestTab(connect(url, origin=f"http://{host}", max_size=None, proxy=None))  # type: ignore[arg-type]
        self._home, self._server, self._read = home, server, len(server.lines)
        self._on, self._quiet = True, False
        hello = self.tab.until(event="hello")
        if "touch" not in [each["event"] for each in hello["history"]]:
            self.tab.until(event="touch")
        self.attach()
        self._thread = threading.Thread(target=self._move, daemon=True)
        self._thread.start()

    def attach(self) -> None:
        """Attach to the running loop."""
        rings = sorted((self._home.folder / "shared").glob("*.ring"), key=lambda path: path.stat().st_mtime)
        self.ring = Ring.attach(rings[-1])

    def _move(self) -> None:
        while self._on:
            if not self._quiet:
                with suppress(ConnectionClosed):
                    self.tab.socket.send(POINTER_FRAME.pack(POINTER, 1, 7, 0.0, 0.0, 0.0, -0.001))
            time.sleep(0.01)

    def feel(self) -> None:
        """Start a loop again after one has ended."""
        self.tab.until(event="answer", number=self.tab.ask("feel"))
        self.attach()

    def press(self) -> None:
        """Press until that is felt, in a new loop if a machine that stood still has ended the last one."""
        self._quiet = False
        try:
            until(self._is_felt)
        except AssertionError:
            lines, state = self._server.lines[1:], self.tab.socket.protocol.state
            raise AssertionError(f"nothing is felt; {self.ring.count} ticks, socket {state!r}, {lines}") from None

    def _is_felt(self) -> bool:
        if self.ring.header[STOP] and any("stood still" in line for line in self._server.lines[self._read :]):
            self._read = len(self._server.lines)
            self.feel()
        row = self.ring.latest()
        return row is not None and row[FORCE][2] > 0.3 and not self.ring.header[STOP]

    def fall_silent(self) -> None:
        self._quiet = True

    def let_go_s(self, fault: Callable[[], Any]) -> float:
        """Return the seconds from the fault to the last force."""
        self.press()
        at_s = time.monotonic() - self.ring.start_ns / 1e9
        fault()
        until(self._is_over, "there is still a force")
        rows, _ = self.ring.since(0)
        times, forces = rows[:, 0], np.abs(rows[:, FORCE]).max(axis=1)
        felt = times[forces > 0]
        return float(felt[-1] - at_s) if len(felt) else 0.0

    def _is_over(self) -> bool:
        row, count = self.ring.latest(), self.ring.count
        time.sleep(0.05)
        return (row is not None and not row[FORCE].any()) or self.ring.count == count

    def close(self) -> None:
        self._on = False
        self._thread.join()
        with suppress(Exception):
            self.tab.close()


def group_is_empty(server: UiServer) -> bool:
    """Return True if neither the server nor a process that it started is alive."""
    try:
        os.killpg(server.process.pid, 0)
    except ProcessLookupError:
        return True
    return False


def children(server: UiServer, name: str) -> list[int]:
    found = subprocess.run(
        ["pgrep", "-g", str(server.process.pid), "-f", name], capture_output=True, text=True, check=False
    )
    return [int(word) for word in found.stdout.split()]


def test_force_ends_with_the_tab_the_loop_and_a_frozen_server(home: Home) -> None:
    server = home.server("level.yaml")
    press = Press(home, server)
    found: dict[str, float] = {}
    found["released"] = press.let_go_s(lambda: (press.fall_silent(), press.tab.socket.send(b"\x04")))
    found["silent, as when frozen, slow or cut off"] = press.let_go_s(press.fall_silent)
    found["socket without a last word"] = press.let_go_s(lambda: (press.fall_silent(), press.tab.socket.socket.close()))
    press.close()

    press = Press(home, server)
    found["closed"] = press.let_go_s(lambda: (press.fall_silent(), press.tab.close()))
    press.close()

    press = Press(home, server)
    [worker] = children(server, "tangible_ui.worker")
    press.press()
    os.kill(worker, signal.SIGKILL)
    press.tab.until(event="maker")
    press.press()  # what is felt goes on
    found["server stands still"] = press.let_go_s(lambda: os.kill(server.process.pid, signal.SIGSTOP))
    os.kill(server.process.pid, signal.SIGCONT)

    found["stop"] = press.let_go_s(lambda: press.tab.ask("stop"))
    assert press.tab.until(event="loop", running=False)["stopped"]
    press.feel()
    host, port = server.url.split("/")[2].split(":")
    unfinished = [socket.create_connection((host, int(port))) for _ in range(300)]
    for each in unfinished:
        each.sendall(b"GET / HT")
    found["stop beside unfinished connections"] = press.let_go_s(lambda: press.tab.ask("stop"))
    for each in unfinished:
        each.close()
    press.feel()
    [loop] = children(server, "servo.child")
    found["loop killed"] = press.let_go_s(lambda: os.kill(loop, signal.SIGKILL))
    assert press.tab.until(event="loop", running=False)["why"]
    press.feel()
    found["server ended"] = press.let_go_s(server.process.terminate)
    press.close()
    assert max(found.values()) < AT_ONCE_S, found
    assert server.stop() == 128 + signal.SIGTERM
    until(lambda: group_is_empty(server), "a process is left")
    assert not home.left()


@pytest.mark.whole
@pytest.mark.parametrize("name", ["SIGINT", "SIGHUP", "SIGQUIT"])
def test_server_ended_by_a_signal_leaves_no_force_and_no_file(home: Home, name: str) -> None:
    server, number = home.server("level.yaml"), getattr(signal, name)
    press = Press(home, server)
    let_go_s = press.let_go_s(lambda: server.process.send_signal(number))
    assert server.process.wait(LONGEST_S) == 128 + number
    press.close()
    assert let_go_s < AT_ONCE_S
    until(lambda: group_is_empty(server), "a process is left")
    server.kill()  # all that it printed is then read
    assert not home.left()
    words = "interrupted" if name == "SIGINT" else f"ended by {name}"
    assert server.lines[-1] == f"{words}; what was finished is kept"


@pytest.mark.whole
def test_server_that_is_killed_leaves_no_force_and_its_draft_is_offered(home: Home) -> None:
    server = home.server("level.yaml")
    press = Press(home, server)
    press.press()
    path = press.tab.until(event="answer", number=press.tab.ask("record"))["value"]
    edited = LEVEL + "# mine\n"
    press.tab.until(event="answer", number=press.tab.ask("edit", text=edited))
    until(lambda: list((home.folder / "data" / "unsaved").glob("*.json")), "it is not kept")
    kept = press.ring.count
    until(lambda: press.ring.count > kept + 300, "nothing is recorded")
    let_go_s = press.let_go_s(lambda: server.process.send_signal(signal.SIGKILL))
    press.close()
    server.process.wait(LONGEST_S)
    assert let_go_s < AT_ONCE_S
    until(lambda: group_is_empty(server), "a process is left")
    assert {Path(each).parent.name for each in home.left()} == {"runtime"}  # the worker removed the folder for pages

    server = home.server("level.yaml")
    press = Press(home, server)
    assert str(server.process.pid) in " ".join(home.left())
    assert all(str(server.process.pid) in each for each in home.left())
    found = press.tab.until(event="answer", number=press.tab.ask("show_record", path=path))["value"]
    assert found["rows"] > 50
    number = press.tab.ask("restore")
    assert press.tab.until(event="document")["text"] == edited
    press.tab.until(event="answer", number=number)
    press.close()
    server.stop()
    assert not home.left()


@pytest.mark.whole
def test_servers_next_to_each_other_import_nothing_that_computes_and_print_their_keys_once(home: Home) -> None:
    looks = f"import atexit, sys; atexit.register(lambda: print('has', [n for n in {FORBIDDEN} if n in sys.modules])); "
    servers = [home.server("level.yaml", "--log-level", "debug", start=HEARING + looks + START) for _ in range(2)]
    presses = [Press(home, each) for each in servers]
    for press in presses:
        press.tab.until(event="answer", number=press.tab.ask("devices"))
        press.close()
    for server in servers:
        assert server.stop() == 128 + signal.SIGTERM
        assert "has []" in server.lines
        assert [line for line in server.lines if server.url.rpartition("=")[2] in line] == [server.url]
        assert not [line for line in server.lines if "never retrieved" in line or "Traceback" in line]
    assert not home.left()


@pytest.mark.whole
@pytest.mark.parametrize("env", [{"TMPDIR": "/nonexistent"}, {"HOME": "/nonexistent"}, {"TANGIBLE_DATA_DIR": "{file}"}])
def test_server_starts_without_folders_of_its_user(home: Home, env: dict[str, str]) -> None:
    told = {name: value.format(file=home.folder / "level.yaml") for name, value in env.items()}
    server = UiServer("level.yaml", cwd=home.folder, env={**home.env, **told}, start=HEARING + START)
    assert server.stop() == 128 + signal.SIGTERM
    assert not [line for line in server.lines if "Traceback" in line]


def test_server_without_a_port_or_a_channel_ends_with_one_sentence(home: Home, monkeypatch: pytest.MonkeyPatch) -> None:
    for name, value in home.env.items():
        monkeypatch.setenv(name, value)
    with socket.create_server(("127.0.0.1", 0)) as taken:
        port = taken.getsockname()[1]
        done = tangible("ui", "level.yaml", "--no-browser", "--port", port, cwd=home.folder)
        assert (done.returncode, done.stdout) == (2, "")
        assert f"--port {port}: Address already in use; 0 takes a free one" in done.stderr
    file = home.folder / "level.yaml"
    monkeypatch.setenv("TANGIBLE_RUNTIME_DIR", str(file))
    done = tangible("ui", "level.yaml", "--no-browser", "--port", 0, cwd=home.folder)
    assert done.returncode == 2
    assert len(done.stderr.splitlines()) == 1 and str(file) in done.stderr
