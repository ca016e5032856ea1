"""Requests about the document: open it, edit it, save it, restore a draft."""

import asyncio
from pathlib import Path
from typing import Any

from tangible_core.errors import ConfigError
from tangible_core.files.paths import as_path

from ..state.session import Desk, Tab
from ..state.texts import Text
from .making import foresee, make
from .table import request


@request()
async def begin(desk: Desk, tab: Tab | None, files: list[str], make_it: bool = True) -> dict[str, Any]:
    """Open a pipeline file, pictures or a recording; what can be felt is made and felt.

    Returns: where a recording lies, if it is one: it is for whoever shows recordings.
    """
    found = await desk.maker.quick("begin", files=[Path(each) for each in files])
    if "text" not in found:
        return found
    text, path = found["text"], found["path"]
    if desk.sets:  # of the command line: the text says them from now on
        text, desk.sets = await desk.maker.quick("overridden", text=text, path=path, sets=desk.sets), []
    desk.drafts.opened(text)
    async with desk.texts.lock:
        said = await take(desk, Text(text, path))
    if make_it and not said["complaints"]:
        desk.begin(make(desk, tab))
    return {}


@request()
async def edit(desk: Desk, tab: Tab | None, text: str, of: str = "", apply: bool = False) -> dict[str, Any]:
    """Take another text for the document; all tabs hear what it says, or what is wrong with it.

    of: digest of the text that was edited; if another took its place meanwhile, it is refused. apply: make and feel it
    if nothing slow has to run. Raises: ConfigError.
    """
    async with desk.texts.lock:
        if of and of != desk.digest:
            raise ConfigError("the document was changed elsewhere meanwhile; look at what it says now")
        return _then(desk, await take(desk, Text(text, desk.path)), apply)


@request("set")
async def change(
    desk: Desk,
    tab: Tab | None,
    changes: dict[str, Any] | None = None,
    written: dict[str, str] | None = None,
    removed: list[str] | None = None,
    apply: bool = False,
) -> dict[str, Any]:
    """Change keys of the document, and nothing else in it: values, values written in YAML, keys to go.

    Raises: ConfigError.
    """
    async with desk.texts.lock:
        told = {"changes": changes or {}, "written": written or {}, "removed": removed or []}
        found = await desk.maker.quick("change", text=desk.text, path=desk.path, sets=desk.sets, **told)
        return _then(desk, _put(desk, Text(found["text"], desk.path), found), apply)


@request()
async def undo(desk: Desk, tab: Tab | None, apply: bool = False) -> dict[str, Any] | None:
    """The document as it was one step before."""
    return await _step(desk, back=True, apply=apply)


@request()
async def redo(desk: Desk, tab: Tab | None, apply: bool = False) -> dict[str, Any] | None:
    """What was undone last."""
    return await _step(desk, back=False, apply=apply)


@request()
async def schema(desk: Desk, tab: Tab | None) -> dict[str, Any]:
    """What forms are made of."""
    return await desk.maker.quick("schema")


@request()
async def library(desk: Desk, tab: Tab | None) -> list[dict[str, Any]]:
    """The materials that the document can name."""
    return await desk.maker.quick("library", text=desk.text, path=desk.path, sets=desk.sets)


async def take(desk: Desk, text: Text) -> dict[str, Any]:
    """Another text and place of the document, which all tabs hear of; under the lock of `desk.texts`."""
    return _put(desk, text, await _checked(desk, text))


async def _step(desk: Desk, *, back: bool, apply: bool) -> dict[str, Any] | None:
    async with desk.texts.lock:
        text = desk.texts.before() if back else desk.texts.after()
        if text is None:
            return None
        found = await _checked(desk, text)
        desk.texts.step(Text(desk.text, desk.path), back=back)
        return _then(desk, _told(desk, text, found), apply)


async def _checked(desk: Desk, text: Text) -> dict[str, Any]:
    return await desk.maker.quick("check", text=text.text, path=text.path, sets=desk.sets)


def _put(desk: Desk, text: Text, found: dict[str, Any]) -> dict[str, Any]:
    """The document's text from now on, if it is another."""
    now = Text(desk.text, desk.path)
    if text != now:
        desk.texts.leave(now)
    return _told(desk, text, found)


def _told(desk: Desk, text: Text, found: dict[str, Any]) -> dict[str, Any]:
    desk.text, desk.path = text
    desk.digest = found["digest"]
    desk.begin(desk.drafts.keep(text))
    found |= {"can_undo": desk.texts.can_undo, "can_redo": desk.texts.can_redo}
    desk.tell("document", **found)
    return found


def _then(desk: Desk, found: dict[str, Any], apply: bool) -> dict[str, Any]:
    if not found["complaints"]:
        desk.begin(foresee(desk, apply))
    return found


@request()
async def folder(desk: Desk, tab: Tab | None, path: str = "") -> dict[str, Any]:
    """What lies in a folder of this machine that can be opened; of the current one, without a name."""
    return await desk.maker.quick("folder", path=as_path(path) if path else Path.cwd())


@request()
async def batch(desk: Desk, tab: Tab | None) -> str:
    """The name under which a page may send files."""
    return await asyncio.to_thread(desk.shelf.batch)


@request()
async def open_batch(desk: Desk, tab: Tab | None, batch: str) -> dict[str, Any]:
    """Open the files that a page has sent, together."""
    files = await asyncio.to_thread(desk.shelf.keep, batch)
    return await begin(desk, tab, [str(each) for each in files])


@request()
async def examples(desk: Desk, tab: Tab | None) -> list[str]:
    """Scenes that are built in."""
    return await desk.maker.quick("examples")


@request()
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


@request()
async def exchange(desk: Desk, tab: Tab | None) -> None:
    """Left and right of the pair change places, in the document and under the hand."""
    await edit(desk, tab, await desk.maker.quick("exchange", text=desk.text, path=desk.path))
    desk.begin(make(desk, tab))


async def offer(desk: Desk) -> None:
    """Tell pages of what a program before this one left, if it left something."""
    if (draft := await asyncio.to_thread(desk.drafts.look)) is not None:
        desk.tell("restored", path=str(draft.text.path), edited_s=draft.at_s)


@request()
async def restore(desk: Desk, tab: Tab | None) -> None:
    """What was left is the document from now on, a step after that of before. Raises: ConfigError if there is none."""
    draft = desk.drafts.left
    if draft is None:
        raise ConfigError("there is nothing that was not saved")
    async with desk.texts.lock:
        said = await take(desk, draft.text)
    await forget(desk, tab)
    if not said["complaints"]:
        desk.begin(make(desk, tab))


@request("forget_draft")
async def forget(desk: Desk, tab: Tab | None) -> None:
    """What was left is not offered again."""
    await asyncio.to_thread(desk.drafts.drop)
    desk.tell("restored", path="", edited_s=0.0)
