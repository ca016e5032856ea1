"""The notice that kernels are compiled: a first run seems to hang without it."""

import logging
from types import SimpleNamespace

import pytest

from tangible_core.compiled import compiling
from tangible_core.compiled.compiling import BYTECODE, _CompileNotice


def test_time_that_is_left_follows_from_what_is_compiled(monkeypatch: pytest.MonkeyPatch):
    notice, now_s = _CompileNotice(), [100.0]
    records: list[logging.LogRecord] = []
    handler = SimpleNamespace(level=0, handle=records.append)
    monkeypatch.setattr(compiling.progress_log, "handlers", [handler])
    monkeypatch.setattr(compiling.progress_log, "level", logging.INFO)
    monkeypatch.setattr(compiling, "perf_counter", lambda: now_s[0])
    size = BYTECODE["render"] // 10
    for _ in range(12):  # a tenth of the work in two seconds each, and at last more than was foreseen
        function = SimpleNamespace(__module__="tangible_render.spline", __code__=SimpleNamespace(co_code=bytes(size)))
        event = SimpleNamespace(
            data={"dispatcher": SimpleNamespace(py_func=function, targetctx=SimpleNamespace(refresh=int))}
        )
        notice.on_start(event)
        now_s[0] += 2.0
        notice.on_end(event)
    assert [record.getMessage() for record in records] == [f"about {left} s left" for left in range(16, 0, -2)]
    assert [round(record.__dict__["share"], 1) for record in records] == [tenths / 10 for tenths in range(2, 10)]


def test_compile_notice_is_logged_once_for_each_of_our_families(caplog, monkeypatch: pytest.MonkeyPatch):
    notice, now_s = _CompileNotice(), [100.0]
    monkeypatch.setattr(compiling, "perf_counter", lambda: now_s[0])
    with caplog.at_level(logging.INFO):
        for module in ("numpy.linalg", "tangible_render.spline", "tangible_render.closest", "tangible_devices.mock"):
            function = SimpleNamespace(__module__=module, __code__=SimpleNamespace(co_code=bytes(1000)))
            dispatcher = SimpleNamespace(py_func=function, targetctx=SimpleNamespace(refresh=lambda: None))
            event = SimpleNamespace(data={"dispatcher": dispatcher})
            notice.on_start(event)
            now_s[0] += 0.5
            notice.on_end(event)
    render, devices = (record.getMessage() for record in caplog.records if record.name == compiling.__name__)
    assert f"the render kernels for this processor, about {round(0.5e-3 * BYTECODE['render'])} s;" in render
    assert "the devices kernels for this processor, seconds;" in devices
