"""Requests of panels that plugins bring."""

from pathlib import Path
from typing import Any

from ..state.session import Session
from ..state.tabs import Tab
from .table import request


@request()
async def panels(session: Session, tab: Tab | None) -> list[dict[str, Any]]:
    """List the panels of plugins: name, titles by language, address of the ES module, task."""
    all_panels = await session.worker.quick("panels")
    modules = {panel["name"]: Path(panel["module"]) for panel in all_panels}
    session.panel_folders = {name: module.parent for name, module in modules.items()}
    return [{**panel, "module": f"/panels/{panel['name']}/{modules[panel['name']].name}"} for panel in all_panels]
