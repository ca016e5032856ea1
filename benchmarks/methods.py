"""Every method with its defaults, side by side on one scene a kind: what `tangible plugins show` says of its figures.

The figures go into the program itself, tangible_core/metrics/measured.json, with the machine that they are of.
"""

import math
import statistics
import tempfile
from datetime import date
from pathlib import Path
from time import perf_counter

from tangible_bench.comparing import Step, compare
from tangible_bench.config.reading import parse_comparison
from tangible_bench.measuring.plan import machine
from tangible_bench.results.summary import Line
from tangible_bench.tasks.task import load_task
from tangible_core.metrics import measured
from tangible_core.metrics.measured import Kinds, Measured
from tangible_core.plugins.registry import default_registry
from tangible_core.provenance.versions import versions

from .figures import part, table

OURS = "tangible-images"
SCENES = {"depth": "builtin/motorcycle", "texture": "mosaic/4", "render": "analytic/sine"}
SHOWN = {"depth": ("bad2", "average_px"), "texture": ("ari", "accuracy"), "render": ("error_percent", "jnd")}
ROUNDS = 3


def section() -> str:
    """Return the section as Markdown; the same figures are written into the program."""
    found = {kind: part(kind, lambda kind=kind: side_by_side(kind)) for kind in SCENES}
    Path(measured.__file__).with_name(measured.FILE).write_bytes(Kinds.dump_json(found, indent=1) + b"\n")
    return "\n".join(line for kind, each in found.items() for line in (*rows(kind, each), "")).rstrip()


def side_by_side(kind: str) -> Measured:
    """Our methods of one kind."""
    registry = default_registry()
    names = [listing.name for listing in registry.listings if listing.kind == kind and listing.distribution == OURS]
    text = f"compare: {kind}\nmethods: [{', '.join(names)}]\nscenes: [{SCENES[kind]}]\nrepeats: {ROUNDS}\n"
    clock = Clock()
    with tempfile.TemporaryDirectory() as folder:
        comparison = parse_comparison(f"{text}out: out\n", Path(folder) / f"{kind}.yaml", registry)
        results = compare(comparison, progress=clock.heard).results
    task = load_task(kind)
    columns = (task.clock.unit, "peak MB", *(task.measures[name].title for name in SHOWN[kind]))
    figures = {line.method: values(line, kind) for line in results.means() if math.isfinite(line.seconds)}
    failed = {cell.method: cell.error for cell in results.cells.values() if cell.error}
    took = {name: round(statistics.median(seconds), 2) for name, seconds in clock.seconds.items()}
    return Measured(SCENES[kind], str(date.today()), machine(), versions(OURS), columns, figures, took, failed)


class Clock:
    """How long the processes of each method take."""

    def __init__(self) -> None:
        self.seconds: dict[str, list[float]] = {}
        self._since = 0.0

    def heard(self, step: Step) -> None:
        """Print that a process begins, or has ended."""
        if step.is_end:
            self.seconds.setdefault(step.row.method, []).append(perf_counter() - self._since)
        self._since = perf_counter()


def values(line: Line, kind: str) -> tuple[float | None, ...]:
    """Round a figure to its significant digits."""
    task = load_task(kind)
    time, memory = task.clock.per_second * line.seconds, line.memory_bytes / 1e6
    errors = [(line.measures.get(name, math.nan), task.measures[name].digits) for name in SHOWN[kind]]
    return tuple(known(*each) for each in ((time, 1), (memory, 1), *errors))


def known(value: float, digits: int) -> float | None:
    """None for what is not finite."""
    return round(value, digits) if math.isfinite(value) else None


def rows(kind: str, found: Measured) -> list[str]:
    """As a table."""
    lines = [
        (name, *("-" if value is None else f"{value:g}" for value in method)) for name, method in found.methods.items()
    ]
    failed = [(name, why, *("" for _ in found.columns[1:])) for name, why in found.failed.items()]
    head = f"{kind}: {found.scene}, every method with its defaults, median of {ROUNDS} processes."
    return [head, "", *table(("method", *found.columns), [*lines, *failed])]
