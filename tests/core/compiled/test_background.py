"""What is compiled beside this process: it begins with the first kernel, is waited for, and never outlives us."""

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
from tangible_core.compiled.background import Beside, Work, kernels_are_compiled
from tangible_core.errors import Stopped
from tangible_core.runtime.stopping import stoppable

SOON_S = 60.0
PROGRAM = """
import sys, threading
sys.path[:0] = {paths!r}
from test_background import asleep
from tangible_core.compiled.background import Beside, Work, kernels_are_compiled
with Beside(lambda: Work(frozenset(["begun", "never"]), asleep, ())) as process:
    kernels_are_compiled()
    process.wait("begun")
    print(process._child.pid, flush=True)
    {then}
"""


def named(*names: str) -> Iterator[str]:
    yield from names


def asleep() -> Iterator[str]:
    yield "begun"
    time.sleep(300)


def failing() -> Iterator[str]:
    yield "begun"
    raise ValueError


def leaving_its_number(folder: str) -> Iterator[str]:
    Path(folder, str(os.getpid())).touch()
    yield "begun"


def alive(process: int) -> bool:
    """Whether there is such a process, and it has not ended yet."""
    try:
        return Path(f"/proc/{process}/stat").read_text().rpartition(")")[2].split()[0] != "Z"
    except FileNotFoundError:
        return False


def ends(process: int) -> bool:
    """Whether it does so soon."""
    until = time.monotonic() + SOON_S
    while alive(process) and time.monotonic() < until:
        time.sleep(0.02)
    return not alive(process)


def process_of(block: Beside) -> subprocess.Popen[bytes]:
    assert block._child is not None
    return block._child


def test_nothing_is_started_where_no_kernel_is_compiled():
    with Beside(lambda: pytest.fail("was asked for work")) as block:
        block.wait("begun")
    kernels_are_compiled()  # after the block, too
    assert block._child is None
    assert not background._waiting


def test_one_process_is_started_however_many_kernels_are_compiled(tmp_path: Path):
    with Beside(lambda: Work(frozenset(["begun"]), leaving_its_number, (str(tmp_path),))) as block:
        for _ in range(3):
            kernels_are_compiled()
        block.wait("begun")
        block.wait("what it does not do")
    (number,) = tmp_path.iterdir()
    assert number.name == str(process_of(block).pid) != str(os.getpid())


def test_no_work_is_no_process():
    with Beside(lambda: None) as block:
        kernels_are_compiled()
    assert block._child is None


def test_what_was_said_before_is_not_waited_for():
    with Beside(lambda: Work(frozenset("abc"), named, ("a", "b", "c"))) as block:
        kernels_are_compiled()
        for name in "cab":
            block.wait(name)
    assert not alive(process_of(block).pid)


def test_a_process_that_fails_is_not_waited_for():
    with Beside(lambda: Work(frozenset(["begun", "never"]), failing, ())) as block:
        kernels_are_compiled()
        block.wait("never")
    assert process_of(block).returncode


def test_where_no_process_can_be_started_all_goes_on(monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(background, "command", lambda module: ["/nowhere/python"])
    with Beside(lambda: Work(frozenset(["begun"]), named, ("begun",))) as block:
        kernels_are_compiled()
        block.wait("begun")
    assert block._child is None


def test_what_cannot_be_sent_is_not_done():
    with Beside(lambda: Work(frozenset(["begun"]), lambda: iter(()), ())) as block:
        kernels_are_compiled()
        block.wait("begun")
    assert block._child is None


@pytest.mark.parametrize("raised", [ValueError, KeyboardInterrupt, SystemExit])
def test_an_error_leaves_no_process(raised: type[BaseException]):
    block = Beside(lambda: Work(frozenset(["begun"]), asleep, ()))
    with pytest.raises(raised), block:
        kernels_are_compiled()
        block.wait("begun")
        raise raised
    assert not alive(process_of(block).pid)


def test_work_that_is_stopped_waits_no_longer():
    stop = threading.Event()
    block = Beside(lambda: Work(frozenset(["begun", "never"]), asleep, ()))
    with pytest.raises(Stopped), stoppable(stop), block:
        kernels_are_compiled()
        block.wait("begun")
        stop.set()
        block.wait("never")
    assert not alive(process_of(block).pid)


def test_ctrl_c_while_it_is_waited_for_leaves_no_process():
    block = Beside(lambda: Work(frozenset(["begun", "never"]), asleep, ()))
    with hearing(), pytest.raises(KeyboardInterrupt), block:
        kernels_are_compiled()
        block.wait("begun")
        threading.Timer(0.3, os.kill, (os.getpid(), signal.SIGINT)).start()
        block.wait("never")
    assert not alive(process_of(block).pid)


@pytest.mark.parametrize("how", [signal.SIGTERM, signal.SIGKILL])
def test_it_ends_with_the_process_that_started_it(how: signal.Signals):
    paths = [str(Path(__file__).parent), str(Path(__file__).parents[2] / "helpers")]
    code = PROGRAM.format(paths=paths, then="threading.Event().wait()")
    with subprocess.Popen([sys.executable, "-c", code], stdout=subprocess.PIPE, text=True) as program:
        assert program.stdout is not None
        child = int(program.stdout.readline())
        assert alive(child)
        program.send_signal(how)
    assert ends(child)
