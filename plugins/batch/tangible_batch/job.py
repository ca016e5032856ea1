"""One scene of a batch, made: whatever goes wrong is a row. It knows nothing of who runs it."""

import errno
import logging
import math
from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any, cast

from tangible_core.data import Outcome, Record
from tangible_core.errors import OutputError, TangibleError, shown
from tangible_core.metrics import disparity_errors
from tangible_core.pipeline.config.parsing import parse_config
from tangible_core.pipeline.engine.cache import Cache, write_record
from tangible_core.pipeline.pipeline import Pipeline
from tangible_core.plugins.registry import default_registry
from tangible_core.runtime.threads import limited_threads

from .card import write_card

log = logging.getLogger(__name__)
Row = dict[str, Any]
"""What became of a scene, as JSON says it: `id`, `key`, `outcome` (ok or failed), `error`, `seconds`, `figures`,
`stages` (seconds of each that ran), `notes`, `files`."""
FULL = "full"
"""Of a row that is none: the disk is full, which is no fault of the scene."""
MOST_IN_ERROR = 500


@dataclass(frozen=True)
class Job:
    """Everything that a worker needs to know: plain values."""

    id: str
    key: str
    """What the scene's result depends on, as far as that is known beforehand."""
    text: str
    """The pipeline file."""
    path: str
    """Where it stands: what relative files in it are relative to, and what complaints name."""
    sets: tuple[str, ...]
    folder: str
    """For the files of this scene."""
    threads: int | None = None
    """None: as the worker's own environment limits them."""
    sheet: bool = False
    """Whether a whole report is drawn, not a card alone."""
    cache: str = ""
    """Folder for results that scenes have in common; empty for none."""


def make_scene(job: Job) -> Row:
    """Make the scene, and write what was wanted of it. Never raises but for what ends the process."""
    begun, row = perf_counter(), _named(job, "ok", None)
    try:
        with limited_threads(job.threads):
            row |= _made(job)
    except Exception as error:
        if _disk_is_full(error):
            row[FULL] = str(error)
        if not isinstance(error, TangibleError):
            log.warning("%s: %s", job.id, error, exc_info=True)
        said = str(error) if isinstance(error, TangibleError) else f"{type(error).__name__}: {error}"
        row |= {"outcome": "failed", "error": shown(" ".join(said.split()), MOST_IN_ERROR)}
    row["seconds"] = round(perf_counter() - begun, 4)
    return row


def dead_row(job: Job, death: str) -> Row:
    """The row of a scene whose worker could not say anything any more."""
    return _named(job, "failed", death)


def _named(job: Job, outcome: str, error: str | None) -> Row:
    return {"id": job.id, "key": job.key, "outcome": outcome, "error": error, "seconds": None, "folder": job.folder}


def _made(job: Job) -> Row:
    registry = default_registry()
    config = parse_config(job.text, Path(job.path), registry, job.sets)
    pipeline = Pipeline.of(config, registry, Cache(Path(job.cache)) if job.cache else None)
    folder = Path(job.folder)
    if job.sheet:
        run = pipeline.run(folder)
        files = [path.name for path in run.files]
        figures = run.figures
    else:
        files = _written(pipeline, folder)
        figures = _figures(pipeline)
    card = write_card(pipeline, folder)
    files += _exported(pipeline, folder)
    return {
        "scene": pipeline.scene.name,
        "figures": _plain(figures),
        "stages": {each.product: round(each.seconds, 5) for each in pipeline.outcomes if each.outcome == "ran"},
        "notes": [note.text for each in pipeline.outcomes for note in _told(each)],
        "files": [*files, card],
        "card": card,
    }


def _written(pipeline: Pipeline, folder: Path) -> list[str]:
    """What is wanted, made and kept; of a touch, which is compiled code, the surface."""
    want = pipeline.config.want
    value = pipeline.make(want)
    name, record = (want, value) if isinstance(value, Record) else ("surface", pipeline.surface)
    write_record(folder / f"{name}.npz", record)
    return [f"{name}.npz"]


def _exported(pipeline: Pipeline, folder: Path) -> list[str]:
    """Files of the exporters that the pipeline file lists. Raises: OutputError for one that could not write its own."""
    if not pipeline.config.export:
        return []
    done = pipeline.export(folder, force=True)
    if failed := [each for each in done.outcomes if each.outcome != "ran"]:
        raise OutputError("; ".join(f"export {each.product}: {each.why}" for each in failed))
    return [path.relative_to(folder).as_posix() for paths in done.files.values() for path in paths]


def _figures(pipeline: Pipeline) -> dict[str, Any]:
    truth = pipeline.scene.truth
    found = pipeline.make("disparity") if truth is not None else None
    return {} if truth is None or found is None else {"disparity": disparity_errors(found.disparity_px, truth)}


def _told(outcome: Outcome) -> list[Any]:
    return [each for each in outcome.notes if each.kind != "decision"]


def _plain(figures: Mapping[Any, Any]) -> dict[str, Any]:
    """As JSON says it: what is not finite is nothing."""

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
