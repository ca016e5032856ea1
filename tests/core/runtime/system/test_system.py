"""The operating system's answers, simulated: without them ticks come late, or a loop outlives its console."""

import os
import platform
import re
import struct
import subprocess
import sys
import threading
from pathlib import Path
from types import SimpleNamespace

import pytest

import tangible_core
from tangible_core.errors import OutputError
from tangible_core.files.writing import write_text
from tangible_core.runtime.child_process import python
from tangible_core.runtime.system import console, priority, shared_memory
from tangible_core.runtime.system.processes import is_alive

ROOT = Path(tangible_core.__file__).parents[1]
ASKS = re.compile(
    r"\bsys\.platform\b|\bos\.name\b|\b(has|get)attr\((os|sys|signal|socket|mmap),|\bsignal\.SIG(?!INT\b|_IGN\b|_DFL\b)[A-Z]"
    r"|\bimport (fcntl|msvcrt|resource|winreg|_winapi)\b|\bos\.sched_|\bctypes\.(windll|WinDLL)\b"
)
"""What a room would write that asks for the system."""


def test_one_room_knows_the_operating_system():
    runtime = ROOT / "tangible_core" / "runtime"
    files = [*ROOT.glob("tangible_core/**/*.py"), *ROOT.glob("plugins/*/tangible_*/**/*.py")]
    assert len(files) > 700
    asked = {
        f"{path.relative_to(ROOT)}: {found[0]}"
        for path in files
        if runtime not in path.parents and (found := ASKS.search(path.read_text(encoding="utf-8")))
    }
    assert asked == set()


def test_process_that_is_looked_for_lives_on():
    """On Windows, the usual way to ask would end it."""
    with subprocess.Popen([sys.executable, "-c", "input()"], stdin=subprocess.PIPE) as child:
        assert is_alive(child.pid)
        assert is_alive(child.pid)
        assert child.poll() is None
        child.communicate(b"\n")
    assert child.returncode == 0
    assert not is_alive(child.pid)


def test_library_that_is_loaded_finds_nothing_to_read_in_standard_input():
    code = (
        "from tangible_core.runtime.system.console import take_input; import sys; pipe = take_input(); "
        "print(sys.stdin.read() == '', pipe.read(3))"
    )
    done = subprocess.run(python(code), input=b"abc", capture_output=True, check=True)
    assert done.stdout.split() == [b"True", b"b'abc'"]


@pytest.mark.parametrize("message", [console.CLOSED, console.LOGGED_OFF, console.SHUT_DOWN, console.CTRL_BREAK])
def test_process_stays_until_the_force_is_zero_when_its_console_ends(message: int, monkeypatch: pytest.MonkeyPatch):
    """Windows ends the process as soon as the handler returns."""
    over, asked, handlers = threading.Event(), threading.Event(), []
    monkeypatch.setattr(console, "on_console_message", lambda handle: handlers.append(handle) or (lambda: None))
    console.end_before_console(asked.set, over, ignore_ctrl_c=True)
    answers: list[bool] = []
    system = threading.Thread(target=lambda: answers.append(handlers[0](message)))
    system.start()
    assert asked.wait(60)
    assert not answers
    over.set()
    system.join()
    assert answers == [True]


@pytest.mark.parametrize(("code", "says"), [(32, "open"), (5, "open"), (112, "free some space")])
def test_file_that_another_program_has_open_is_named_as_that(
    code: int, says: str, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    def refuse(*_: object) -> None:
        error = PermissionError(13, "Access is denied")
        error.winerror = code  # type: ignore[attr-defined] - of Windows alone
        raise error

    path = tmp_path / "table.csv"
    path.write_text("before")
    monkeypatch.setattr(Path, "replace", refuse)
    with pytest.raises(OutputError, match=says):
        write_text(path, "after")
    assert path.read_text() == "before"
    assert os.listdir(tmp_path) == ["table.csv"]  # noqa: PTH208


def test_shared_memory_is_there_until_it_is_removed():
    path, mine = shared_memory.create("ring", 100)
    theirs = shared_memory.attach(path)
    mine[7] = 5
    assert (theirs[7], shared_memory.exists(path)) == (5, True)
    shared_memory.remove(path)
    shared_memory.remove(path)
    mine[8] = 6
    assert (theirs[8], shared_memory.exists(path)) == (6, False)
    with pytest.raises(OSError, match=r"."):
        shared_memory.attach(path)


ON_LINUX = "x86_64", 314


class FakeCalls:
    """Fakes of the C library's functions, with the arguments of each call."""

    def __init__(self) -> None:
        self.calls: list[tuple] = []

    def __call__(self, name: str):
        return lambda *arguments: self.calls.append((name, *arguments)) or 0


@pytest.fixture
def linux(monkeypatch: pytest.MonkeyPatch) -> FakeCalls:
    """Linux on a 64-bit processor, with a thread of niceness 3 to which real time is refused."""
    fakes = FakeCalls()

    def refuse(*_: object) -> None:
        raise PermissionError(1, "Operation not permitted")

    system = SimpleNamespace(
        SCHED_FIFO=1,
        SCHED_OTHER=0,
        PRIO_PROCESS=0,
        sched_param=lambda number: number,
        sched_setscheduler=refuse,
        sched_getscheduler=lambda _: 0,
        getpriority=lambda *_: 3,
    )
    monkeypatch.setattr(priority, "os", system)
    monkeypatch.setattr(priority, "_c", fakes)
    monkeypatch.setattr(priority.sys, "platform", "linux")
    monkeypatch.setattr(platform, "machine", lambda: ON_LINUX[0])
    return fakes


def test_request_without_rights_sets_shortest_slack_and_slice_and_keeps_niceness(linux: FakeCalls):
    real_time, said = priority.request()
    assert not real_time
    assert said == (
        "plain sleeping: SCHED_FIFO is not permitted (Operation not permitted), so busy programs make ticks late; "
        "give the user an rtprio limit"
    )
    slack, (name, number, thread, attributes, flags) = linux.calls
    assert slack == ("prctl", priority.SET_TIMER_SLACK, 1, 0, 0, 0)
    assert (name, number, thread, flags) == ("syscall", ON_LINUX[1], 0, 0)
    assert struct.unpack("=IIQiIQQQ", attributes) == (48, 0, 0, 3, 0, 100_000, 0, 0)


@pytest.mark.parametrize("policy", [3, 5, 0x40000000])
def test_thread_of_another_class_stays_in_it(policy: int, linux: FakeCalls, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(priority.os, "sched_getscheduler", lambda _: policy)
    priority.shorten_slice()
    assert linux.calls == []
