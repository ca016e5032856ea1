"""The background compiler: its process starts with the first kernel, can be waited for, and never outlives us."""

import os
import signal
import subprocess
import sys
import threading
import time
from collections.abc import Iterator
from pathlib import Path

import pytest

from ctrl_c import hearing
from tangible_core.compiled import background
from tangible_core.compiled.background import BackgroundCompiler, Work, start_waiting, wait_for
from tangible_core.errors import Stopped
from tangible_core.runtime.stopping import stoppable

SOON_S = 60.0
PROGRAM = """
import sys, threading
sys.path[:0] = {paths!r}
from test_background import yield_and_sleep
from tangible_core.compiled import background
from tangible_core.compiled.background import BackgroundCompiler, Work, start_waiting
with BackgroundCompiler(lambda: Work(frozenset(["begun", "never"]), yield_and_sleep, ())) as process:
    start_waiting()
    process.wait("begun")
    print(process._child.pid, flush=True)
    {then}
"""


def yield_names(*names: str) -> Iterator[str]:
    yield from names


def yield_and_sleep() -> Iterator[str]:
    yield "begun"
    time.sleep(300)


def yield_and_fail() -> Iterator[str]:
    yield "begun"
    raise ValueError


def yield_and_mark(folder: str) -> Iterator[str]:
    Path(folder, str(os.getpid())).touch()
    yield "begun"


def is_alive(process: int) -> bool:
    """Return True if there is such a process and it has not ended."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def ends_soon(process: int) -> bool:
    """Return True if a process ends soon."""
    until = time.monotonic() + SOON_S
    while is_alive(process) and time.monotonic() < until:
        time.sleep(0.02)
    return not is_alive(process)


def process_of(block: BackgroundCompiler) -> subprocess.Popen[bytes]:
    assert block._child is not None
    return block._child


def test_background_compiler_starts_one_process_and_only_to_compile(tmp_path: Path):
    with BackgroundCompiler(lambda: pytest.fail("was asked for work")) as block:
        block.wait("begun")
    start_waiting()  # after the block, too
    assert block._child is None
    assert not background._waiting
    made: list[Work] = []

    def work() -> Work:
        made.append(Work(frozenset(["begun"]), yield_and_mark, (str(tmp_path),)))
        return made[-1]

    with BackgroundCompiler(work) as block:
        for _ in range(3):
            start_waiting()
        assert len(made) == 1
        block.wait("begun")
        block.wait("what it does not do")
    (number,) = tmp_path.iterdir()
    assert number.name == str(process_of(block).pid) != str(os.getpid())


def test_background_without_work_or_pickle_starts_no_process():
    with BackgroundCompiler(lambda: None) as block:
        start_waiting()
    assert block._child is None
    with BackgroundCompiler(lambda: Work(frozenset(["begun"]), lambda: iter(()), ())) as block:
        start_waiting()
        block.wait("begun")
    assert block._child is None


def test_wait_returns_without_a_process_or_after_a_failed_one():
    with BackgroundCompiler(lambda: Work(frozenset("abc"), yield_names, ("a", "b", "c"))) as block:
        start_waiting()
        for name in "cab":
            block.wait(name)
    assert not is_alive(process_of(block).pid)
    with BackgroundCompiler(lambda: Work(frozenset(["begun", "never"]), yield_and_fail, ())) as block:
        start_waiting()
        block.wait("never")
    assert process_of(block).returncode


def test_wait_from_anywhere_lasts_until_the_process_has_compiled_it():
    wait_for("begun")  # without a block, too
    with BackgroundCompiler(lambda: Work(frozenset(["begun"]), yield_names, ("begun",))) as block:
        start_waiting()
        assert block._due == {"begun"}
        wait_for("begun")
        assert not block._due


def test_wait_without_a_process_returns(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(background, "command", lambda module: ["/nowhere/python"])
    with BackgroundCompiler(lambda: Work(frozenset(["begun"]), yield_names, ("begun",))) as block:
        start_waiting()
        block.wait("begun")
    assert block._child is None


@pytest.mark.parametrize("raised", [ValueError, KeyboardInterrupt, SystemExit])
def test_error_in_the_block_ends_the_process(raised: type[BaseException]):
    block = BackgroundCompiler(lambda: Work(frozenset(["begun"]), yield_and_sleep, ()))
    with pytest.raises(raised), block:
        start_waiting()
        block.wait("begun")
        raise raised
    assert not is_alive(process_of(block).pid)


def test_wait_that_is_interrupted_or_stopped_ends_the_process():
    stop = threading.Event()
    block = BackgroundCompiler(lambda: Work(frozenset(["begun", "never"]), yield_and_sleep, ()))
    with pytest.raises(Stopped), stoppable(stop), block:
        start_waiting()
        block.wait("begun")
        stop.set()
        block.wait("never")
    assert not is_alive(process_of(block).pid)
    block = BackgroundCompiler(lambda: Work(frozenset(["begun", "never"]), yield_and_sleep, ()))
    with hearing(), pytest.raises(KeyboardInterrupt), block:
        start_waiting()
        block.wait("begun")
        threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
        block.wait("never")
    assert not is_alive(process_of(block).pid)


@pytest.mark.parametrize("how", [signal.SIGTERM, signal.SIGKILL])
def test_process_ends_with_its_killed_parent(how: signal.Signals):
    paths = [str(Path(__file__).parent), str(Path(__file__).parents[2] / "helpers")]
    code = PROGRAM.format(paths=paths, then="threading.Event().wait()")
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as program:
        assert program.stdout is not None
        child = int(program.stdout.readline())
        assert is_alive(child)
        program.send_signal(how)
    assert ends_soon(child)


def test_wait_for_a_process_that_stands_still_has_a_limit(monkeypatch: pytest.MonkeyPatch, caplog):
    monkeypatch.setattr(background, "LONGEST_S", 0.0)
    with BackgroundCompiler(lambda: Work(frozenset(["begun", "never"]), yield_and_sleep, ())) as block:
        start_waiting()
        block.wait("never")
    assert "stands still; never is compiled here" in caplog.text
