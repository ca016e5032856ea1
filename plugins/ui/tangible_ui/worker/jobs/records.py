"""Jobs on recordings: list, write out for pages, compare, and replay with another law."""

from pathlib import Path
from typing import Any

import numpy as np

from tangible_core.data import TICK_COLUMNS, digest_of
from tangible_core.errors import OutputError
from tangible_core.files import as_path
from tangible_core.pipeline import Feeling
from tangible_core.session import SUFFIXES, Recording, compare_recordings, compare_replay
from tangible_web.framing import FLAG_BITS

from ...user_data import RECORDINGS, user_folder
from ..state import WorkerState
from .table import job

# Maximum number of rows of a recording for pages, 8 MB; of a longer one every second tick, or third, is shown.
MAX_ROWS = 120_000
MAX_LISTED = 500
AT_FLAGS = TICK_COLUMNS.index("flags")


@job(page=True)
def records(state: WorkerState) -> list[dict[str, Any]]:
    """List the user's recordings, newest first; for an unreadable one, the reason."""
    try:
        files = sorted(
            (file for file in user_folder(RECORDINGS).iterdir() if file.suffix in SUFFIXES),
            key=_modification_time,
            reverse=True,
        )
    except OSError:
        return []
    return [_entry(path) for path in files[:MAX_LISTED]]


def _modification_time(path: Path) -> float:
    try:
        return path.stat().st_mtime
    except OSError:
        return 0.0


def _entry(path: Path) -> dict[str, Any]:
    try:
        recording = Recording.load(path)
    except OutputError as error:
        return {"name": path.name, "path": str(path), "trouble": str(error)}
    return {"name": path.name, "path": str(path), "trouble": "", **_about(recording)}


def _about(recording: Recording) -> dict[str, Any]:
    return {
        "law": recording.about.renderer,
        "device": recording.about.device,
        "started": recording.about.started,
        "stopped": recording.stopped,
        "figures": recording.figures(),
    }


@job(page=True)
def show_record(state: WorkerState, path: str) -> dict[str, Any]:
    """Write the ticks where pages fetch them. Raises: OutputError if the file is not a recording."""
    return _lay_out(state, Recording.load(as_path(path)), path)


def _lay_out(state: WorkerState, recording: Recording, path: str) -> dict[str, Any]:
    every = -(-len(recording.rows) // MAX_ROWS) or 1
    rows = recording.rows[::every].copy()
    start_s = float(recording.time_s[0]) if len(rows) else 0.0
    rows[:, AT_FLAGS] = recording.flags[::every] & FLAG_BITS
    rows[:, 0] -= start_s  # float32 cannot hold the time of a clock that has run for days
    digest = digest_of(recording.rows)
    at = state.folder / digest
    at.mkdir(exist_ok=True)
    (at / "ticks.f32").write_bytes(np.ascontiguousarray(rows, "<f4").tobytes())
    shape = {"rows": len(rows), "columns": len(TICK_COLUMNS), "every": every}
    return {"digest": digest, "path": path, "name": Path(path).name, **shape, **_about(recording)}


@job(page=True)
def compare_records(state: WorkerState, path: str, other: str) -> dict[str, Any]:
    """Compare two recordings place by place along their paths. Raises: OutputError if a file is not a recording."""
    return compare_recordings(Recording.load(as_path(path)), Recording.load(as_path(other)))


@job()
def try_law(state: WorkerState, text: str, path: Path, sets: list[str], record: Path) -> dict[str, Any]:
    """Replay a recording with the document's law, keep the result with the user's recordings, and compare both."""
    before = Recording.load(record)
    after = Feeling(state.make_pipeline(text, path, sets)).replay(before)
    out = _free(user_folder(RECORDINGS), f"{record.stem} with {after.about.renderer}")
    after.save(out)
    return {**_lay_out(state, after, str(out)), "compared": compare_replay(before, after)}


def _free(folder: Path, name: str) -> Path:
    names = (folder / f"{name}{f' {number}' if number else ''}.nc" for number in range(10_000))
    return next(path for path in names if not path.exists())
