"""The job of the mapping: what the document's device reaches."""

from pathlib import Path
from typing import Any

from tangible_core.pipeline.config.config import parse_config

from ..state import Bench, Job


def reach(bench: Bench, text: str, path: Path, sets: list[str]) -> dict[str, Any]:
    """The device that the document names, and its workspace; none where it names none. Raises: ConfigError."""
    device = parse_config(text, path, bench.registry, sets).device
    if device is None:
        return {"device": "", "workspace_m": None}
    return {"device": device.name, "workspace_m": list(device.method.spec().workspace_m)}


JOBS = {"reach": Job(reach, quick=True)}
