"""Kernels from the disk, or compiled with a notice. Otherwise each start is late, or a first run seems to hang."""

import logging
import os
import subprocess
import sys
import textwrap
from pathlib import Path
from types import SimpleNamespace

import pytest

from tangible_core.compiled import compiling
from tangible_core.compiled.compiling import BYTECODE, _CompileNotice

KERNELS = """
import numpy as np
from numba import njit
from tangible_core.compiled.compiling import KERNEL

@njit(**KERNEL)
def double(values):
    for i in range(values.size):
        values[i] += values[i]

@njit(**KERNEL)
def halve(values):
    for i in range(values.size):
        values[i] /= 2

@njit(cache=True)
def ones(count):
    return np.ones(count)
"""
"""Two kernels of ours, and a function that allocates an array and so uses numba's runtime."""
USE = """
import sys
import numpy as np
from acme_kernels import double, halve, ones

def report(value, kernel):
    print(float(value), sum(kernel.stats.cache_misses.values()), "numba.np.linalg" in sys.modules)

values = np.array([3.0])
"""


@pytest.fixture
def use(tmp_path: Path):
    """Return a function that runs code with the kernels in a new process and returns its words."""
    (tmp_path / "acme_kernels.py").write_text(KERNELS)
    own = {**os.environ, "NUMBA_CACHE_DIR": str(tmp_path / "compiled")}

    def run(code: str) -> list[str]:
        whole = USE + textwrap.dedent(code)
        return subprocess.check_output([sys.executable, "-c", whole], text=True, cwd=tmp_path, env=own).split()

    return run


def test_kernel_on_disk_is_loaded_without_preparing_numba_to_compile(use):
    code = "double(values); report(values[0], double)"
    assert (use(code), use(code)) == (["6.0", "1", "True"], ["6.0", "0", "False"])


@pytest.mark.whole
def test_kernel_compiled_after_another_was_loaded_gives_its_result(use):
    use("double(values)")
    code = "double(values); halve(values); report(values[0], double); report(values[0], halve)"
    assert use(code) == ["3.0", "0", "True", "3.0", "1", "True"]


def test_notice_tells_the_time_that_is_left_once_a_family(caplog, monkeypatch: pytest.MonkeyPatch):
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
