"""The notice that kernels are compiled."""

import logging
from types import SimpleNamespace

import pytest

from tangible_core.compiled import compiling
from tangible_core.compiled.compiling import BYTECODE, _CompileNotice


class Clock:
    """A clock that tests advance, in seconds."""

    def __init__(self) -> None:
        self.now_s = 100.0

    def __call__(self) -> float:
        return self.now_s


def compile_event(module: str, size: int) -> SimpleNamespace:
    """Return numba's event for a function of a module with `size` bytes of bytecode."""
    function = SimpleNamespace(__module__=module, __code__=SimpleNamespace(co_code=bytes(size)))
    targetctx = SimpleNamespace(refresh=lambda: None)
    return SimpleNamespace(data={"dispatcher": SimpleNamespace(py_func=function, targetctx=targetctx)})


@pytest.fixture
def clock(monkeypatch: pytest.MonkeyPatch) -> Clock:
    clock = Clock()
    monkeypatch.setattr(compiling, "perf_counter", clock)
    return clock


def test_compile_notice_is_logged_once_for_each_of_our_families(caplog, clock: Clock):
    notice = _CompileNotice()
    with caplog.at_level(logging.INFO):
        for module in (
            "numpy.linalg",
            "tangible_render.surface.spline",
            "tangible_render.contact.closest",
            "tangible_devices.mock",
        ):
            event = compile_event(module, 1000)
            notice.on_start(event)
            clock.now_s += 0.5
            notice.on_end(event)
    assert {record.levelname for record in caplog.records} == {"INFO"}, "it is routine, not a warning"
    assert [record.message for record in caplog.records] == [
        f"compiling the render kernels for this processor, about {round(0.5e-3 * BYTECODE['render'])} s; "
        "later runs find them on disk",
        "compiling the devices kernels for this processor, seconds; later runs find them on disk",
    ]


def test_compile_notice_is_measured_by_the_first_finished_function(caplog, clock: Clock):
    notice, kernel, within = (
        _CompileNotice(),
        compile_event("tangible_depth.a", 5000),
        compile_event("tangible_depth.b", 720),
    )
    with caplog.at_level(logging.INFO):
        notice.on_start(kernel)
        clock.now_s += 7.0
        notice.on_start(within)
        clock.now_s += 0.2
        notice.on_end(within)
        clock.now_s += 7.0
        notice.on_end(kernel)
    (message,) = caplog.messages
    assert message.startswith(
        f"compiling the depth kernels for this processor, about {BYTECODE['depth'] * 0.2 / 720:.0f} s;"
    )
