"""The daily loop: how long the tests take, all of them and those of a minute."""

import re
import resource
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from .figures import Figure, judged

ROOT = Path(__file__).parents[1]
BOUNDS_S = {"": 240, "-m fast": 60}
"""Of README's command and of the smoke, on two quiet cores, all kernels compiled before."""


def section() -> str:
    """The section of RESULTS.md, as Markdown."""
    head = "README's second command without the installation; kernels are those of the run before, if there was one."
    return "\n".join([head, "", *judged(figures())])


def figures() -> Iterator[Figure]:
    """Each command once."""
    for words, bound_s in BOUNDS_S.items():
        begun, before_s = time.monotonic(), _processor_s()
        command = [sys.executable, "-m", "pytest", "-q", *words.split()]
        done = subprocess.run(command, cwd=ROOT, capture_output=True, text=True)
        seconds, processor_s = time.monotonic() - begun, _processor_s() - before_s
        sys.stderr.write("".join(line for line in done.stdout.splitlines(True) if line.startswith(("FAILED", "ERROR"))))
        summary = re.sub(r" in [\d.]+s.*", "", done.stdout.strip().splitlines()[-1].strip("= "))
        said = f"{seconds:.0f} s, {processor_s:.0f} s of processor time; {summary}"
        yield Figure(f"`pytest {words}`".replace(" `", "`"), f"<= {bound_s} s", said, seconds <= bound_s)


def _processor_s() -> float:
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime
