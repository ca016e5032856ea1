"""The house itself: its structure and words, the start of the command line, and the time that the engine adds."""

import json
import os
import statistics
import subprocess
import sys
import tempfile
from collections.abc import Callable
from functools import partial
from pathlib import Path
from time import perf_counter, process_time

import numpy as np

from tangible_core import load_pipeline
from tangible_core.data import SegmentMap, Views
from tangible_core.pipeline.engine.cache import Cache

from .figures import Figure, judged, table
from .house_structure import structure_rows

ROOT = Path(__file__).parents[1]
START_BOUNDS = {"tangible --help": 2.0, "tangible plugins": 2.2}
PRODUCTS = ("disparity", "segments", "materials", "surface", "touch")


def section() -> str:
    """Return the section as Markdown."""
    return "\n".join([*structure_rows(), "", *start_rows(), "", *overhead_rows(), "", *cache_rows(), "", *demo_rows()])


def start_rows(runs: int = 15) -> list[str]:
    """Wall time of whole processes, in turn, as ratios to importing typer and rich."""
    commands = {
        "python -c 'import typer, rich'": [sys.executable, "-c", "import typer, rich"],
        "tangible --help": [tangible(), "--help"],
        "tangible plugins": [tangible(), "plugins"],
    }
    for command in commands.values():
        wall(command)
    times: dict[str, list[float]] = {name: [] for name in commands}
    for _ in range(runs):
        for name, command in commands.items():
            times[name].append(wall(command))
    base, *others = times
    ratios = {name: statistics.median(a / b for a, b in zip(times[name], times[base], strict=True)) for name in others}
    rows = [
        f"| `{name}` | {1e3 * statistics.median(times[name]):.0f} | {ratio:.2f} | <= {START_BOUNDS[name]} |"
        for name, ratio in ratios.items()
    ]
    head = f"Start, {runs} interleaved runs; `{base}` takes {1e3 * statistics.median(times[base]):.0f} ms."
    return [head, "", "| command | median ms | ratio, median of pairs | bound |", "|---|---|---|---|", *rows]


def overhead_rows(runs: int = 7) -> list[str]:
    """Time of the engine around the stages of the demo: keys, digests, hooks, rules; and of the cache, apart."""
    stages, engine, digest, store, recall = [], [], [], [], []
    for _ in range(runs + 1):
        pipeline = load_pipeline(ROOT / "configs" / "demo.yaml")
        pipeline.engine.cache = None
        views: Views = pipeline.scene.views  # reading the scene is not the engine's
        start = perf_counter()
        records = [(product, pipeline.make(product)) for product in PRODUCTS]
        keys = [pipeline.engine.key(product) for product, _ in records]
        total = perf_counter() - start
        ran = sum(outcome.seconds for outcome in pipeline.outcomes if outcome.outcome == "ran")
        stages.append(ran)
        engine.append(total - ran)
        digest.append(timed(views.digest))
        with tempfile.TemporaryDirectory() as folder:
            cache = Cache(Path(folder))
            kept = [(key, record) for key, (product, record) in zip(keys, records, strict=True) if product != "touch"]
            store.append(sum(timed(partial(cache.put, key, record)) for key, record in kept))
            recall.append(sum(timed(partial(cache.entry, key)) for key, _ in kept))
    median = {
        "stages themselves": statistics.median(stages[1:]),
        "engine in all: rules, keys, hooks, digests": statistics.median(engine[1:]),
        "of it: digest of the views": statistics.median(digest[1:]),
        "cache, writing every record": statistics.median(store[1:]),
        "cache, reading every record": statistics.median(recall[1:]),
    }
    base = median["stages themselves"]
    rows = [f"| {name} | {1e3 * value:.2f} | {100 * value / base:.2f} % |" for name, value in median.items()]
    head = f"Engine on configs/demo.yaml, median of {runs} runs after a warm-up; bound: engine <= 2 % of the stages."
    return [head, "", "| what | ms | of the stages |", "|---|---|---|", *rows]


