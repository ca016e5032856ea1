"""Jobs about devices; none opens a device."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

from tangible_core.pipeline.config import parse_config
from tangible_devices.installed import examine_device, installed_devices

from ..state import WorkerState
from .table import job


@job(page=True)
def devices(state: WorkerState) -> list[dict[str, Any]]:
    """List the installed devices: facts, connected units, and why one cannot be used."""
    return [{**asdict(device), "usable": device.usable} for device in installed_devices(state.registry)]


@job(page=True)
def examine(state: WorkerState, name: str) -> list[dict[str, Any]]:
    """Return what keeps a device from working, and the cure."""
    return [asdict(finding) for finding in examine_device(state.registry, name)]


@job(quick=True)
def about_device(state: WorkerState, text: str, path: Path, sets: list[str]) -> dict[str, Any]:
    """Describe the document's device: motor, greatest force, relief. Raises: ConfigError, also without a device."""
    config = parse_config(text, path, state.registry, sets)
    if config.device is None or config.felt_device is None:
        raise config.missing("device")
    spec, limit_n = config.device.method.spec(), config.safety.max_force_n
    return {
        "name": config.device.name,
        "simulated": spec.simulated,
        "most_force_n": min(spec.max_force_n, limit_n or spec.max_force_n),
        "relief_m": config.size.relief_m,
    }


@job(page=True)
def reach(state: WorkerState, text: str, path: Path, sets: list[str]) -> dict[str, Any]:
    """Return the document's device and its workspace; None without a device. Raises: ConfigError."""
    device = parse_config(text, path, state.registry, sets).device
    if device is None:
        return {"device": "", "workspace_m": None}
    return {"device": device.name, "workspace_m": list(device.method.spec().workspace_m)}
