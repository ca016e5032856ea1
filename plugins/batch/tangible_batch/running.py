"""The run of a batch: many scenes through one pipeline, on all cores or many machines; resumable at any moment."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from threading import Event
from typing import Any

from tangible_core.errors import OutputError, check_positive, wrong_argument
from tangible_core.files import JsonLines, as_path
from tangible_core.pipeline import Pipeline
from tangible_core.runtime import check_stopped, check_threads, stoppable
from tangible_core.runtime.system import processors

from .extra import need_all
from .farm import LONGEST_S, Farm
from .job import FULL, Job, Row, empty_row, make_scene
from .job_maker import BatchOptions, JobMaker
from .manifest import SceneRow, rows_from
from .results import ROWS, last_rows


@dataclass(frozen=True)
class Workforce:
    """The processes of a batch: n workers of this machine with n threads each, or the workers of a scheduler."""

    workers: int | None = None
    threads: int | None = None
    scheduler: str = ""

    @property
    def workers_here(self) -> int:
        """The number of processes of this machine; by default, all threads together are no more than its cores."""
        return self.workers or max(1, processors() // (self.threads or 1))

    @property
    def threads_each(self) -> int | None:
        """The number of threads of a worker; None to leave it to `TANGIBLE_THREADS` on a scheduler's machines."""
        if self.threads is None and self.scheduler:
            return None
        return self.threads or max(1, processors() // self.workers_here)


@dataclass
class Tally:
    """The progress of a batch, in scenes."""

    wanted: int = 0
    """The number of rows that were read so far."""
    kept: int = 0
    """The number of rows that are kept from an earlier run, as they would be the same now."""
    made: int = 0
    failed: int = 0


def batch(
    pipeline: Pipeline,
    rows: Iterable[Mapping[str, Any]],
    out: str | Path = "out/batch",
    *,
    workers: int | None = None,
    threads: int | None = None,
    scheduler: str = "",
    retry: bool = False,
    sheets: bool = False,
    cache: str | Path | None = None,
    timeout_s: float = LONGEST_S,
    stop: Event | None = None,
) -> Iterator[Row]:
    """Yield each scene's row as soon as it is known: `id`, `outcome` (ok or failed), `error`, `seconds`, `figures`, ...

    rows: mappings from keys of the pipeline file to values, `{"id": "one", "scene.photo": "one.jpg"}`. out: folder for
    the files and `rows.jsonl`; what it holds already comes first. workers, threads: here, and in each worker.
    scheduler: address of a Dask scheduler, used instead. retry: repeat scenes that failed. sheets: draw reports.
    cache: folder for results in common. timeout_s: of a scene. stop: ends the batch with the next scene.
    Raises: ConfigError, BatchError, OutputError, Stopped after `stop`. A scene that fails is a row.
    """
    if not isinstance(pipeline, Pipeline):  # pyright: ignore[reportUnnecessaryIsInstance] - not all callers are typed
        raise wrong_argument("pipeline", pipeline, "a Pipeline")
    check_threads(threads)
    check_positive("timeout_s", timeout_s)
    if workers is not None and workers < 1:
        raise wrong_argument("workers", workers, "a whole number from 1, or None for as many as there are cores")
    path = pipeline.config.path or Path("pipeline.yaml")
    scenes = rows_from(rows, Path.cwd())
    text = pipeline.config.as_yaml()
    workforce = Workforce(workers, threads, scheduler)
    options = BatchOptions(retry, sheets, None if cache is None else as_path(cache, "cache"), timeout_s=timeout_s)
    yield from run_batch(text, path.absolute(), scenes, as_path(out, "out"), workforce, options, stop=stop)


def run_batch(
    text: str,
    path: Path,
    scenes: Iterable[SceneRow],
    out: Path,
    workforce: Workforce,
    options: BatchOptions,
    tally: Tally | None = None,
    stop: Event | None = None,
) -> Iterator[Row]:
    """Run a batch as `batch` does, for the text of the pipeline file at a path. tally: is kept up to date."""
    need_all()
    tally, scenes = tally or Tally(), list(scenes)
    job_of = JobMaker(text, path, out.absolute(), workforce.threads_each, options)
    if scenes:  # before the folder: what is refused leaves nothing behind
        job_of.check(scenes[0])
    with stoppable(stop), JsonLines(out / ROWS, alone=True) as file:
        earlier, waiting = last_rows(out), list[Job]()
        for scene in scenes:
            tally.wanted += 1
            job = job_of(scene)
            if (row := earlier.get(scene.id)) and _is_current(row, job, options.retry):
                tally.kept += 1
                tally.failed += row["outcome"] != "ok"
                yield row
            else:
                waiting.append(job)
        del earlier
        for row in _make_rows(waiting, workforce, options) if waiting else ():
            if full := row.get(FULL):
                raise OutputError(f"{full}; the batch ends here, and the same command continues from there")
            row["folder"] = Path(row["folder"]).relative_to(out.absolute()).as_posix()
            file.add_row(row)
            tally.made += 1
            tally.failed += row["outcome"] != "ok"
            yield row


def _is_current(row: Row, job: Job, retry: bool) -> bool:
    """Return True if a row of an earlier batch is the same as the job would give."""
    if row.get("key") != job.key:
        return False
    return Path(job.folder).is_dir() if row["outcome"] == "ok" else not retry


def _make_rows(jobs: list[Job], workforce: Workforce, options: BatchOptions) -> Iterator[Row]:
    """Yield a row for each job, in the order in which they finish."""
    workers = min(workforce.workers_here, len(jobs))
    with Farm(workers, workforce.threads_each or 1, workforce.scheduler) as farm:
        chunk = max(1, min(options.chunk, len(jobs) // (4 * farm.workers)))
        for ended_job in farm.map(make_scene, jobs, chunk, options.timeout_s):
            check_stopped()
            yield ended_job.result or empty_row(ended_job.job, "failed", ended_job.death)