def cache_rows(others: int = 50_000, kept: int = 300) -> list[str]:
    """Processor time to keep a small result beside many others, each time by a cache that knows nothing yet."""
    record = SegmentMap(np.zeros((20, 20), np.int32))
    with tempfile.TemporaryDirectory() as folder:
        place = Path(folder)
        Cache(place).put(f"{0:064x}", record)
        content = (place / f"{0:064x}.npz").read_bytes()
        for number in range(1, others):
            (place / f"{number:064x}.npz").write_bytes(content)
        times_ms: list[float] = []
        for number in range(others, others + kept):
            cache, start = Cache(place), process_time()
            cache.put(f"{number:064x}", record)
            times_ms.append(1e3 * (process_time() - start))
    middle, worst = statistics.median(times_ms), sorted(times_ms)[int(0.95 * kept)]
    said = f"{middle:.2f}, 95 %: {worst:.2f} ms"
    return judged([Figure(f"a result kept beside {others:,} others, median", "< 2 ms", said, worst < 2)])


# What other programs of this field import before they do anything: the second run of the demo is measured by it.
LIBRARIES = "import numba, cv2, scipy.ndimage, matplotlib.pyplot"


def demo_rows(rounds: int = 3) -> list[str]:
    """`tangible demo` with nothing compiled or kept, again, and with kernels alone."""
    imports = [sys.executable, "-c", LIBRARIES]
    wall(imports)
    bases: list[float] = []
    runs = ("first on a machine", "second", "another, its results not kept")
    times: dict[str, list[float]] = {run: [] for run in runs}
    products: dict[str, str] = {}
    for _ in range(rounds):
        with tempfile.TemporaryDirectory() as kernels, tempfile.TemporaryDirectory() as results:
            for run, folder in zip(runs, (results, results, f"{results}/others"), strict=True):
                seconds, products[run] = demo(Path(folder), Path(kernels))
                times[run].append(seconds)
            bases.append(wall(imports))
    median = {run: statistics.median(times[run]) for run in runs}
    ratio = statistics.median(a / b for a, b in zip(times[runs[0]], times[runs[1]], strict=True))
    light = statistics.median(a / b for a, b in zip(times[runs[1]], bases, strict=True))
    bounds = [
        Figure("first run", "<= 10 s", f"{median[runs[0]]:.1f} s", median[runs[0]] <= 10),
        Figure("first run over the second, median of pairs", "<= 3", f"{ratio:.2f}", ratio <= 3),
        Figure(f"second run over `python -c '{LIBRARIES}'`, median of pairs", "<= 2.5", f"{light:.2f}", light <= 2.5),
    ]
    return [
        f"`tangible demo`, whole processes, medians of {rounds}: nothing compiled or kept, again, and kernels alone.",
        "",
        *table(("run", "seconds", "products"), [(run, f"{median[run]:.1f}", products[run]) for run in runs]),
        "",
        *judged(bounds),
    ]


def demo(folder: Path, kernels: Path) -> tuple[float, str]:
    """Seconds, and what became of each product."""
    command = [tangible(), "demo", "--json", "--out", str(folder / "out")]
    own = {"TANGIBLE_CACHE_DIR": str(folder / "c"), "NUMBA_CACHE_DIR": str(kernels)}
    start = perf_counter()
    done = subprocess.run(command, capture_output=True, text=True, check=True, env={**os.environ, **own})
    seconds = perf_counter() - start
    return seconds, ", ".join(f"{run['product']} {run['outcome']}" for run in json.loads(done.stdout)["outcomes"])


def tangible() -> str:
    """Return the command of this environment."""
    return str(Path(sys.executable).with_name("tangible"))


def wall(command: list[str]) -> float:
    """Seconds of one process."""
    start = perf_counter()
    subprocess.run(command, stdout=subprocess.DEVNULL, check=True)
    return perf_counter() - start


def timed(work: Callable[[], object]) -> float:
    """Seconds of one call."""
    start = perf_counter()
    work()
    return perf_counter() - start
