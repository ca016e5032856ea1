"""Signals end a program as Ctrl-C does, with their own exit codes, and slow work is told while it goes on."""

import logging
import os
import signal
import subprocess
import sys
import time
from pathlib import Path

import pytest

from distributions import distribution
from tangible_core.runtime import stopping
from tangible_core.runtime.signals import ENDING, end_as_ctrl_c, received_signal
from tangible_core.runtime.stopping import warn_if_slow

TANGIBLE = str(Path(sys.executable).with_name("tangible"))


@pytest.fixture(autouse=True)
def _default_handlers():
    """Reset the handlers, which the runner of the tests may have changed."""
    before = {each: signal.signal(each, signal.SIG_DFL) for each in ENDING}
    yield
    for each, handler in before.items():
        signal.signal(each, handler)


@pytest.mark.parametrize("number", ENDING)
def test_signal_first_raises_keyboard_interrupt_and_then_nothing(number: signal.Signals):
    with end_as_ctrl_c():
        with pytest.raises(KeyboardInterrupt):
            os.kill(os.getpid(), number)
        for each in ENDING:
            os.kill(os.getpid(), each)
        assert received_signal() == number
    assert signal.getsignal(number) == signal.SIG_DFL
    with end_as_ctrl_c():
        assert received_signal() is None


def test_signal_ignored_before_stays_ignored():
    signal.signal(signal.SIGHUP, signal.SIG_IGN)
    with end_as_ctrl_c():
        os.kill(os.getpid(), signal.SIGHUP)
    assert received_signal() is None
    assert signal.getsignal(signal.SIGHUP) == signal.SIG_IGN


@pytest.mark.parametrize(
    ("number", "code"), [(signal.SIGTERM, 143), pytest.param(signal.SIGQUIT, 131, marks=pytest.mark.whole)]
)
def test_signal_ends_a_plugin_that_hangs_at_its_import(tmp_path: Path, number: signal.Signals, code: int):
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


log = logging.getLogger("slow")


def test_slow_work_is_reported_while_it_runs(caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(stopping, "LONG_S", 0.01)
    until = time.monotonic() + 60
    with warn_if_slow(log, "importing acme"):
        while not caplog.messages and time.monotonic() < until:
            time.sleep(0.005)
    assert caplog.messages == ["importing acme has taken 0.01 s so far and goes on; Ctrl-C ends it"]
