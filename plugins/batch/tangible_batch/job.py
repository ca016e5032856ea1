"""The job of one scene of a batch. Every failure becomes a row; the job does not depend on the process that runs it."""

import errno
import logging
import math
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any, cast

from tangible_core.data import Record
from tangible_core.errors import OutputError, TangibleError, shown
from tangible_core.metrics import disparity_errors
from tangible_core.pipeline import Pipeline
from tangible_core.pipeline.config import parse_config
from tangible_core.pipeline.engine import Cache, write_record
from tangible_core.plugins.registry import default_registry
from tangible_core.runtime import limited_threads

from .card import write_card

log = logging.getLogger(__name__)
Row = dict[str, Any]
"""The result of a scene as JSON: `id`, `key`, `outcome` (ok or failed), `error`, `seconds`, `figures`, `stages`
(seconds of each that ran), `notes`, `files`."""
FULL = "full"
"""The key of an error that is not a scene's fault: the disk is full."""
MOST_IN_ERROR = 500
"""The most characters of an error message in a row."""


@dataclass(frozen=True)
class Job:
    """The description of a scene's job, in plain values."""

    id: str
    key: str
    """The hash of all that the scene's result depends on, as far as it is known beforehand."""
    text: str
    """The text of the pipeline file."""
    path: str
    """The path of the pipeline file: for relative files in it, and for error messages."""
    sets: tuple[str, ...]
    folder: str
    """The folder for the files of this scene."""
    threads: int | None = None
    """The number of threads; None for the limit of the worker's environment."""
    sheet: bool = False
    """True to draw a whole report, not a card alone."""
    cache: str = ""
    """The folder for results that scenes have in common; empty for none."""


def make_scene(job: Job) -> Row:
    """Make the scene, write its files, and return its row, with the error if anything fails."""
    start_s, row = perf_counter(), row_of(job, "ok")
    try:
        with limited_threads(job.threads), naming_scene(job.id):
            row |= _make(job)
    except Exception as error:
        if _disk_is_full(error):
            row[FULL] = str(error)
        if not isinstance(error, TangibleError):
            log.warning("%s: %s", job.id, error, exc_info=True)
        message = str(error) if isinstance(error, TangibleError) else f"{type(error).__name__}: {error}"
        row |= {"outcome": "failed", "error": shown(" ".join(message.split()), MOST_IN_ERROR)}
    row["seconds"] = round(perf_counter() - start_s, 4)
    return row


@contextmanager
def naming_scene(name: str) -> Generator[None]:
    """Begin each warning that is logged in this block with the name of the scene: many scenes log at once."""
    plain, token = logging.getLogRecordFactory(), _scene.set(name)

    def with_name(*arguments: Any, **options: Any) -> logging.LogRecord:
        record = plain(*arguments, **options)
        if record.levelno >= logging.WARNING and (scene := _scene.get()):
            record.msg, record.args = f"{scene}: {record.getMessage()}", ()
        return record

    logging.setLogRecordFactory(with_name)
    try:
        yield
    finally:
        logging.setLogRecordFactory(plain)
        _scene.reset(token)


_scene: ContextVar[str] = ContextVar("tangible_scene", default="")


def row_of(job: Job, outcome: str, error: str | None = None) -> Row:
    """Return the row of a scene without figures, as it is for one whose worker died."""
    return {"id": job.id, "key": job.key, "outcome": outcome, "error": error, "seconds": None, "folder": job.folder}


def _make(job: Job) -> Row:
    registry = default_registry()
    config = parse_config(job.text, Path(job.path), registry, job.sets)
    pipeline = Pipeline.from_config(config, registry, Cache(Path(job.cache)) if job.cache else None)
    folder = Path(job.folder)
    if job.sheet:
        run = pipeline.run(folder)
        files = [path.name for path in run.files]
        figures = run.figures
    else:
        files = [_write_product(pipeline, folder)]
        figures = _figures(pipeline)
    card = write_card(pipeline, folder)
    files += _export(pipeline, folder)
    return {
        "scene": pipeline.scene.name,
        "figures": _plain({**figures, **_size(pipeline)}),
        "stages": {each.product: round(each.seconds, 5) for each in pipeline.outcomes if each.outcome == "ran"},
        "notes": [note.text for each in pipeline.outcomes for note in each.notes if note.kind != "decision"],
        "files": [*files, card],
        "card": card,
    }


def _write_product(pipeline: Pipeline, folder: Path) -> str:
    """Make and save the wanted product; for a touch, which is compiled code, save the surface."""
    want = pipeline.config.want
    value = pipeline.make(want)
    name, record = (want, value) if isinstance(value, Record) else ("surface", pipeline.surface)
    write_record(folder / f"{name}.npz", record)
    return f"{name}.npz"


def _export(pipeline: Pipeline, folder: Path) -> list[str]:
    """Run the exporters of the pipeline file, and return their files. Raises: OutputError if one of them fails."""
    if not pipeline.config.export:
        return []
    done = pipeline.export(folder, force=True)
    if failed := [each for each in done.outcomes if each.outcome != "ran"]:
        raise OutputError("; ".join(f"export {each.product}: {each.why}" for each in failed))
    return [path.relative_to(folder).as_posix() for paths in done.files.values() for path in paths]


def _figures(pipeline: Pipeline) -> dict[str, Any]:
    truth = pipeline.scene.truth
    disparity = pipeline.make("disparity") if truth is not None else None
    return {} if truth is None or disparity is None else {"disparity": disparity_errors(disparity.disparity_px, truth)}


def _size(pipeline: Pipeline) -> dict[str, Any]:
    """Return the size and the number of segments of the surface that was made, if one was."""
    if pipeline.config.want not in ("surface", "touch"):
        return {}
    surface = pipeline.surface
    width_m, length_m = surface.extent_m
    size = {"width_mm": 1e3 * width_m, "length_mm": 1e3 * length_m, "height_mm": 1e3 * float(surface.height_m.max())}
    segments = 0 if surface.labels is None else int(surface.labels.max()) + 1
    return {"surface": {**{name: round(each, 3) for name, each in size.items()}, "segments": segments}}


def _plain(figures: Mapping[Any, Any]) -> dict[str, Any]:
    """Return figures for JSON: None for those that are not finite."""

    def plain(value: Any) -> Any:
        if isinstance(value, Mapping):
            return _plain(cast("Mapping[Any, Any]", value))
        return None if isinstance(value, float) and not math.isfinite(value) else value

    return {str(name): plain(value) for name, value in figures.items()}


def _disk_is_full(error: BaseException | None) -> bool:
    while error is not None:
        if isinstance(error, OSError) and error.errno in (errno.ENOSPC, getattr(errno, "EDQUOT", errno.ENOSPC)):
            return True
        error = error.__cause__ or error.__context__
    return False
