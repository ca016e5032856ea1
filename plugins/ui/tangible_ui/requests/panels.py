"""Requests of panels that plugins bring."""

from pathlib import Path
from typing import Any

from ..state.session import Session
from ..state.tabs import Tab
from .table import request


@request()
async def panels(session: Session, tab: Tab | None) -> list[dict[str, Any]]:
    """List the panels of plugins: name, titles by language, address of the ES module, task."""
    found = await session.worker.quick("panels")
    modules = {each["name"]: Path(each["module"]) for each in found}
    session.panel_folders = {name: module.parent for name, module in modules.items()}
    return [{**each, "module": f"/panels/{each['name']}/{modules[each['name']].name}"} for each in found]
