"""Loading of compiled kernels from the disk: each start is a second late if it prepares numba to compile."""

import os
import subprocess
import sys
import textwrap
from pathlib import Path

import pytest

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
