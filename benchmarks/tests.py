"""The daily loop: how long the tests take, README's command and what `--whole` adds, and each room's share."""

import json
import os
import re
import resource
import subprocess
import sys
import tempfile
import time
from collections import Counter
from collections.abc import Iterable, Iterator, Mapping
from pathlib import Path

from .figures import Figure, judged, table

ROOT = Path(__file__).parents[1]
# Seconds of README's command, and of what `--whole` adds, on two quiet cores, all kernels compiled before.
COMMANDS = {"": 300, "--whole -m whole": 300}
# Processor seconds of the rooms' tests in README's command; "tests" holds the modules that lie in no room.
BUDGET_S: dict[str, float] = json.loads((ROOT / "tests" / "budget.json").read_text("utf-8"))


def section() -> str:
    """Return the section as Markdown."""
    head = (
        "README's second command without the installation; kernels that numba compiled before and kept are used. "
        "A room that grows past its processor seconds pays: its tests get quicker, or another room gives up as many."
    )
    whole: dict[str, float] = {}
    lines = judged(figures(whole))
    return "\n".join([head, "", *lines, "", *table(("room", "tests", "seconds", "at most", ""), rows(whole))])


def figures(whole: dict[str, float]) -> Iterator[Figure]:
    """Each command once. whole: is given the processor seconds of each test of the whole run."""
    for words, bound_s in COMMANDS.items():
        with tempfile.TemporaryDirectory() as folder:
            begun, before_s, clock_s = time.monotonic(), _processor_s(), time.time()
            command = [sys.executable, "-m", "pytest", "-q", "-p", "processor_time", *words.split()]
            done = subprocess.run(command, cwd=ROOT, env=_environment(folder), capture_output=True, text=True)
            seconds, processor_s = time.monotonic() - begun, _processor_s() - before_s
            if not words:
                whole |= seconds_of_tests(Path(folder))
        sys.stderr.write("".join(line for line in done.stdout.splitlines(True) if line.startswith(("FAILED", "ERROR"))))
        summary = re.sub(r" in [\d.]+s.*", "", done.stdout.strip().splitlines()[-1].strip("= "))
        kernels = compiled_since(clock_s, ROOT)
        said = f"{seconds:.0f} s, {processor_s:.0f} s of processor time, {kernels} kernels compiled; {summary}"
        yield Figure(f"`pytest {words}`".replace(" `", "`"), f"<= {bound_s} s", said, seconds <= bound_s)


def compiled_since(clock_s: float, folder: Path) -> int:
    """Return how many kernels numba has kept below a folder since then: minutes of processor time where it is all."""
    return sum(path.stat().st_mtime >= clock_s for path in folder.rglob("*.nbc"))


def seconds_of_tests(folder: Path) -> dict[str, float]:
    """Read what the plugin `processor_time` wrote: seconds by the id of each test."""
    lines = [line for path in sorted(folder.iterdir()) for line in path.read_text().splitlines()]
    return dict(map(json.loads, lines))


def rows(seconds: Mapping[str, float]) -> Iterable[tuple[str, ...]]:
    """Yield a line a room, the dearest first, and one with what missed its bound marked so."""
    spent, count = Counter[str](), Counter[str]()
    for test, each_s in seconds.items():
        spent[room(test)] += each_s
        count[room(test)] += 1
    for name, room_s in spent.most_common():
        bound_s = BUDGET_S.get(name, 0)
        yield f"`{name}`", str(count[name]), f"{room_s:.1f}", str(bound_s), "" if room_s <= bound_s else "missed"
    whole_s = sum(BUDGET_S.values())
    missed = "" if spent.total() <= whole_s else "missed"
    yield "all", str(count.total()), f"{spent.total():.1f}", f"{whole_s:.0f}", missed


def room(test: str) -> str:
    """Two folders below `tests`, or one where there is one alone; the package for what is tested in docstrings."""
    parts = Path(test.partition("::")[0]).parent.parts
    return "/".join(parts[:3] if parts[1:2] in (("core",), ("plugins",)) else parts[:2])


def _environment(folder: str) -> dict[str, str]:
    helpers = [str(ROOT / "tests/helpers"), *filter(None, [os.environ.get("PYTHONPATH")])]
    return {**os.environ, "PYTHONPATH": os.pathsep.join(helpers), "TANGIBLE_TEST_TIMES": str(Path(folder) / "times")}


def _processor_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
