"""Moving a pointer device along a path, or by typed positions."""

import io
import json
import math
import sys
import time
from collections.abc import Callable, Iterable, Iterator
from itertools import count
from queue import Empty, Queue
from threading import Thread

from tangible_core.data import Force, Vector
from tangible_core.errors import ConfigError, DeviceError, check_positive, did_you_mean, quoted

from ..paths import DRAWN, walk
from .client import PointerClient

PERIOD_S = 0.005
SHOWN_EVERY = 20  # sends per printed line: ten lines a second
MAX_BUTTONS = 1 << 31  # exclusive upper bound of a sum of the bits of 31 buttons
Step = tuple[Vector, int]


def follow(
    path: str,
    channel: str,
    seconds: float,
    height_m: float,
    speed_m_per_s: float,
    wait_s: float,
    as_json: bool,
    complain: Callable[[str], None],
) -> Iterator[str]:
    """Move the pointer, and yield a heading, then lines of position and force. Raises: ConfigError, DeviceError."""
    if path and path not in DRAWN:
        raise ConfigError(f"--path {path}: there is no such path{did_you_mean(path, DRAWN)}; {', '.join(DRAWN)}")
    check_positive("--seconds", seconds)
    check_positive("--speed-mm-per-s", 1000 * speed_m_per_s)
    if not math.isfinite(height_m):
        raise ConfigError(f"--height-mm: is {1000 * height_m}; it must be finite")
    steps = _path_steps(path, seconds, height_m, speed_m_per_s) if path else _typed_steps(sys.stdin, complain)
    with PointerClient(channel, wait_s) as client:
        if not as_json:
            yield "".join(f"{name:>10}" for name in ("x mm", "y mm", "z mm", "fx N", "fy N", "fz N"))
        for (position_m, buttons), is_printed in steps:
            client.send(position_m, buttons)
            time.sleep(PERIOD_S)
            if is_printed:
                yield _line(position_m, client.force(), as_json)


def _line(position_m: Vector, force: Force, as_json: bool) -> str:
    if as_json:
        return json.dumps({"position_m": position_m, "force_n": force})
    numbers = [f"{1000 * part:10.3f}" for part in position_m] + [f"{part:10.4f}" for part in force]
    return "".join(numbers)


def _path_steps(path: str, seconds: float, height_m: float, speed_m_per_s: float) -> Iterator[tuple[Step, bool]]:
    """Yield steps along a path, and whether to print the force there."""
    stroke = walk(DRAWN[path]((0.06, 0.04), 8, height_m, height_m + 0.03), speed_m_per_s, PERIOD_S)
    start = time.monotonic()
    for number in count(1):
        seconds_so_far = time.monotonic() - start
        if seconds_so_far >= seconds:
            return
        yield (stroke.at(round(seconds_so_far / PERIOD_S)), 0), number % SHOWN_EVERY == 0


def _typed_steps(lines: Iterable[str], complain: Callable[[str], None]) -> Iterator[tuple[Step, bool]]:
    """Yield each typed position for a while, the last one continually, so that the client does not fall silent."""
    if isinstance(lines, io.TextIOWrapper):
        lines.reconfigure(errors="replace")  # bytes that are not text are an invalid position, not an end
    queue: Queue[str | None] = Queue()

    def enqueue() -> None:
        for line in lines:
            queue.put(line.strip())
        queue.put(None)

    Thread(target=enqueue, daemon=True).start()
    step: Step = ((0.0, 0.0, 1.0), 0)
    while (line := _next(queue)) is not None:
        try:
            step = parse(line) if line else step
        except DeviceError as error:
            complain(str(error))
            line = ""
        for number in range(1, SHOWN_EVERY + 1):
            yield step, bool(line) and number == SHOWN_EVERY


def parse(line: str) -> Step:
    """Parse a typed position: x, y, z in millimetres, and optionally buttons as a sum of bits.

    >>> parse("10 -5 2.5 1")
    ((0.01, -0.005, 0.0025), 1)
    """
    try:
        x, y, z, *rest = line.replace(",", " ").split()
        buttons = int(*rest)
        position_m = float(x) / 1000, float(y) / 1000, float(z) / 1000
        if not all(map(math.isfinite, position_m)) or not 0 <= buttons < MAX_BUTTONS:
            raise ValueError
        return position_m, buttons
    except (ValueError, TypeError) as error:
        raise DeviceError(f"{quoted(line)} is not a position; type x y z in millimetres, such as 10 -5 2.5") from error


def _next(queue: "Queue[str | None]") -> str | None:
    """Return the next line, None after the last, empty while there is none yet."""
    try:
        return queue.get_nowait()
    except Empty:
        return ""
