"""Results do not depend on the processor, the BLAS or the number of threads: else a picture feels different elsewhere.

One machine stands for others: everything that chooses its code by the processor is told to choose otherwise, in a
process of its own and on one thread, and what every method finds there is compared with what it finds here on seven.
Only where the two differ does a third process tell which it is. What a machine has not got cannot be left out there,
and need not be.
"""

import ast
import json
import os
import platform
import subprocess
import sys
from collections.abc import Sequence
from contextlib import ExitStack
from pathlib import Path

import numpy as np
import pytest
from numpy._core._multiarray_umath import __cpu_dispatch__, __cpu_features__

PROGRAM = Path(__file__).parent / "helpers" / "every_processor.py"
SIMPLEST_CORE = {"x86_64": "Prescott", "AMD64": "Prescott", "aarch64": "ARMV8", "arm64": "ARMV8"}
THREADS = ("OMP_NUM_THREADS", "OPENBLAS_NUM_THREADS", "MKL_NUM_THREADS", "OPENCV_FOR_THREADS_NUM")

PLAIN_KERNELS = {"NUMBA_CPU_NAME": "generic", "NUMBA_CPU_FEATURES": ""}
"""Of numba, which compiles all kernels anew for it: a minute, for what differs under `fastmath` alone."""
WHEEL_KERNELS = {"NUMBA_CPU_NAME": "x86-64-v3", "NUMBA_CPU_FEATURES": ""}
"""Those of the wheel of a platform (`deploy/platform_wheel.py`)."""
PLAIN = {
    "NPY_DISABLE_CPU_FEATURES": ",".join(each for each in __cpu_dispatch__ if __cpu_features__.get(each)),
    "OPENBLAS_CORETYPE": SIMPLEST_CORE.get(platform.machine(), ""),
    "OPENCV_CPU_DISABLE": "SSSE3,SSE4.1,POPCNT,SSE4.2,AVX,FP16,AVX2,FMA3,AVX512-SKX",
    "OPENCV_IPP": "disabled",
    "ATEN_CPU_CAPABILITY": "default",
    "MKL_ENABLE_INSTRUCTIONS": "SSE4_2",
    "ONEDNN_MAX_CPU_ISA": "SSE41",
    "GLIBC_TUNABLES": "glibc.cpu.hwcaps=-AVX512F,-AVX2,-FMA,-FMA4",
}
"""Another processor: no vectors but the narrowest, and no fused multiplication and addition, from C's library up."""

ROOT = Path(__file__).parents[1]
FREE = {"fastmath"}
"""Options that let a compiler reorder sums."""
SUMMED_BY_A_BLAS = {"dot", "vdot", "inner", "matmul", "tensordot", "convolve", "correlate", "cov", "polyfit"}
ORDERED_BY_THE_PROCESSOR = {"histogram"}
"""Sorts, and values that are equal come in an order that differs."""
MAY = {
    "matches.py": "adds whole numbers that a float holds, exact in any order",
    "pictures.py": "adds whole numbers",
    "kornia_gabor_kernels.py": "is torch's, compared within a tolerance",
    "calibration.py": "has one term",
    "falcons.py": "is a simulated hand, and no result",
    "block.py": "draws",
    "nearest.py": "knows the exact answer on a scene that is made up, and is compared with within a tolerance",
}
"""Files with a matrix product, and why."""
FELT = ("tangible_core", *(f"plugins/{name}" for name in ("authoring", "depth", "export", "render", "texture")))
"""Folders of what is felt or cached; what is only measured or drawn may differ in the last bit."""


def test_sums_are_not_left_to_a_compiler_or_a_blas():
    complaints = [
        f"{path.relative_to(ROOT)}:{node.lineno}: {what}"
        for folder in FELT
        for path in sorted(ROOT.joinpath(folder).rglob("*.py"))
        if "testing" not in path.parts and path.name not in MAY
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8")))
        if (what := left_to_others(node))
    ]
    assert not complaints, "\n".join(complaints)


