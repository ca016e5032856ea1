"""Jobs that write exported files into a folder that pages fetch from, and pack them."""

import re
import secrets
import shutil
from dataclasses import asdict
from pathlib import Path
from typing import Any
from zipfile import ZIP_DEFLATED, ZipFile

from tangible_core.data import digest_of
from tangible_core.errors import ConfigError
from tangible_core.files.yaml import json_in_yaml
from tangible_core.pipeline.output import Exported, ExportEngines, read_list, work_for
from tangible_core.plugins import Previewing, silently

from ..state import WorkerState
from ..view.files import leave, sweep, write_whole
from .document import text_digest
from .making import announce, plan_data
from .table import job

FOLDER = "export-"
PREVIEW = "preview-"
KEPT_PREVIEWS = 16  # pictures of files that are kept: pages may still show them
NAMED = re.compile(rf"{FOLDER}[0-9a-f]{{16}}")
KEPT = 2  # folders that are kept: tabs may still fetch from the one before


@job()
def export(
    state: WorkerState, number: int, text: str, path: Path, sets: list[str], exports: list[Any], language: str = "en"
) -> dict[str, Any]:
    """Run exporters into a folder that pages fetch from; return their outcomes. Raises: as `Pipeline.export`."""
    pipeline = state.make_pipeline(text, path, [*sets, f"export={json_in_yaml(exports)}"], language)
    at = state.folder / f"{FOLDER}{secrets.token_hex(8)}"
    try:
        with announce(state, number, pipeline, text, "export") as (work, report):
            sweep(state.folder, f"{FOLDER}*", KEPT - 1)
            outcomes = [_outcome_data(exported) for exported in pipeline.export(at, None, report, work.stop).exports]
            message = {"digest": text_digest(text), "folder": at.name, "exports": outcomes}
            state.tell("exported", **message)
    except BaseException:
        shutil.rmtree(at, ignore_errors=True)
        raise
    return message


@job(page=True)
def export_preview(
    state: WorkerState, text: str, path: Path, sets: list[str], block: dict[str, Any] | str, language: str = "en"
) -> dict[str, Any]:
    """Draw what an exporter would write, into a file; no file without a picture, or where something slow `waits`."""
    pipeline = state.make_pipeline(text, path, [*sets, f"export={json_in_yaml([block])}"], language)
    (exporter,) = pipeline.config.export
    none = {"file": "", "waits": False, "columns": 0, "rows": 0, "width_m": 0.0}
    if not isinstance(exporter.method, Previewing):
        return none
    if any(plan_data(pipeline, text, product)["slow"] for product in exporter.method.needs):
        return {**none, "waits": True}
    engine = ExportEngines(pipeline.engine, [exporter]).engine_for(exporter)
    with silently():
        picture = exporter.method.preview(work_for(engine, exporter.method))
    at = f"{PREVIEW}{digest_of((picture,))}"
    leave(state.folder / at, "the preview", lambda part: write_whole(picture, part / "picture.png"))
    sweep(state.folder, f"{PREVIEW}*", KEPT_PREVIEWS)
    rows, columns = picture.shape
    width_m = engine.config.size.width_m
    return {"file": f"{at}/picture.png", "waits": False, "columns": columns, "rows": rows, "width_m": width_m}


@job(page=True)
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
            with ZipFile(part, "w", ZIP_DEFLATED) as archive:
                for name in names:
                    archive.write(at / name, name)
            part.replace(whole)
        finally:
            part.unlink(missing_ok=True)
    return whole.name


def _outcome_data(exported: Exported) -> dict[str, Any]:
    figures = asdict(exported.outcome)
    return {
        "name": exported.name,
        **{key: figures[key] for key in ("outcome", "why", "seconds", "notes")},
        "method": exported.outcome.method,
        "files": [{"name": file.name, "bytes": file.stat().st_size} for file in exported.files],
        "legible": None if exported.legible is None else exported.legible.as_data(),
    }
