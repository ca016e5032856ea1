"""Photographs as cameras take them: seconds and memory from a JPEG to a touch, what is kept on disk, and what is lost.

`python -m benchmarks.photos MEGAPIXELS FILE` writes one of the photos that are measured.
"""

import os
import subprocess
import sys
import tempfile
from collections.abc import Iterator, Sequence
from functools import partial
from pathlib import Path
from statistics import median
from time import perf_counter
from typing import NamedTuple

import numpy as np

from tangible_core import HapticSurface, load_pipeline
from tangible_core.scene import geometry

from .figures import Figure, judged, part, table
from .house import tangible

SIZES = {12: (4000, 3000), 60: (9000, 6700)}  # columns and rows, by megapixels
SECONDS, PEAK_GB = {12: 3.4, 60: 8.0}, {12: 1.5, 60: 1.5}
RUNS = 3
PIPELINE = """
scene: {{photo: {photo}}}
want: touch
depth: {{use: luminance}}
texture: {{use: gradient, segments: 5}}
workspace: {{width_m: 0.08, relief_m: 0.02}}
render: {{use: proxy}}
device: {{use: mock, path: spiral}}
"""
DOOR = "import sys; from tangible_core import load_pipeline; load_pipeline(sys.argv[1]).touch"


class Process(NamedTuple):
    """What a process took."""

    seconds: float
    processor_s: float  # of all processors together, which what else runs changes little
    peak_gb: float


def section() -> str:
    """Return the section as Markdown."""
    head = (
        f"A JPEG of gradients, shapes and noise, through `luminance`, `gradient` and `proxy`, 80 mm wide. Whole "
        f"processes, kernels compiled, results not kept; medians of {RUNS}. Peak: resident memory."
    )
    with tempfile.TemporaryDirectory() as folder:
        taken = {size: part(f"{size} megapixels", partial(_took, Path(folder), size)) for size in SIZES}
        figures = [*_figures(taken), *part("what is lost", partial(_lost, Path(folder) / "12.yaml"))]
    rows = [
        (f"{size} Mpx", what, f"{took.seconds:.1f} s", f"{took.processor_s:.1f} s", f"{took.peak_gb:.2f} GB")
        for size, (processes, _) in taken.items()
        for what, took in processes.items()
    ]
    names = ("photo", "process", "time", "of processors", "peak")
    return "\n".join([head, "", *table(names, rows), "", *judged(figures)])


# What processes took, by name; and megabytes in the cache and in the folder of results.
Taken = tuple[dict[str, Process], tuple[float, float]]


def _took(folder: Path, size: int) -> Taken:
    photo, file, cache, out = (folder / f"{size}{each}" for each in (".jpg", ".yaml", "-cache", "-out"))
    subprocess.run([sys.executable, "-m", "benchmarks.photos", str(size), str(photo)], check=True)
    file.write_text(PIPELINE.format(photo=photo))
    commands = {
        "`pipeline.touch`": [sys.executable, "-c", DOOR, str(file)],
        "`tangible run`": [tangible(), "run", str(file), "--out", str(out)],
    }
    found: dict[str, Process] = {}
    for name, command in commands.items():
        runs = [_process(command, cache / f"{name}{number}") for number in range(RUNS + 1)][1:]  # the first compiles
        seconds, processor_s = (median(run[column] for run in runs) for column in (0, 1))
        found[name] = Process(seconds, processor_s, max(run.peak_gb for run in runs))
    return found, (_megabytes(cache / f"`tangible run`{RUNS}"), _megabytes(out))


def _process(command: Sequence[str], cache: Path) -> Process:
    start = perf_counter()
    program = subprocess.Popen(
        command,
        stdout=subprocess.DEVNULL,
        stderr=subprocess.DEVNULL,
        env={**os.environ, "TANGIBLE_CACHE_DIR": str(cache)},
    )
    _, status, used = os.wait4(program.pid, 0)
    program.returncode = os.waitstatus_to_exitcode(status)
    if program.returncode:
        raise subprocess.CalledProcessError(program.returncode, command)
    seconds = perf_counter() - start
    return Process(
        seconds, used.ru_utime + used.ru_stime, used.ru_maxrss * (1 if sys.platform == "darwin" else 1024) / 1e9
    )


