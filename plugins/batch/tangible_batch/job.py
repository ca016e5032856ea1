"""The job of one scene of a batch. Every failure becomes a row; the job does not depend on the process that runs it."""

import errno
import io
import logging
import math
from collections.abc import Generator, Mapping
from contextlib import contextmanager
from contextvars import ContextVar
from dataclasses import dataclass
from pathlib import Path
from time import perf_counter
from typing import Any, cast

import numpy as np
from jaxtyping import UInt8

from tangible_core.data import Record, to_rgb8
from tangible_core.errors import OutputError, TangibleError, shown
from tangible_core.files import atomic_write
from tangible_core.metrics import disparity_errors
from tangible_core.pipeline import Pipeline
from tangible_core.pipeline.config import parse_config
from tangible_core.pipeline.engine import Cache, write_record
from tangible_core.plugins.registry import default_registry
from tangible_core.runtime import cv2, limited_threads, plain_opencv

log = logging.getLogger(__name__)
Row = dict[str, Any]
"""The result of a scene as JSON: `id`, `key`, `outcome` (ok or failed), `error`, `seconds`, `figures`, `stages`
(seconds of each that ran), `notes`, `files`."""
FULL = "full"  # the key of an error that is not a scene's fault: the disk is full
MAX_IN_ERROR = 500  # the most characters of an error message in a row


@dataclass(frozen=True)
class Job:
    """The description of a scene's job, in plain values."""

    id: str
    key: str  # the hash of all that the scene's result depends on, as far as it is known beforehand
    text: str
    path: str  # the path of the pipeline file: for relative files in it, and for error messages
    sets: tuple[str, ...]
    folder: str
    threads: int | None = None  # the number of threads; None for the limit of the worker's environment
    sheet: bool = False  # true to draw a whole report, not a card alone
    cache: str = ""  # the folder for results that scenes have in common; empty for none


def make_scene(job: Job) -> Row:
    """Make the scene, write its files, and return its row, with the error if anything fails."""
    start_s, row = perf_counter(), empty_row(job, "ok")
    try:
        with limited_threads(job.threads), naming_scene(job.id):
            row |= _make(job)
    except Exception as error:
        if _disk_is_full(error):
            row[FULL] = str(error)
        if not isinstance(error, TangibleError):
            log.warning("%s: %s", job.id, error, exc_info=True)
        message = str(error) if isinstance(error, TangibleError) else f"{type(error).__name__}: {error}"
        row |= {"outcome": "failed", "error": shown(" ".join(message.split()), MAX_IN_ERROR)}
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


def empty_row(job: Job, outcome: str, error: str | None = None) -> Row:
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
        "stages": {
            outcome.product: round(outcome.seconds, 5) for outcome in pipeline.outcomes if outcome.outcome == "ran"
        },
        "notes": [note.text for outcome in pipeline.outcomes for note in outcome.notes if note.kind != "decision"],
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
    exports = pipeline.export(folder, force=True)
    if failures := [outcome for outcome in exports.outcomes if outcome.outcome != "ran"]:
        raise OutputError("; ".join(f"export {outcome.product}: {outcome.why}" for outcome in failures))
    return [path.relative_to(folder).as_posix() for paths in exports.files.values() for path in paths]


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
    return {"surface": {**{name: round(length, 3) for name, length in size.items()}, "segments": segments}}


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


CARD = "card.jpg"
SIDE_PX = 160
LIGHT = np.array([-1.0, 1.0, 1.2])  # the direction to the light: from the upper left, as on maps


def write_card(pipeline: Pipeline, folder: Path) -> str:
    """Write the picture and its product next to each other; return the name of the file. Raises: OutputError."""
    from PIL import Image

    parts = [_draw_product(pipeline)]
    if pipeline.scene.views is not None:
        parts.insert(0, _resize(to_rgb8(pipeline.scene.views.left)))
    height = max(part.shape[0] for part in parts)
    whole = np.full((height, sum(part.shape[1] for part in parts), 3), 255, np.uint8)
    at = 0
    for part in parts:
        whole[: part.shape[0], at : at + part.shape[1]] = part
        at += part.shape[1]
    jpeg = io.BytesIO()
    Image.fromarray(whole).save(jpeg, "JPEG", quality=80)
    with atomic_write(folder / CARD) as file:
        file.write(jpeg.getvalue())
    return CARD


def _draw_product(pipeline: Pipeline) -> UInt8[np.ndarray, "r c 3"]:
    """Draw the wanted product if it is a map of the picture, or else the relief."""
    want = pipeline.config.want
    if want in ("views", "disparity") and pipeline.disparity is not None:
        return _grey(pipeline.disparity.disparity_px)
    if want == "parts" and (parts := pipeline.make(want)) is not None:
        return _grey(parts.labels)
    if want in ("segments", "materials") and pipeline.segments is not None:
        return _grey(pipeline.segments.labels)
    return _shade(pipeline.relief.height_m, pipeline.relief.pitch_m)


def _grey(values: np.ndarray) -> UInt8[np.ndarray, "r c 3"]:
    """Draw values in grey, from black for the lowest (and for unknown) to white for the highest."""
    values = np.asarray(values, np.float32)
    valid_mask = np.isfinite(values)
    low, high = (float(values[valid_mask].min()), float(values[valid_mask].max())) if valid_mask.any() else (0.0, 0.0)
    share = np.where(valid_mask, (values - low) / max(high - low, 1e-9), 0).astype(np.float32)
    return np.repeat(np.rint(255 * np.clip(_resize(share), 0, 1)).astype(np.uint8)[..., None], 3, axis=2)


def _resize(picture: np.ndarray) -> np.ndarray:
    scale = SIDE_PX / max(picture.shape[:2])
    size = tuple(max(1, round(side * scale)) for side in picture.shape[1::-1])
    with plain_opencv():
        return cv2.resize(picture, (size[0], size[1]), interpolation=cv2.INTER_AREA if scale < 1 else cv2.INTER_LINEAR)


def _shade(height_m: np.ndarray, pitch_m: tuple[float, float]) -> UInt8[np.ndarray, "r c 3"]:
    """Shade heights as lit from the upper left."""
    small = _resize(np.asarray(height_m, np.float32))
    scale = height_m.shape[1] / small.shape[1]
    down, right = (
        np.gradient(small, axis=axis) / (pitch * scale) if small.shape[axis] > 1 else np.zeros_like(small)
        for axis, pitch in ((0, pitch_m[1]), (1, pitch_m[0]))
    )
    shade = (-right * LIGHT[0] + down * LIGHT[1] + LIGHT[2]) / np.sqrt(1 + right**2 + down**2) / np.linalg.norm(LIGHT)
    grey = np.rint(255 * np.clip(shade, 0, 1)).astype(np.uint8)
    return np.repeat(grey[..., None], 3, axis=2)
