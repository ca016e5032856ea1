"""The notice that kernels are compiled: a first run seems to hang without it."""

import logging
from types import SimpleNamespace

import pytest

from tangible_core.compiled import compiling
from tangible_core.compiled.compiling import BYTECODE, _CompileNotice


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
    render, devices = caplog.messages
    assert f"the render kernels for this processor, about {round(0.5e-3 * BYTECODE['render'])} s;" in render
    assert "the devices kernels for this processor, seconds;" in devices
