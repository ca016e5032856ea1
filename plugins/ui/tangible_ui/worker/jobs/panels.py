"""Jobs of panels that plugins bring: list them, and answer their requests. The server imports no plugin for them."""

from pathlib import Path
from typing import Any

from tangible_core.errors import ConfigError, did_you_mean, quoted

from ...page_panel import installed_panels
from ..state import WorkerState
from .table import job


@job(quick=True)
def panels(state: WorkerState) -> list[dict[str, Any]]:
    """List the installed panels: name, titles by language, path of the ES module, task."""
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
