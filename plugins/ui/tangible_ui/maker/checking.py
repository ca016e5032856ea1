"""Jobs that say what a text means and make nothing."""

from pathlib import Path
from typing import Any

from tangible_core.errors import ConfigError
from tangible_core.pipeline.config import parse_config
from tangible_core.pipeline.schema import json_schema
from tangible_core.pipeline.starter import are_pictures, starter

from .bench import Bench, Job


def check(bench: Bench, text: str, path: Path, sets: list[str]) -> dict[str, Any]:
    """What a pipeline file says, every default filled in, or what is wrong with it."""
    try:
        config = parse_config(text, path, bench.registry, sets)
        return {"text": text, "path": str(path), "values": config.completed(), "complaints": []}
    except ConfigError as error:
        return {"text": text, "path": str(path), "values": None, "complaints": str(error).splitlines()}


def begin(bench: Bench, files: list[Path]) -> dict[str, Any]:
    """The text of a pipeline file, or of a new one for pictures, and where it stands."""
    if are_pictures(files):
        path = Path.cwd() / f"{files[0].stem}.yaml"
        return {"text": starter(files, path).text, "path": path}
    from tangible_core.files.source import read_text

    return {"text": read_text(files[0]), "path": files[0].absolute()}


def schema(bench: Bench) -> dict[str, Any]:
    """The JSON Schema of all methods that are installed."""
    return json_schema(bench.registry, None)


JOBS = {"check": Job(check, quick=True), "begin": Job(begin, quick=True), "schema": Job(schema, quick=True)}
