"""Many scenes: what it takes to hand them out, in time and memory."""

import csv
import json
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
# Scenes after which memory is looked at first, and from which on speed is measured.
FIRST = 100
ONE_PHOTO = "scene: builtin/brick\nwant: relief\ndepth: luminance\nworkspace: {width_m: 0.04}\n"


def section() -> str:
    """Return the section as Markdown."""
    head = (
        f"`tangible batch` over {COUNT:,} photographs of {TINY[1]} x {TINY[0]} pixels, two workers with a thread each, "
        "`luminance`. The client holds the scheduler. Times are processor times."
    )
    return "\n".join([head, "", *judged(figures())])


def figures() -> Iterator[Figure]:
    """Yield time, memory and failures."""
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        yield from _handing_out(part(f"{COUNT:,} scenes", partial(_tiny, folder)))


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


def _picture(seed: int, shape: tuple[int, int]) -> np.ndarray:
    return np.random.default_rng(seed).integers(0, 256, shape, np.uint8)


def _run(folder: Path, name: str, text: str, rows: list[dict[str, str]], workers: int) -> dict[str, Any]:
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
