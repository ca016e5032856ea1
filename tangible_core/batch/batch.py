"""Many scenes through one pipeline, on all cores or many machines; resumable at any moment."""

import hashlib
import re
from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass
from importlib import metadata
from pathlib import Path
from threading import Event
from typing import Any, cast

from ..errors import OutputError, TangibleError, wrong_argument
from ..files.json_lines import JsonLines
from ..files.paths import as_path
from ..pipeline.config import parse_config
from ..pipeline.editing import REMOVE, edited, said
from ..pipeline.pipeline import Pipeline
from ..pipeline.rules import method_identities
from ..plugins.registry import default_registry
from ..runtime.stopping import check_stopped, stoppable
from ..runtime.threads import processors
from .farm import Done, Farm
from .job import FULL, Job, Row, make_scene
from .manifest import FILES, SceneRow, rows_from
from .results import ROWS, kept_rows

SCENES = "scenes"
CHUNK = 4
SAFE = re.compile(r"[^\w.+-]")


@dataclass(frozen=True)
class Workforce:
    """Who works: so many processes of this machine with so many threads each, or those of a scheduler."""

    workers: int | None = None
    threads: int | None = None
    scheduler: str = ""

    @property
    def shares(self) -> tuple[int, int]:
        """Workers and threads. Together they are no more than the cores, unless both were said."""
        cores = processors()
        workers = self.workers or max(1, cores // (self.threads or 1))
        return workers, self.threads or max(1, cores // workers)


@dataclass
class Tally:
    """How far a batch is."""

    wanted: int = 0
    """Rows that were read so far."""
    kept: int = 0
    """Of an earlier run, and as they would be now."""
    made: int = 0
    failed: int = 0


@dataclass(frozen=True)
class BatchOptions:
    """What is done with each scene."""

    retry: bool = False
    """Make again what failed before."""
    sheets: bool = False
    """Draw a whole report of each."""
    cache: Path | None = None
    """Folder for what scenes have in common; None for none."""
    chunk: int = CHUNK
    """Scenes that are handed out together."""


def batch(
    pipeline: Pipeline,
    rows: Iterable[Mapping[str, Any]],
    out: str | Path = "out/batch",
    *,
    workers: int | None = None,
    threads: int | None = None,
    scheduler: str = "",
    stop: Event | None = None,
    options: BatchOptions | None = None,
) -> Iterator[Row]:
    """Each scene's row as soon as it is known: `id`, `outcome` (ok or failed), `error`, `seconds`, `figures`, `files`.

    rows: mappings from keys of the pipeline file to values, `{"id": "one", "scene.photo": "one.jpg"}`; relative files
    are relative to the current folder. out: where files and `rows.jsonl` go; what is there of an earlier batch and
    would be the same is not made again, and yielded first. workers, threads, scheduler: who works.
    Raises: ConfigError for a pipeline that no file can say, BatchError for rows or workers, OutputError if the folder
    cannot be written, Stopped after `stop`. A scene that fails is a row.
    """
    if not isinstance(pipeline, Pipeline):
        raise wrong_argument("pipeline", pipeline, "a Pipeline")
    path = pipeline.config.path or Path("pipeline.yaml")
    scenes = rows_from(rows, Path.cwd())
    text = pipeline.config.as_yaml()
    who = Workforce(workers, threads, scheduler)
    yield from run_batch(text, path.absolute(), scenes, as_path(out, "out"), who, options or BatchOptions(), stop=stop)


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
    tally, held = tally or Tally(), kept_rows(out)
    job_of = _maker(text, path, out.absolute(), who, options)
    waiting: list[Job] = []
    for scene in scenes:
        tally.wanted += 1
        job = job_of(scene)
        row = held.get(scene.id)
        if row and row.get("key") == job.key and not (options.retry and row["outcome"] != "ok"):
            tally.kept += 1
            tally.failed += row["outcome"] != "ok"
            yield row
        else:
            waiting.append(job)
    if not waiting:
        return
    workers, threads = who.shares
    chunk = max(1, min(options.chunk, len(waiting) // (4 * workers)))
    with (
        stoppable(stop),
        JsonLines(out / ROWS) as file,
        Farm(min(workers, len(waiting)), threads, who.scheduler) as farm,
    ):
        for done in farm.map(make_scene, waiting, chunk):
            check_stopped()
            row = _row(done, out)
            if full := row.get(FULL):
                raise OutputError(f"{full}; the batch ends here, and the same command goes on from there")
            file.add(row)
            tally.made += 1
            tally.failed += row["outcome"] != "ok"
            yield row


def _row(done: Done[Job, Row], out: Path) -> Row:
    row = done.result or {"id": done.job.id, "key": done.job.key, "outcome": "failed", "error": done.death}
    return {**row, "folder": Path(done.job.folder).relative_to(out.absolute()).as_posix()}


def _maker(text: str, path: Path, out: Path, who: Workforce, options: BatchOptions) -> Callable[[SceneRow], Job]:
    """(row) -> its job. Raises: ConfigError for a text that is no YAML."""
    other = _without_files(text, path)
    head = hashlib.sha256(f"{text}\n{path.parent}\n{_code(text, path)} {options.sheets}".encode())
    cache = str(options.cache.absolute()) if options.cache else ""

    def made(scene: SceneRow) -> Job:
        key = head.copy()
        for each in scene.sets:
            key.update(f"{each}\n{_state(each)}".encode())
        base = other if any(each.startswith("scene.") for each in scene.sets) else text
        folder = str(out / SCENES / _folder_name(scene.id))
        threads = who.shares[1]
        return Job(
            scene.id, key.hexdigest()[:16], base, str(path), scene.sets, folder, threads, options.sheets, cache
        )  # fmt: skip

    return made


def _code(text: str, path: Path) -> str:
    """What results depend on beside the file and its pictures: the code of the methods that it names."""
    try:
        methods = method_identities(parse_config(text, path, default_registry()))
    except TangibleError:  # a row may say what is missing
        methods = ""
    return f"{metadata.version('tangible-images')} {methods}"


def _folder_name(name: str) -> str:
    """Of a scene, on any system: other characters are left out, and then a digest keeps it apart from others."""
    plain = SAFE.sub("_", name).strip(".")[:80]
    return plain if plain == name else f"{plain}-{hashlib.sha256(name.encode()).hexdigest()[:8]}"


def _without_files(text: str, path: Path) -> str:
    """The pipeline file without its own scene's files, in place of which a row names others; other options stay."""
    scene = said(text, path).get("scene")
    if isinstance(scene, dict):
        keys = [f"scene.{name}" for name in cast("dict[str, Any]", scene)]
        return edited(text, path, {key: REMOVE for key in keys if key in FILES})
    return edited(text, path, {"scene": REMOVE}) if scene is not None else text


def _state(setting: str) -> str:
    """Size and time of the last change of a file that a setting names."""
    key, _, value = setting.partition("=")
    if key not in FILES:
        return ""
    try:
        found = Path(value.strip('"')).stat()
    except OSError:
        return "not there"
    return f"{found.st_size} {found.st_mtime_ns}"
