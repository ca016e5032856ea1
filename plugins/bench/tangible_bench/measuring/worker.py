"""The worker: a process for one measurement, with a job and a result as a line of JSON; it ends with its parent."""

import gc
import json
import math
import os
import statistics
import sys
from collections.abc import Mapping
from dataclasses import asdict, dataclass
from time import perf_counter
from typing import Any, NamedTuple

from tangible_core.data import Kind
from tangible_core.errors import TangibleError
from tangible_core.plugins.registry import load_method
from tangible_core.runtime import Place, import_from, where_kept
from tangible_core.runtime.system import exit_with_parent

from ..memory import start_peak
from ..tasks.task import Task, load_task


@dataclass(frozen=True)
class Job:
    """The description of a measurement, in plain values."""

    kind: Kind
    use: str
    options: Mapping[str, Any]
    scene: Mapping[str, Any]
    perturb: str  # the name of a perturbation, or `none`
    value: float
    finishes: tuple[str, ...]
    warmups: int
    calls: int  # the number of timed calls; 0 to measure errors alone


@dataclass(frozen=True)
class Result:
    """The fields of a row that the process measures."""

    seconds: float | None  # the time of one piece of work; None if nothing was timed
    first_seconds: float | None
    peak_memory_bytes: int | None
    measures: dict[str, float | None]  # the measures; None for a value that is not finite, as JSON has no NaN


def measure(job: Job) -> Result:
    """Run a job in this process. Raises: any error of the method."""
    task = load_task(job.kind)
    method = load_method(job.kind, job.use).model_validate(job.options)
    scene = task.scene.model_validate(job.scene).open()
    if job.perturb in task.perturbations:
        scene = task.perturbations[job.perturb].apply(scene, job.value)
    if not job.calls:
        return Result(None, None, None, _errors(task, job, scene, task.work(task.prepare(method, scene), scene)))
    warm = [_time(task, method, scene).whole_s for _ in range(job.warmups)]
    gc.collect()
    gc.freeze()  # imports and compiled code are not garbage: each collection would look through them again
    growth = start_peak()
    first = _time(task, method, scene)
    peak = growth()
    times = [first.piece_s, *(_time(task, method, scene).piece_s for _ in range(job.calls - 1))]
    return Result(statistics.median(times), [*warm, first.whole_s][0], peak, _errors(task, job, scene, first.result))


def _errors(task: Task, job: Job, scene: Any, result: Any) -> dict[str, float | None]:
    for name in job.finishes:
        result = task.finishes[name](result)
    measures = task.measure(result, scene)
    return {name: float(value) if math.isfinite(value) else None for name, value in measures.items()}


class _Timing(NamedTuple):
    piece_s: float
    whole_s: float  # the time of preparation and work together
    result: Any


def _time(task: Task, method: Any, scene: Any) -> _Timing:
    gc.collect()
    start_s = perf_counter()
    work_input = task.prepare(method, scene)
    ready_s = perf_counter()
    result = task.work(work_input, scene)
    end_s = perf_counter()
    return _Timing((end_s - ready_s) / task.clock.pieces(scene), end_s - start_s, result)


def main() -> None:
    """Run the process."""
    answers = os.dup(1)
    os.dup2(2, 1)
    parent, place, job = json.loads(sys.stdin.buffer.readline())
    exit_with_parent(parent, sys.stdin.buffer, 1)  # without one that waits, it would only disturb measurements
    fields = answer(Place(*place), Job(**job))
    os.write(answers, (json.dumps(fields, allow_nan=False) + "\n").encode())


def answer(place: Place, job: Job) -> dict[str, Any]:
    """Return the fields of the job's row, with `error` if anything fails. place: where to import its method from."""
    try:
        import_from(*place)
        return asdict(measure(job))
    except Exception as error:  # noqa: BLE001 - a method's failure is a result
        rest = "" if isinstance(error, TangibleError) else f"; {where_kept(error)}"
        return {"error": f"{type(error).__name__}: {error}{rest}"}