def left_to_others(node: ast.AST) -> str:
    """What this piece of source leaves to whoever adds it up; empty for nothing."""
    match node:
        case ast.BinOp(op=ast.MatMult()):
            return "@ is a BLAS product; use np.einsum"
        case ast.keyword(arg=str(name)) if name in FREE:
            return f"{name} lets the compiler reorder sums"
        case ast.Attribute(value=ast.Name(id="np"), attr=name) if name in SUMMED_BY_A_BLAS:
            return f"np.{name} is a BLAS's; use np.einsum"
        case ast.Attribute(value=ast.Name(id="np"), attr=name) if name in ORDERED_BY_THE_PROCESSOR:
            return f"np.{name} adds up in an order that differs; use np.bincount"
    return ""


class Running:
    """The program at work under a dispatch."""

    def __init__(self, folder: Path, thread_count: int, environment: dict[str, str], parts: Sequence[str]) -> None:
        folder.mkdir()
        given = {**os.environ, **dict.fromkeys(THREADS, str(thread_count)), "OMP_WAIT_POLICY": "passive", **environment}
        self.folder, self.errors = folder, folder / "errors.txt"
        with self.errors.open("w") as errors:
            self.process = subprocess.Popen(
                [sys.executable, "-P", PROGRAM, folder, str(thread_count), *parts],
                env={name: value for name, value in given.items() if value or name in PLAIN_KERNELS},
                stdout=subprocess.DEVNULL,
                stderr=errors,
            )

    def __enter__(self) -> "Running":
        return self

    def __exit__(self, *_: object) -> None:
        self.process.kill()
        self.process.wait()

    def found(self) -> "Found":
        """Digests, and torch's arrays."""
        assert self.process.wait() == 0, self.errors.read_text()
        with np.load(self.folder / "arrays.npz") as arrays:
            return json.loads((self.folder / "digests.json").read_text()), dict(arrays)


@pytest.mark.timeout(1200)  # kernels are compiled, which a machine at work takes minutes for
@pytest.mark.parametrize(
    ("plain", "parts", "least"),
    [
        pytest.param(PLAIN, ("pictures", "reliefs"), 15, marks=pytest.mark.whole),
        pytest.param(PLAIN, (), 90, marks=pytest.mark.nightly),
        pytest.param(PLAIN | PLAIN_KERNELS, (), 90, marks=pytest.mark.nightly),
        pytest.param(
            PLAIN | WHEEL_KERNELS,
            (),
            90,
            marks=[
                pytest.mark.nightly,
                pytest.mark.skipif(platform.machine() not in ("x86_64", "AMD64"), reason="the code is for x86-64"),
            ],
        ),
    ],
    ids=["some", "same kernels", "own kernels", "kernels of the wheel"],
)
def test_results_are_the_same_on_every_processor_and_with_any_number_of_threads(
    tmp_path: Path, plain: dict[str, str], parts: Sequence[str], least: int
):
    with ExitStack() as running:
        there, here = (
            running.enter_context(Running(tmp_path / name, thread_count, environment, parts))
            for name, thread_count, environment in (("plain", 1, plain), ("here", 7, {}))
        )
        expected, found = there.found(), here.found()
        assert len(expected[0]) > least
        if complaints(expected, found):  # of which of the two?
            alone = running.enter_context(Running(tmp_path / "alone", 1, {}, parts)).found()
            differing = {"seven threads": complaints(alone, found), "another processor": complaints(expected, alone)}
            pytest.fail("; ".join(f"{dispatch}: {', '.join(names)}" for dispatch, names in differing.items() if names))


Found = tuple[dict[str, str], dict[str, np.ndarray]]


def complaints(expected: Found, found: Found) -> list[str]:
    """Names of the results that differ, torch's beyond its tolerance, and of those that one of both has not got."""
    return [
        name
        for equal, one, other in zip((str.__eq__, nearly_equal), expected, found, strict=True)
        for name in sorted(one.keys() | other.keys())
        if name not in one or name not in other or not equal(one[name], other[name])
    ]


def nearly_equal(first: np.ndarray, second: np.ndarray) -> bool:
    """torch's convolutions are summed as the processor likes it: see docs/decisions/0013-every-processor.md."""
    if first.dtype.kind == "i":
        return bool(np.mean(first != second) <= 0.005)
    known = np.isfinite(first)
    return bool(np.array_equal(known, np.isfinite(second)) and np.mean(np.abs(first - second)[known] > 1 / 16) <= 0.005)
