"""The run of a batch: many scenes through one pipeline, on all cores or many machines; resumable at any moment."""

import hashlib
import re
from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from threading import Event
from typing import Any, cast

from tangible_core.errors import ConfigError, OutputError, TangibleError, check_positive, wrong_argument
from tangible_core.files import JsonLines, as_path
from tangible_core.pipeline import Pipeline
from tangible_core.pipeline.config import REMOVE, edit_text, parse_config, read_values
from tangible_core.pipeline.engine import method_identities
from tangible_core.plugins.registry import default_registry
from tangible_core.runtime import check_stopped, check_threads, stoppable
from tangible_core.runtime.system import processors

from .extra import need_all
from .farm import LONGEST_S, Farm
from .job import FULL, Job, Row, empty_row, make_scene
from .manifest import FILES, SceneRow, rows_from, setting_file
from .results import ROWS, last_rows

SCENES = "scenes"
SAFE = re.compile(r"[^\w.+-]")
# The most characters of a folder's name: four bytes each, with a digest, are allowed on any file system.
MAX_IN_NAME = 60


@dataclass(frozen=True)
class BatchOptions:
    """Options for all scenes of a batch."""

    retry: bool = False  # repeat scenes that failed before
    sheets: bool = False
    cache: Path | None = None  # folder for results that scenes have in common; None for none
    chunk: int = 4  # the most scenes that are sent to a worker together
    # Time limit of a scene, seconds; a scene that takes longer is ended, and fails.
    timeout_s: float = LONGEST_S


class JobMaker:
    """A maker of jobs from rows; the key of a job tells a later batch whether its result would be the same."""

    def __init__(self, text: str, path: Path, out: Path, threads: int | None, options: BatchOptions) -> None:
        """Read a pipeline file. Raises: ConfigError for a text that is not YAML."""
        self._text, self._path, self._out, self._threads, self._options = text, path, out, threads, options
        self._place = str(path)
        self._other = _without_files(text, path)
        self._own = _own_files(text, path)
        self._head = hashlib.sha256(f"{text}\n{path.parent}\n{_code(text, path)} {options.sheets}".encode())

    def __call__(self, row: SceneRow) -> Job:
        """Return the job of a row."""
        key = self._head.copy()
        for setting in row.sets:
            key.update(f"{setting}\n{_state(setting_file(setting))}".encode(errors="surrogateescape"))
        has_scene = _has_scene(row)
        for own in () if has_scene else self._own:
            key.update(_state(own).encode())
        cache = str(self._options.cache.absolute()) if self._options.cache else ""
        return Job(
            row.id, key.hexdigest()[:16], self._other if has_scene else self._text, self._place, row.sets,
            str(self._out / SCENES / folder_name(row.id)), self._threads, self._options.sheets, cache,
        )  # fmt: skip

    def check(self, row: SceneRow) -> None:
        """Check the file itself. Raises: ConfigError for mistakes that all scenes share."""
        text = self._other if _has_scene(row) else self._text
        here = _complaints(text, self._path, row.sets)
        if in_common := [line for place, line in _complaints(self._text, self._path, ()).items() if place in here]:
            raise ConfigError(*in_common)


def folder_name(name: str) -> str:
    """Return the folder name of a scene: unsafe characters become `_`, and a digest then keeps the name unique.

    >>> folder_name("vase-12.front"), folder_name("a/b")
    ('vase-12.front', 'a_b-c14cddc0')
    """
    plain = SAFE.sub("_", name).strip(".")[:MAX_IN_NAME]
    digest = hashlib.sha256(name.encode(errors="surrogateescape")).hexdigest()
    return plain if plain == name else f"{plain}-{digest[:8]}"


def _has_scene(row: SceneRow) -> bool:
    return any(setting.startswith("scene.") for setting in row.sets)


def _complaints(text: str, path: Path, sets: tuple[str, ...]) -> dict[object, str]:
    """Return error messages by their places in the tree, as their line numbers change with a scene's files."""
    try:
        parse_config(text, path, default_registry(), sets)
    except ConfigError as error:
        places = [(complaint.location, complaint.text) for complaint in error.complaints]
        return dict(zip(places, map(str, error.args), strict=False))
    except TangibleError as error:
        return {str(error): str(error)}
    return {}


def _code(text: str, path: Path) -> str:
    """Return the version of the program and the code of the file's methods, on which results depend."""
    try:
        methods = method_identities(parse_config(text, path, default_registry()))
    except TangibleError:  # a row may add what is missing
        methods = ""
    return f"{metadata.version('tangible-images')} {methods}"


def _scene(text: str, path: Path) -> dict[str, Any]:
    """Return the files and options of the file's own scene; none for a scene that is a name alone."""
    scene = read_values(text, path).get("scene")
    return cast("dict[str, Any]", scene) if isinstance(scene, dict) else {}


def _own_files(text: str, path: Path) -> list[Path]:
    options = {f"scene.{name}": value for name, value in _scene(text, path).items()}
    return [path.parent / value for key, value in options.items() if key in FILES and isinstance(value, str)]


def _without_files(text: str, path: Path) -> str:
    """Return the pipeline file without the files of its scene, as a row names others; other options stay."""
    if options := _scene(text, path):
        return edit_text(text, path, {key: REMOVE for name in options if (key := f"scene.{name}") in FILES})
    return edit_text(text, path, {"scene": REMOVE}) if "scene" in read_values(text, path) else text


def _state(file: Path | None) -> str:
    """Return the size and modification time of a file, as text for the key."""
    if file is None:
        return ""
    try:
        state = file.stat()
    except (OSError, ValueError):
        return "not there"
    return f"{state.st_size} {state.st_mtime_ns}"


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

    wanted: int = 0  # the number of rows that were read so far
    kept: int = 0  # the number of rows that are kept from an earlier run, as they would be the same now
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
