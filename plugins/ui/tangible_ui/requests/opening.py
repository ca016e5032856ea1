"""Opening and saving: files of this machine, files that a page sends, examples, and the pipeline file on the screen."""

import asyncio
from pathlib import Path
from typing import Any

from tangible_core.errors import ConfigError
from tangible_core.files.paths import as_path

from ..state.session import Desk, Tab
from .document import begin, edit
from .making import make


async def folder(desk: Desk, tab: Tab | None, path: str = "") -> dict[str, Any]:
    """What lies in a folder of this machine that can be opened; of the current one, without a name."""
    return await desk.maker.quick("folder", path=as_path(path) if path else Path.cwd())


async def batch(desk: Desk, tab: Tab | None) -> str:
    """The name under which a page may send files."""
    return await asyncio.to_thread(desk.shelf.batch)


async def open_batch(desk: Desk, tab: Tab | None, batch: str) -> dict[str, Any]:
    """Open the files that a page has sent, together."""
    files = await asyncio.to_thread(desk.shelf.keep, batch)
    return await begin(desk, tab, [str(each) for each in files])


async def examples(desk: Desk, tab: Tab | None) -> list[str]:
    """Scenes that are built in."""
    return await desk.maker.quick("examples")


async def save(desk: Desk, tab: Tab | None, path: str, replace: bool = False) -> dict[str, Any]:
    """Write the document to a file of this machine, its relative paths leading to the same files from there.

    Raises: ConfigError if a file is there and is not to be replaced; OutputError if it cannot be written.
    """
    place = as_path(path)
    if not place.is_absolute():
        place = Path.cwd() / place
    if place.suffix not in (".yaml", ".yml"):
        place = place.with_name(f"{place.name}.yaml")
    if not replace and place.exists() and place != desk.path:
        raise ConfigError(f"{place}: is there already; choose another name, or replace it")
    await desk.maker.quick("save", text=desk.text, path=desk.path, out=place)
    return await begin(desk, tab, [str(place)], make_it=False)


async def exchange(desk: Desk, tab: Tab | None) -> None:
    """Left and right of the pair change places, in the document and under the hand."""
    await edit(desk, tab, await desk.maker.quick("exchange", text=desk.text, path=desk.path))
    desk.begin(make(desk, tab))


ASKS = {
    "folder": folder,
    "batch": batch,
    "open_batch": open_batch,
    "examples": examples,
    "save": save,
    "exchange": exchange,
}
