"""The warning for slow work: a plugin that hangs at its import looks like a program that hangs."""

import logging
import time

import pytest

from tangible_core.runtime import stopping
from tangible_core.runtime.stopping import warn_if_slow

log = logging.getLogger("slow")


def test_slow_work_is_reported_while_it_runs(caplog: pytest.LogCaptureFixture, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(stopping, "LONG_S", 0.01)
    until = time.monotonic() + 60
    with warn_if_slow(log, "importing acme"):
        while not caplog.messages and time.monotonic() < until:
            time.sleep(0.005)
    assert caplog.messages == ["importing acme has taken 0.01 s so far and goes on; Ctrl-C ends it"]
