"""Jobs about what is installed: devices, networks, and panels that plugins bring; none opens a device."""

from dataclasses import asdict
from pathlib import Path
from typing import Any

from tangible_core.errors import ConfigError, did_you_mean, quoted
from tangible_core.pipeline.config import parse_config
from tangible_devices.installed import examine_device, installed_devices
from tangible_networks.card import forget_digests
from tangible_networks.fetching import remove_network
from tangible_networks.store import chosen_networks, known_networks, models_folder

from ...page_panel import installed_panels
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


@job(page=True)
def networks(state: WorkerState, check: bool = False) -> dict[str, Any]:
    """List the networks that have a card, and their folder. check: read all files again."""
    if check:
        forget_digests()
    return {"folder": str(models_folder()), "networks": [network.as_data() for network in known_networks().values()]}


@job(page=True)
def remove_networks(state: WorkerState, names: list[str]) -> None:
    """Delete the files of networks. Raises: ConfigError for an unknown name."""
    for network in chosen_networks(names):
        remove_network(network)


@job(quick=True)
def panels(state: WorkerState) -> list[dict[str, Any]]:
    """List the panels of plugins, which the server does not import: name, titles by language, ES module, task."""
    return [
        {"name": name, "title": dict(panel.title), "module": str(panel.module.resolve()), "task": panel.task}
        for name, panel in installed_panels().items()
    ]


@job(page=True)
def ask_panel(
    state: WorkerState,
    text: str,
    path: Path,
    sets: list[str],
    panel: str,
    request: str,
    arguments: dict[str, Any] | None = None,
) -> Any:
    """Have a plugin answer a request of its panel. Raises: ConfigError if there is none; whatever the plugin raises."""
    page_panel = installed_panels().get(panel)
    if page_panel is None:
        raise ConfigError(f"{quoted(panel)} is not a panel of a plugin{did_you_mean(panel, installed_panels())}")
    if request not in page_panel.requests:
        hint = did_you_mean(request, page_panel.requests)
        raise ConfigError(f"the panel {panel} answers no request {quoted(request)}{hint}")
    return page_panel.requests[request](state.make_pipeline(text, path, sets), **(arguments or {}))
