"""Jobs that say what a text means and make nothing."""

from pathlib import Path
from typing import Any

from tangible_core.errors import ConfigError
from tangible_core.pipeline.config import parse_config
from tangible_core.pipeline.schema import json_schema

from .bench import Bench, Job


def check(bench: Bench, text: str, path: Path, sets: list[str]) -> dict[str, Any]:
    """What a pipeline file says, every default filled in, or what is wrong with it."""
    try:
        config = parse_config(text, path, bench.registry, sets)
        return {"text": text, "path": str(path), "values": config.completed(), "complaints": []}
    except ConfigError as error:
        return {"text": text, "path": str(path), "values": None, "complaints": str(error).splitlines()}


def schema(bench: Bench) -> dict[str, Any]:
    """The JSON Schema of all methods that are installed."""
    return json_schema(bench.registry, None)


JOBS = {"check": Job(check, quick=True), "schema": Job(schema, quick=True)}
