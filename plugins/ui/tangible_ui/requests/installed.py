"""Requests about what is installed: networks, fetched in a process that no edit of the document ends, and panels."""

import asyncio
import json
from asyncio.subprocess import PIPE
from pathlib import Path
from typing import Any

from tangible_core.errors import ConfigError
from tangible_core.runtime import command

from ..state.session import Session
from ..state.tabs import Tab
from .table import request

FETCHING = "tangible_networks.fetching"


@request()
async def add_networks(session: Session, tab: Tab | None, names: list[str], batch: str = "") -> None:
    """Fetch networks, or make one from the file of a batch, and send all tabs the progress. Raises: ConfigError."""
    if session.fetch is not None:
        raise ConfigError("networks are being fetched already; wait for them, or stop them")
    source = str(session.uploads.single(batch)) if batch else None
    start = asyncio.create_subprocess_exec(*command(FETCHING), stdin=PIPE, stdout=PIPE)
    session.fetch = asyncio.ensure_future(start)
    session.tabs.tell("fetching", name=", ".join(names), done=0, whole=0, why="")
    session.begin(_fetch(session, session.fetch, json.dumps([names, source]), batch))


@request()
async def stop_networks(session: Session, tab: Tab | None) -> None:
    """Stop fetching networks; those that are complete stay."""
    if session.fetch is not None and (pipe := (await session.fetch).stdin) is not None:
        pipe.close()


async def _fetch(session: Session, start: "asyncio.Future[asyncio.subprocess.Process]", order: str, batch: str) -> None:
    """Send all tabs what the process reports, until it ends; it stops if this is cancelled."""
    why = ""
    try:
        process = await start
        assert process.stdin is not None and process.stdout is not None
        process.stdin.write(f"{order}\n".encode())
        async for line in process.stdout:
            progress = json.loads(line)
            why = progress["why"]
            if progress["name"]:
                session.tabs.tell("fetching", **progress)
        if (code := await process.wait()) and not why:
            why = f"the process that fetches networks ended by itself ({code}); try again"
        process.stdin.close()
    finally:
        session.fetch = None
        if batch:
            session.uploads.drop(batch)
        session.tabs.tell("fetching", name="", done=0, whole=0, why=why)


@request()
async def panels(session: Session, tab: Tab | None) -> list[dict[str, Any]]:
    """List the panels of plugins: name, titles by language, address of the ES module, task."""
    all_panels = await session.worker.quick("panels")
    modules = {panel["name"]: Path(panel["module"]) for panel in all_panels}
    session.panel_folders = {name: module.parent for name, module in modules.items()}
    return [{**panel, "module": f"/panels/{panel['name']}/{modules[panel['name']].name}"} for panel in all_panels]
