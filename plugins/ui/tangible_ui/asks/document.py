"""The document: open, edit, make, stop making."""

from pathlib import Path
from typing import Any

from ..desk import Desk, Tab

PRODUCTS = ("disparity", "relief", "segments", "materials", "surface", "touch")


async def begin(desk: Desk, tab: Tab | None, files: list[str], make_it: bool = True) -> dict[str, Any]:
    """Open a pipeline file, pictures or a recording; what can be felt is made and felt.

    Returns: where a recording lies, if it is one: it is for whoever shows recordings.
    """
    found = await desk.maker.ask("begin", files=[Path(each) for each in files])
    if "text" not in found:
        return found
    desk.path = found["path"]
    await edit(desk, tab, found["text"])
    if make_it:
        desk.begin(make(desk, tab))
    return {}


async def edit(desk: Desk, tab: Tab | None, text: str) -> dict[str, Any]:
    """Take another text for the document; all tabs hear what it says, or what is wrong with it."""
    desk.text = text
    found = await desk.maker.ask("check", text=text, path=desk.path, sets=desk.sets)
    desk.tell("document", **found)
    return found


async def make(desk: Desk, tab: Tab | None, want: str = "touch") -> None:
    """Make a product of the document, and feel it if it is a touch."""
    made = await desk.maker.ask("make", text=desk.text, path=desk.path, sets=desk.felt_sets(), want=want)
    if made is not None:
        await desk.feel(made)


async def stop_making(desk: Desk, tab: Tab | None) -> None:
    """End what is being made; what is felt goes on."""
    desk.maker.kill()


async def schema(desk: Desk, tab: Tab | None) -> dict[str, Any]:
    """What forms are made of."""
    return await desk.maker.ask("schema")


ASKS = {"begin": begin, "edit": edit, "make": make, "stop_making": stop_making, "schema": schema}
