"""Many scenes through one pipeline, on all cores or many machines; resumable at any moment."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from pathlib import Path
from threading import Event
from typing import Any

from tangible_core.errors import OutputError, check_positive, wrong_argument
from tangible_core.files.json_lines import JsonLines
from tangible_core.files.paths import as_path
from tangible_core.pipeline.pipeline import Pipeline
from tangible_core.runtime.stopping import check_stopped, stoppable
from tangible_core.runtime.threads import check_threads, processors

from .extra import need_all
from .farm import LONGEST_S, Farm
from .job import FULL, Job, Row, dead_row, make_scene
from .job_maker import BatchOptions, JobMaker
from .manifest import SceneRow, rows_from
from .results import ROWS, kept_rows


@dataclass(frozen=True)
class Workforce:
    """Who works: so many processes of this machine with so many threads each, or those of a scheduler."""

    workers: int | None = None
    threads: int | None = None
    scheduler: str = ""

    @property
    def workers_here(self) -> int:
        """Processes of this machine; with their threads no more than its cores, unless both were said."""
        return self.workers or max(1, processors() // (self.threads or 1))

    @property
    def threads_each(self) -> int | None:
        """Of a worker; None on other machines, whose number of cores is not known here: as `TANGIBLE_THREADS` says."""
        if self.threads is None and self.scheduler:
            return None
        return self.threads or max(1, processors() // self.workers_here)


@dataclass
class Tally:
    """How far a batch is."""

    wanted: int = 0
    """Rows that were read so far."""
    kept: int = 0
    """Of an earlier run, and as they would be now."""
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
    """Each scene's row as soon as it is known: `id`, `outcome` (ok or failed), `error`, `seconds`, `figures`, `files`.

    rows: mappings from keys of the pipeline file to values, `{"id": "one", "scene.photo": "one.jpg"}`; relative files
    are relative to the current folder. out: where files and `rows.jsonl` go; what is there of an earlier batch and
    would be the same is not made again, and yielded first. workers, threads: how many processes of this machine with
    how many threads each; together the cores where nothing is said. scheduler: the address of a Dask scheduler, whose
    workers make the scenes instead. retry: make again what failed before. sheets: draw a whole report of each. cache:
    a folder for results that scenes have in common. timeout_s: a scene that takes longer is ended, and fails. stop:
    set from another thread, it ends the batch with the next scene.
    Raises: ConfigError for a pipeline that no file can say, BatchError for rows or workers, OutputError if the folder
    cannot be written, Stopped after `stop`. A scene that fails is a row.
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
    who = Workforce(workers, threads, scheduler)
    options = BatchOptions(retry, sheets, None if cache is None else as_path(cache, "cache"), timeout_s=timeout_s)
    yield from run_batch(text, path.absolute(), scenes, as_path(out, "out"), who, options, stop=stop)


def run_batch(
    text: str,
    path: Path,
    scenes: Iterable[SceneRow],
    out: Path,
    who: Workforce,
    options: BatchOptions,
    tally: Tally | None = None,
    stop: Event | None = None,
) -> Iterator[Row]:
    """As `batch`, for the text of a pipeline file that stands at a path. tally: is kept up to date."""
    need_all()
    tally = tally or Tally()
    with stoppable(stop), JsonLines(out / ROWS, alone=True) as file:
        held, waiting = kept_rows(out), list[Job]()
        job_of = JobMaker(text, path, out.absolute(), who.threads_each, options)
        for scene in scenes:
            if not tally.wanted:
                job_of.check(scene)
            tally.wanted += 1
            job = job_of(scene)
            if (row := held.get(scene.id)) and _is_current(row, job, options.retry):
                tally.kept += 1
                tally.failed += row["outcome"] != "ok"
                yield row
            else:
                waiting.append(job)
        del held
        for row in _made(waiting, who, options) if waiting else ():
            if full := row.get(FULL):
                raise OutputError(f"{full}; the batch ends here, and the same command goes on from there")
            row["folder"] = Path(row["folder"]).relative_to(out.absolute()).as_posix()
            file.add(row)
            tally.made += 1
            tally.failed += row["outcome"] != "ok"
            yield row


def _is_current(row: Row, job: Job, retry: bool) -> bool:
    """Whether a row of an earlier batch is what the job would give."""
    if row.get("key") != job.key:
        return False
    return Path(job.folder).is_dir() if row["outcome"] == "ok" else not retry


def _made(jobs: list[Job], who: Workforce, options: BatchOptions) -> Iterator[Row]:
    """A row for each, as they are made."""
    workers = min(who.workers_here, len(jobs))
    with Farm(workers, who.threads_each or 1, who.scheduler) as farm:
        fitting = max(1, min(options.chunk, len(jobs) // (4 * farm.workers)))
        for done in farm.map(make_scene, jobs, fitting, options.timeout_s):
            check_stopped()
            yield done.result or dead_row(done.job, done.death)
