"""Jobs of the mapping: what the document's device reaches, and a text in which the picture lies otherwise under it."""

from pathlib import Path
from typing import Any

from tangible_core.mapping import WorkspaceMapping
from tangible_core.pipeline.config import parse_config
from tangible_core.pipeline.editing import REMOVE, Changes, edited

from .bench import Bench, Job

PLACED = ("scale", "region_m", "rotation_deg", "offset_m")
"""What a frame on the picture says of a mapping; the rest of it stays as it is."""


def reach(bench: Bench, text: str, path: Path, sets: list[str]) -> dict[str, Any]:
    """The device that the document names, and its workspace; none where it names none. Raises: ConfigError."""
    method = parse_config(text, path, bench.registry, sets).device
    if method is None:
        return {"device": "", "workspace_m": None}
    return {"device": method.name, "workspace_m": list(method.method.spec().workspace_m)}


def place(bench: Bench, text: str, path: Path, mapping: dict[str, Any]) -> str:
    """The text with another mapping: what is as by default is not written. Raises: ConfigError."""
    usual = WorkspaceMapping().model_dump(mode="json")
    said = {key: mapping[key] for key in PLACED if key in mapping}
    changes: Changes = {f"mapping.{key}": REMOVE if value == usual[key] else value for key, value in said.items()}
    return edited(text, path, changes)


JOBS = {"reach": Job(reach, quick=True), "place": Job(place, quick=True)}