def _megabytes(folder: Path) -> float:
    return sum(path.stat().st_size for path in folder.rglob("*") if path.is_file()) / 1e6


def _figures(taken: dict[int, Taken]) -> Iterator[Figure]:
    for size, (processes, (cache_mb, out_mb)) in taken.items():
        took = processes["`pipeline.touch`"]
        yield Figure(
            f"{size} Mpx, photo to touch",
            f"<= {SECONDS[size]:g} s",
            f"{took.seconds:.1f} s",
            took.seconds <= SECONDS[size],
        )
        peak = max(process.peak_gb for process in processes.values())
        yield Figure(f"{size} Mpx, peak memory", f"<= {PEAK_GB[size]:g} GB", f"{peak:.2f} GB", peak <= PEAK_GB[size])
        kept = max(cache_mb, out_mb)
        yield Figure(f"{size} Mpx, cache and results, the larger", "<= 150 MB", f"{kept:.0f} MB", kept <= 150)


def _lost(file: Path) -> Iterator[Figure]:
    pipeline = load_pipeline(file, ["workspace.smooth_m=0.0005", "workspace.relief_m=0.005"])
    pipeline.engine.cache = None
    size, disparity, law = pipeline.config.workspace, pipeline.disparity, pipeline.config.render
    assert disparity is not None and law is not None
    felt = pipeline.relief
    whole = geometry.smooth(geometry.make_relief(disparity, None, size.width_m, size.relief_m), size.smooth_m)
    off_m = geometry.resample(whole, felt.height_m.shape).height_m - felt.height_m
    rms_um = 1e6 * float(np.sqrt(np.mean(off_m**2)))
    yield Figure("heights felt, off by rms", "<= 5 um", f"{rms_um:.2f} um", rms_um <= 5)
    path_m = _spiral(whole)
    forces = [law.method.touch(HapticSurface(each)).path(path_m, period_s=0.001) for each in (felt, whole)]
    off = np.linalg.norm(forces[0] - forces[1], axis=1) / np.median(np.linalg.norm(forces[1], axis=1))
    told = f"{100 * np.median(off):.2f} % median, {100 * np.percentile(off, 95):.2f} % for 95 of 100 ticks"
    yield Figure("forces along a spiral, off by", "95 of 100 <= 1 %", told, bool(np.percentile(off, 95) <= 0.01))


def _spiral(relief: geometry.Relief) -> np.ndarray:
    """1 mm below the surface."""
    turn = 2 * np.pi * np.linspace(0, 10, 8000)
    x, y = (0.03 * np.sqrt(turn / turn[-1]) * wave for wave in (np.cos(turn), np.sin(turn)))
    columns, rows = geometry.workspace_to_picture(x, y, relief.height_m.shape, relief.extent_m)
    return np.stack([x, y, relief.height_m[np.rint(rows).astype(int), np.rint(columns).astype(int)] - 0.001], axis=1)


def photo(columns: int, rows: int) -> np.ndarray:
    """Gradients, sixty discs and boxes, and the noise of a sensor."""
    import cv2

    rng = np.random.default_rng(0)
    y, x = np.linspace(0, 1, rows, dtype=np.float32)[:, None], np.linspace(0, 1, columns, dtype=np.float32)
    picture = np.stack(np.broadcast_arrays(60 + 120 * x, 80 + 100 * y, 140 - 80 * x), axis=-1).copy()
    for number in range(60):
        centre, radius = (
            (int(rng.integers(columns)), int(rng.integers(rows))),
            int(rng.integers(columns // 60, columns // 10)),
        )
        colour = tuple(float(level) for level in rng.integers(20, 240, 3))
        if number % 2:
            cv2.circle(picture, centre, radius, colour, -1)
        else:
            cv2.rectangle(picture, centre, (centre[0] + radius, centre[1] + radius // 2), colour, -1)
    for strip in np.array_split(picture, 16):
        strip += rng.normal(0, 8, strip.shape).astype(np.float32)
    return np.clip(picture, 0, 255).astype(np.uint8)


def _write(size: int, path: str) -> None:
    import cv2

    cv2.imwrite(path, photo(*SIZES[size]), [cv2.IMWRITE_JPEG_QUALITY, 90])


if __name__ == "__main__":
    _write(int(sys.argv[1]), sys.argv[2])
