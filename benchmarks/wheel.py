"""The wheel of a platform: how long a first run takes with its machine code, and what an installation weighs."""

import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from importlib import metadata
from pathlib import Path
from time import perf_counter

from .figures import Figure, judged, part, table

ROOT = Path(__file__).parents[1]
ROUNDS = 5
DEMO = "from tangible_core.cli import main; main()", "demo", "--out", "demo", "--seconds", "1"
NATIVE = """
import time, statistics
from tangible_core import Scene, load_method
pair, method, times = Scene.builtin("motorcycle").views, load_method("depth", "semi-global")(), []
for _ in range(15):
    start = time.perf_counter(); method.estimate(pair); times.append(time.perf_counter() - start)
print(statistics.median(times[3:]))
"""


def section() -> str:
    """Return the section as Markdown."""
    with tempfile.TemporaryDirectory(prefix="tangible-bench-") as folder:
        found = list(_figures(Path(folder)))
    sizes = sorted(_sizes(), key=lambda each: -each[1])[:12]
    return "\n".join(
        [
            f"`tangible demo` from the wheel of `deploy/platform_wheel.py`, {ROUNDS} pairs of whole processes without "
            "results of earlier ones: with an empty folder for kernels, and again.",
            "",
            *judged(found),
            "",
            "The largest distributions of this environment, MB on the disk:",
            "",
            *table(("distribution", "MB"), [(name, f"{size / 1e6:.0f}") for name, size in sizes]),
        ]
    )


def _figures(folder: Path) -> Iterator[Figure]:
    build = [sys.executable, "-m", "build", "-q", "--wheel", "--no-isolation", "--outdir", folder / "dist", ROOT]
    part("wheel", lambda: subprocess.run(build, check=True))
    (pure,) = folder.glob("dist/*.whl")
    make = [sys.executable, ROOT / "deploy" / "platform_wheel.py", pure, "--out", folder / "platform"]
    part("machine code", lambda: subprocess.run(make, check=True))
    (wheel,) = folder.glob("platform/*.whl")
    size = wheel.stat().st_size
    yield Figure("size of the wheel", "<= 25 MB", f"{size / 1e6:.1f} MB", size <= 25e6)
    install = [sys.executable, "-m", "pip", "install", "-q", "--no-deps", "--target", folder / "site", wheel]
    subprocess.run(install, check=True)
    first, again = zip(*(part(f"demo {n + 1}", lambda: _demos(folder)) for n in range(ROUNDS)), strict=True)
    ratio = statistics.median(a / b for a, b in zip(first, again, strict=True))
    told = f"{ratio:.2f}: {statistics.median(first):.1f} s over {statistics.median(again):.1f} s"
    yield Figure("first demo over the second", "<= 1.3", told, ratio <= 1.3)
    common = float(_run(folder, NATIVE))
    native = min(float(_run(folder, NATIVE, NUMBA_OPT="3", NUMBA_CACHE_DIR=str(folder / "native"))) for _ in range(2))
    yield Figure(
        "semi-global by the wheel's code over native code", "<= 1.3", f"{common / native:.2f}", common <= 1.3 * native
    )


def _demos(folder: Path) -> tuple[float, float]:
    with tempfile.TemporaryDirectory() as kernels:
        times: list[float] = []
        for _ in range(2):
            start = perf_counter()
            _run(folder, *DEMO, NUMBA_CACHE_DIR=kernels)
            times.append(perf_counter() - start)
    return times[0], times[1]


def _run(folder: Path, *words: str, **variables: str) -> str:
    with tempfile.TemporaryDirectory() as work:
        environment = (
            os.environ | {"PYTHONPATH": str(folder / "site"), "TANGIBLE_CACHE_DIR": f"{work}/results"} | variables
        )
        program = [sys.executable, "-P", "-c", *words]
        return subprocess.run(program, cwd=work, env=environment, check=True, text=True, capture_output=True).stdout


def _sizes() -> Iterator[tuple[str, int]]:
    for distribution in metadata.distributions():
        files = (Path(str(distribution.locate_file(file))) for file in distribution.files or ())
        yield distribution.name, sum(path.stat().st_size for path in files if path.is_file())
