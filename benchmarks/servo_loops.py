"""How late a tick is: our loop beside a loop in C."""

import shutil
import statistics
import subprocess
import tempfile
import time
from collections.abc import Iterator
from pathlib import Path

import numpy as np

from tangible_core import HapticSurface, load_method
from tangible_core.data import Spread
from tangible_core.plugins.interfaces import HapticDevice, Touch
from tangible_core.servo import Servo
from tangible_core.servo.ring import SPINS

from .figures import Figure
from .servo_rounds import Round
from .tests_path import Circling

SLICE_S, SLICES = 10.0, 3  # each loop runs for so long, in turn with the others, so often
SOURCE = Path(__file__).with_name("control_loop.c")
LOOPS = {"all compiled": Circling(), "compiled tick, a device that Python asks": Circling(exchanges=True)}


def touch() -> Touch:
    """Return the proxy on waves, which the tip of `Circling` is always in."""
    across = np.linspace(0, 8 * np.pi, 1024)
    heights = (0.002 + 0.001 * np.sin(across)[:, None] * np.sin(across)).astype(np.float32)
    return load_method("render", "proxy")().touch(HapticSurface.from_heights(heights))


def ours(device: HapticDevice, seconds: float) -> tuple[Round, bool]:
    """Return the servo on this device, and whether it was real time."""
    with Servo(touch(), device, seconds=seconds) as servo:
        while servo.running:
            time.sleep(0.1)
        return Round.of(servo.ring), bool(servo.ring.header[SPINS])


def compiled_c(folder: Path) -> Path | None:
    """Return the loop in C, if there is a compiler."""
    compiler = next(filter(None, map(shutil.which, ("cc", "gcc", "clang"))), None)
    if compiler is None:
        return None
    program = folder / "control_loop"
    subprocess.run([compiler, "-O2", "-o", str(program), str(SOURCE)], check=True)
    return program


def in_c(program: Path, seconds: float) -> tuple[Round, bool]:
    """Return the loop in C, and whether it was real time."""
    done = subprocess.run([str(program), str(round(1000 * seconds))], check=True, capture_output=True, text=True)
    real_time, overruns, most_ns, *late = map(int, done.stdout.split())
    return Round(np.array(late), overruns, 1e-9 * most_ns), real_time == 1


def beside_c() -> Iterator[Figure]:
    """p99.9 of the lateness over that of the loop in C, both in slices in turn."""
    bound = "p99.9 of lateness <= 1.0 x C with SCHED_FIFO, <= 1.5 x otherwise"
    with tempfile.TemporaryDirectory() as folder:
        program = compiled_c(Path(folder))
        if program is None:
            yield Figure("loop beside C", bound, "no C compiler was found: not measured", met=False)
            return
        theirs, mine, real_time = [], {name: [] for name in LOOPS}, True
        for _ in range(SLICES):
            found, real_time = in_c(program, SLICE_S)
            theirs.append(found.late_us)
            for name, device in LOOPS.items():
                mine[name].append(ours(device, SLICE_S)[0].late_us)
    for name, spreads in mine.items():
        ratio = statistics.median(a.p999 / b.p999 for a, b in zip(spreads, theirs, strict=True))
        said = f"{ratio:.2f} x; us p50/p99/p99.9/most: {_said(spreads)} against {_said(theirs)} in C"
        yield Figure(
            f"loop, {name}, {SLICES} x {SLICE_S:g} s ({'SCHED_FIFO' if real_time else 'plain sleep'})",
            bound,
            said,
            ratio <= (1.0 if real_time else 1.5),
        )


def _said(spreads: list[Spread]) -> str:
    return "/".join(f"{statistics.median(values):.0f}" for values in zip(*spreads, strict=True))
