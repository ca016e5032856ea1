"""From asking for a force to the first one."""

import json
import statistics
import subprocess
import sys
import time
from collections.abc import Iterator
from pathlib import Path

from tangible_core.servo import Servo

from .figures import Figure
from .house import tangible
from .servo_loops import touch
from .tests_path import Circling, Failing

RUNS = 5
CONFIG = Path(__file__).parents[1] / "configs" / "demo.yaml"


def figures() -> Iterator[Figure]:
    """Medians of several starts, everything compiled before."""
    for name, device in {"all compiled": Circling(), "a tick of Python's": Failing(fault="none")}.items():
        seconds = []
        for _ in range(RUNS + 1):
            scene = touch()
            with Servo(scene, device, seconds=0.01) as servo:
                seconds.append(servo.start_s)
        median = statistics.median(seconds[1:])
        yield Figure(f"the loop's process to its first tick, {name}", "<= 3 s", f"{median:.2f} s", median <= 3)
    whole, first = zip(*(_feel() for _ in range(RUNS)), strict=True)
    median = statistics.median(first)
    yield Figure(
        "`tangible feel configs/demo.yaml` to the first tick, all of its surface cached",
        "<= 3 s",
        f"{median:.2f} s, of which the loop's process {statistics.median(whole):.2f} s",
        median <= 3,
    )


def _feel() -> tuple[float, float]:
    """Seconds to the first tick: of the loop's process, and of the whole command."""
    begun = time.time()
    words = [tangible(), "--quiet", "feel", str(CONFIG), "--seconds", "0.05", "--json"]
    done = subprocess.run(words, check=True, capture_output=True, text=True, stdin=subprocess.DEVNULL)
    loop = json.loads(done.stdout)["loop"]
    return loop["start_s"], loop["first_tick_unix_s"] - begun


if __name__ == "__main__":
    print(*figures(), sep="\n", file=sys.stderr)
