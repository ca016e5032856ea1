"""Many scenes: what it takes to hand them out, in time and memory, and what a second worker brings."""

import csv
import json
import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator
from functools import partial
from pathlib import Path
from typing import Any

import numpy as np
from PIL import Image

from .figures import Figure, judged, part

TINY, COUNT, PICTURES = (48, 64), 10_000, 50
LARGER, FEW, ROUNDS = (360, 480), 48, 3
FIRST = 100
"""Scenes after which memory is looked at first, and from which on speed is measured."""
GAIN = 1.7
COUNTS = """
import time
end, count = time.monotonic() + 3, 0
while time.monotonic() < end:
    count += 1
print(count)
"""
ONE_PHOTO = "scene: builtin/brick\nwant: relief\ndepth: luminance\nworkspace: {width_m: 0.04}\n"
ONE_PAIR = "scene: builtin/motorcycle\nwant: relief\ndepth: semi-global\nworkspace: {width_m: 0.04}\n"


def section() -> str:
    """Return the section as Markdown."""
    head = (
        f"`tangible batch` over {COUNT:,} photographs of {TINY[1]} x {TINY[0]} pixels, two workers with a thread each, "
        "`luminance`. The client holds the scheduler. Times are processor times."
    )
    return "\n".join([head, "", *judged(figures())])


def figures() -> Iterator[Figure]:
    """Time, memory, failures; two workers against one."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        yield from _handing_out(part(f"{COUNT:,} scenes", partial(_tiny, folder)))
        yield part("one worker and two", partial(_scaling, folder))


def _tiny(folder: Path) -> dict[str, Any]:
    rows = [{"id": f"s{number}", "scene.photo": f"{number % PICTURES}.png"} for number in range(COUNT)]
    for number in range(PICTURES):
        Image.fromarray(_picture(number, TINY)).save(folder / f"{number}.png")
    return _run(folder, "tiny", ONE_PHOTO, rows, workers=2)


def _handing_out(found: dict[str, Any]) -> Iterator[Figure]:
    failed = found["failed"]
    yield Figure("failures", "0", str(failed), failed == 0)
    client_ms = 1e3 * found["client_s"] / COUNT
    yield Figure("client and scheduler, a scene", "< 5 ms", f"{client_ms:.2f} ms", client_ms < 5)
    worker_ms = 1e3 * found["workers_s"] / COUNT
    yield Figure("worker, a scene (with its start)", "", f"{worker_ms:.1f} ms", True)
    first, last, peak = found["client_mb"][0], found["client_mb"][-1], found["client_peak_mb"]
    told = f"{first:.0f} -> {last:.0f} MB; {peak:.0f} MB at most, with table and gallery"
    yield Figure(f"client, after {FIRST} and {COUNT:,} scenes", "< 150 MB", told, peak < 150)
    sizes = found["worker_mb"]
    told = " -> ".join(f"{size:.0f}" for size in sizes)
    what = f"largest worker, after {', '.join(f'{mark:,}' for mark in found['marks'])}"
    yield Figure(what, "<= 1.1 x from the second to the last", f"{told} MB", sizes[-1] <= 1.1 * sizes[1])


def _scaling(folder: Path) -> Figure:
    """Run rounds of both in turns, so that other work of the machine meets both."""
    left = _picture(0, LARGER)
    Image.fromarray(left).save(folder / "left.png")
    Image.fromarray(np.roll(left, -9, axis=1)).save(folder / "right.png")
    rows = [{"id": f"p{number}", "scene.left": "left.png", "scene.right": "right.png"} for number in range(FEW)]
    ratios = []
    costs: dict[int, list[float]] = {1: [], 2: []}
    for turn in range(ROUNDS):
        found = {each: _run(folder, f"pairs{each}{turn}", ONE_PAIR, rows, each) for each in (1, 2)}
        ratios.append(found[1]["steady_s"] / found[2]["steady_s"])
        for each, took in found.items():
            costs[each].append(1e3 * took["workers_s"] / FEW)
    ratio, machine, load = float(np.median(ratios)), _machine_ratio(), os.getloadavg()[0]
    told = (
        f"{ratio:.2f} x ({min(ratios):.2f} to {max(ratios):.2f}), where bare arithmetic gains {machine:.2f} x; "
        f"worker {np.median(costs[1]):.0f} ms a scene alone, {np.median(costs[2]):.0f} ms beside another; "
        f"load {load:.1f} of {os.cpu_count()}"
    )
    what = f"two workers against one, pairs of {LARGER[1]} x {LARGER[0]}"
    bound = f">= {GAIN} x on idle cores, or {GAIN / 2:.0%} of what arithmetic gains"
    return Figure(what, bound, told, ratio >= min(GAIN, GAIN / 2 * machine))


def _machine_ratio() -> float:
    """Measure the gain of a second process that only counts: 2 on two idle cores, less where two share one."""
    gains = []
    for _ in range(ROUNDS):
        alone, both = _counted(1), _counted(2)
        gains.append(both / alone)
    return float(np.median(gains))


def _counted(processes: int) -> int:
    words = [sys.executable, "-S", "-c", COUNTS]
    started = [subprocess.Popen(words, stdout=subprocess.PIPE, text=True) for _ in range(processes)]
    return sum(int(each.communicate()[0]) for each in started)


def _picture(seed: int, shape: tuple[int, int]) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 256, shape, np.uint8)


def _run(folder: Path, name: str, text: str, rows: list[dict[str, str]], workers: int) -> dict[str, Any]:
    """Return what a process of its own prints."""
    config, manifest = folder / f"{name}.yaml", folder / f"{name}.csv"
    config.write_text(text)
    with manifest.open("w", newline="") as file:
        writer = csv.DictWriter(file, list(rows[0]))
        writer.writeheader()
        writer.writerows(rows)
    words = [sys.executable, "-m", "benchmarks.batch_client", config, manifest, folder / name, workers, FIRST]
    done = subprocess.run(list(map(str, words)), capture_output=True, text=True, check=False)
    if done.returncode:
        raise RuntimeError(done.stderr)
    return json.loads(done.stdout)
