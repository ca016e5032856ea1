"""SIGTERM and SIGHUP end a program as Ctrl-C does, with an exit code of their own."""

import os
import signal
import subprocess
import sys
import threading
from pathlib import Path

import pytest

from distributions import distribution
from tangible_core.runtime.signals import ENDING, end_as_ctrl_c, received_signal

TANGIBLE = str(Path(sys.executable).with_name("tangible"))


@pytest.fixture(autouse=True)
def _as_at_first():
    """Whatever runs the tests may have chosen otherwise."""
    before = {each: signal.signal(each, signal.SIG_DFL) for each in ENDING}
    yield
    for each, handler in before.items():
        signal.signal(each, handler)


@pytest.mark.parametrize("number", ENDING)
def test_the_first_one_is_ctrl_c_and_the_others_wait_for_the_end(number: signal.Signals):
    with end_as_ctrl_c():
        with pytest.raises(KeyboardInterrupt):
            os.kill(os.getpid(), number)
        for each in ENDING:
            os.kill(os.getpid(), each)
        assert received_signal() == number
    assert signal.getsignal(number) == signal.SIG_DFL
    with end_as_ctrl_c():
        assert received_signal() is None


def test_one_that_is_ignored_stays_so():
    """As under nohup."""
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    with end_as_ctrl_c():
        os.kill(os.getpid(), signal.SIGHUP)
    assert received_signal() is None
    assert signal.getsignal(signal.SIGHUP) == signal.SIG_IGN


def test_in_another_thread_nothing_changes():
    found: list[object] = []

    def look() -> None:
        with end_as_ctrl_c():
            found.append(signal.getsignal(signal.SIGTERM))

    thread = threading.Thread(target=look)
    thread.start()
    thread.join()
    assert found == [signal.SIG_DFL]


@pytest.mark.parametrize(("number", "code"), [(signal.SIGTERM, 143), (signal.SIGHUP, 129)])
def test_a_plugin_that_hangs_at_its_import_is_ended(tmp_path: Path, number: signal.Signals, code: int):
    hang = "import sys, time; print('imported', file=sys.stderr, flush=True); time.sleep(600)"
    site = distribution(tmp_path / "site", "hang", {"tangible.depth": {"hang": "hang:Hang"}}, hang=hang)
    tmp_path.joinpath("p.yaml").write_text("scene: builtin/coins\ndepth: hang\n")
    with subprocess.Popen(
        [TANGIBLE, "plan", "p.yaml"], cwd=tmp_path, env={**os.environ, "PYTHONPATH": str(site)},
        stdout=subprocess.DEVNULL, stderr=subprocess.PIPE, text=True,
    ) as program:  # fmt: skip
        assert program.stderr is not None
        assert program.stderr.readline() == "imported\n"
        program.send_signal(number)
        _, errors = program.communicate(timeout=60)
    assert errors == f"ended by {number.name}; what was finished is kept\n"
    assert program.returncode == code
