"""Jobs that write exported files into a folder that pages fetch from, and pack them."""

import json
import re
import secrets
import shutil
from contextlib import suppress
from dataclasses import asdict
from pathlib import Path
from time import perf_counter
from typing import Any
from zipfile import ZIP_DEFLATED, ZipFile

from tangible_core.errors import ConfigError
from tangible_core.pipeline.output.export_folder import read_list
from tangible_core.pipeline.output.exporting import Exported

from ..state import WorkerState
from .document import digest_of
from .making import stage_reporter
from .table import job

FOLDER = "export-"
NAMED = re.compile(rf"{FOLDER}[0-9a-f]{{16}}")
KEPT = 2
"""Folders that are kept: tabs may still fetch from the one before."""


@job()
def export(
    state: WorkerState, number: int, text: str, path: Path, sets: list[str], exports: list[Any]
) -> dict[str, Any]:
    """Run exporters into a folder that pages fetch from; return their outcomes.

    exports: as `export:` of a pipeline file has them. Raises: ConfigError for invalid ones; TangibleError as
    `Pipeline.export`.
    """
    begun_s = perf_counter()
    pipeline = state.pipeline_of(text, path, [*sets, f"export={json.dumps(exports)}"])
    at = state.folder / f"{FOLDER}{secrets.token_hex(8)}"
    try:
        with state.work(pipeline, number) as work:
            state.tell("making", want="export", digest=digest_of(text))
            _sweep(state.folder)
            done = pipeline.export(at, None, stage_reporter(state, work), work.stop)
        found = {
            "digest": digest_of(text),
            "folder": at.name,
            "exports": [_outcome_data(each) for each in done.exports],
        }
    except BaseException:
        shutil.rmtree(at, ignore_errors=True)
        raise
    state.tell("exported", **found)
    state.tell("made", want="export", digest=digest_of(text), outcome="made", why="", seconds=perf_counter() - begun_s)
    return found


@job(quick=True)
def export_zip(state: WorkerState, folder: str) -> str:
    """Pack the exported files of a folder into one, and return its name. Raises: ConfigError if they are gone."""
    at = state.folder / folder
    names = sorted(read_list(at)) if NAMED.fullmatch(folder) else []
    if not names:
        raise ConfigError("these files are not there any more; export them again")
    whole = at / f"{min(names, key=len).partition('.')[0]}.zip"
    if not whole.exists():
        part = at / f".{secrets.token_hex(8)}"
        try:
            with ZipFile(part, "w", ZIP_DEFLATED) as packed:
                for name in names:
                    packed.write(at / name, name)
            part.replace(whole)
        finally:
            part.unlink(missing_ok=True)
    return whole.name


def _outcome_data(each: Exported) -> dict[str, Any]:
    said = asdict(each.outcome)
    return {
        "name": each.name,
        **{key: said[key] for key in ("outcome", "why", "seconds", "notes")},
        "method": each.outcome.method,
        "files": [{"name": file.name, "bytes": file.stat().st_size} for file in each.files],
        "legible": None if each.legible is None else each.legible.as_data(),
    }


def _sweep(folder: Path) -> None:
    """Remove folders of files that were exported long ago, also by a killed process."""
    found: list[tuple[int, Path]] = []
    for each in folder.glob(f"{FOLDER}*"):
        with suppress(OSError):  # another thread swept it
            found.append((each.stat().st_mtime_ns, each))
    for _, each in sorted(found)[: -KEPT + 1]:
        shutil.rmtree(each, ignore_errors=True)
