"""One measurement in a process of its own: a job in, a result out, both JSON.

The job, and where its method is from, is one line on standard input, which stays open while somebody waits: when it
ends, so does the process. The result is one line on what was standard output; whatever a method prints goes to standard
error.
"""

import gc
import json
import math
import os
import statistics
import sys
import threading
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from time import perf_counter
from typing import Any, NamedTuple

from tangible_core.data import Kind
from tangible_core.errors import TangibleError
from tangible_core.plugins.registry import load_method
from tangible_core.runtime.child_process import Place, import_from
from tangible_core.runtime.failure_log import where_kept

from .memory import start_peak
from .task import Task, load_task


@dataclass(frozen=True)
class Job:
    """Everything that a process needs to know: plain values."""

    kind: Kind
    use: str
    options: Mapping[str, Any]
    scene: Mapping[str, Any]
    """Options of the task's scene."""
    perturb: str
    """Name of a perturbation, or `none`."""
    value: float
    finishes: tuple[str, ...]
    warmups: int
    calls: int
    """Timed ones; 0 where errors alone are wanted."""


@dataclass(frozen=True)
class Result:
    """Fields of a row, as far as the process knows them."""

    seconds: float | None
    """Of one piece of work; None where nothing was timed."""
    first_seconds: float | None
    peak_memory_bytes: int | None
    measures: dict[str, float | None]
    """None where a measure is not finite: JSON has no NaN."""


def measure(job: Job) -> Result:
    """Run a job here. Raises: whatever the method raises."""
    task = load_task(job.kind)
    method = load_method(job.kind, job.use).model_validate(job.options)
    scene = _damaged(task, job)
    if not job.calls:
        return Result(None, None, None, _errors(task, job, scene, task.work(task.prepare(method, scene), scene)))
    warm = [_timed(task, method, scene).whole_s for _ in range(job.warmups)]
    gc.collect()
    gc.freeze()  # imports and compiled code are no garbage: each collection would look through them again
    growth = start_peak()
    first = _timed(task, method, scene)
    peak = growth()
    times = [first.piece_s, *(_timed(task, method, scene).piece_s for _ in range(job.calls - 1))]
    return Result(statistics.median(times), [*warm, first.whole_s][0], peak, _errors(task, job, scene, first.result))


def _errors(task: Task, job: Job, scene: Any, result: Any) -> dict[str, float | None]:
    for name in job.finishes:
        result = task.finishes[name](result)
    found = task.measure(result, scene)
    return {name: float(value) if math.isfinite(value) else None for name, value in found.items()}


def _damaged(task: Task, job: Job) -> Any:
    scene = task.scene.model_validate(job.scene).open()
    return task.perturbations[job.perturb].apply(scene, job.value) if job.perturb in task.perturbations else scene


class _Timing(NamedTuple):
    piece_s: float
    whole_s: float
    """With what comes before the work."""
    result: Any


def _timed(task: Task, method: Any, scene: Any) -> _Timing:
    gc.collect()
    start = perf_counter()
    prepared = task.prepare(method, scene)
    ready = perf_counter()
    result = task.work(prepared, scene)
    end = perf_counter()
    return _Timing((end - ready) / task.clock.pieces(scene), end - start, result)


def main() -> None:
    """The process."""
    answers = os.dup(1)
    os.dup2(2, 1)
    place, job = json.loads(sys.stdin.buffer.readline())
    threading.Thread(target=_end_with_parent, daemon=True).start()
    found = answer(Place(*place), Job(**job))
    os.write(answers, (json.dumps(found, allow_nan=False) + "\n").encode())


def answer(place: Place, job: Job) -> dict[str, Any]:
    """Fields of the job's row. place: where its method is from. Raises: nothing."""
    try:
        import_from(*place)
        return asdict(measure(job))
    except Exception as error:  # noqa: BLE001 - a method's failure is a result
        rest = "" if isinstance(error, TangibleError) else f"; {where_kept(error)}"
        return {"error": f"{type(error).__name__}: {error}{rest}"}


def _end_with_parent() -> None:
    """A method that nobody waits for any more would disturb the next measurement."""
    while os.read(0, 1):
        pass
    os._exit(1)
