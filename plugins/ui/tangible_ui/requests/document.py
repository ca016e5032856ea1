"""Requests about the document: open it, edit it, save it, restore a draft."""

import asyncio
import logging
from pathlib import Path
from typing import Any

from tangible_core.errors import ConfigError
from tangible_core.files import as_path

from ..state.document import Text
from ..state.session import Session
from ..state.tabs import Tab
from .making import foresee, make
from .table import request

log: logging.Logger = logging.getLogger(__name__)
# Endings of pictures that a page shows by itself, before anything was computed.
SHOWN_BY_BROWSERS = frozenset({".png", ".jpg", ".jpeg", ".webp", ".gif", ".bmp", ".svg"})


@request()
async def begin(session: Session, tab: Tab | None, files: list[str], make_it: bool = True) -> dict[str, Any]:
    """Open a pipeline file or pictures, and make what can be felt; or return the path of a recording, for its panel."""
    picture = as_path(files[0]) if files else Path()
    session.opening = picture if picture.suffix.lower() in SHOWN_BY_BROWSERS else None
    session.tabs.tell("opening", name=picture.name, picture=session.opening is not None)
    opening: dict[str, Any] = {}
    try:
        opening = await session.worker.quick("begin", files=[as_path(file) for file in files])
    finally:
        if "text" not in opening:
            session.tabs.tell("opening", name="", picture=False)
    if "text" not in opening:
        return opening
    text, path = opening["text"], opening["path"]
    if session.document.sets:  # changes of the command line become part of the text
        text = await session.worker.quick("overridden", text=text, path=path, sets=session.document.sets)
        session.document.sets = []
    session.document.drafts.remember_opened(text)
    async with session.document.texts.lock:
        document = await take(session, Text(text, path))
    for complaint in document["complaints"]:  # at the terminal too: whoever started it there looks at it first
        place = ":".join(str(part) for part in (path, complaint["line"], complaint["column"]) if part is not None)
        log.warning("%s: %s", place, complaint["text"])
    if make_it and not document["complaints"]:
        session.begin(make(session, tab))
    return {}


@request()
async def edit(session: Session, tab: Tab | None, text: str, of: str = "", apply: bool = False) -> dict[str, Any]:
    """Replace the document's text, unless another text replaced that of digest `of` meanwhile. Raises: ConfigError."""
    async with session.document.texts.lock:
        if of and of != session.document.digest:
            raise ConfigError("the document was changed elsewhere meanwhile; look at what it says now")
        return _follow_up(session, await take(session, Text(text, session.document.path)), apply)


@request("set")
async def change(
    session: Session,
    tab: Tab | None,
    changes: dict[str, Any] | None = None,
    written: dict[str, str] | None = None,
    removed: list[str] | None = None,
    apply: bool = False,
) -> dict[str, Any]:
    """Change keys of the document and nothing else: values, values in YAML, keys to remove. Raises: ConfigError."""
    async with session.document.texts.lock:
        arguments = {"changes": changes or {}, "written": written or {}, "removed": removed or []}
        result = await session.worker.quick("change", **session.document.arguments(), **arguments)
        return _follow_up(session, _put(session, Text(result["text"], session.document.path), result), apply)


@request()
async def undo(session: Session, tab: Tab | None, apply: bool = False) -> dict[str, Any] | None:
    """Go one step back in the document's history."""
    return await _step(session, back=True, apply=apply)


@request()
async def redo(session: Session, tab: Tab | None, apply: bool = False) -> dict[str, Any] | None:
    """Redo what was undone last."""
    return await _step(session, back=False, apply=apply)


async def take(session: Session, text: Text) -> dict[str, Any]:
    """Replace text and path of the document, and send it to all tabs. The caller holds the lock of its texts."""
    return _put(session, text, await _check(session, text))


async def _step(session: Session, *, back: bool, apply: bool) -> dict[str, Any] | None:
    async with session.document.texts.lock:
        text = session.document.texts.next(back=back)
        if text is None:
            return None
        result = await _check(session, text)
        session.document.texts.step(session.document.now, back=back)
        return _follow_up(session, _publish(session, text, result), apply)


async def _check(session: Session, text: Text) -> dict[str, Any]:
    return await session.worker.quick("check", text=text.text, path=text.path, sets=session.document.sets)


def _put(session: Session, text: Text, document: dict[str, Any]) -> dict[str, Any]:
    """Replace the document's text, and add the one before to the history."""
    now = session.document.now
    if text != now:
        session.document.texts.leave(now)
    return _publish(session, text, document)


def _publish(session: Session, text: Text, document: dict[str, Any]) -> dict[str, Any]:
    session.document.text, session.document.path = text
    session.document.digest = document["digest"]
    session.begin(session.document.drafts.keep(text))
    texts = session.document.texts
    document |= {"can_undo": bool(texts.next(back=True)), "can_redo": bool(texts.next(back=False))}
    session.tabs.tell("document", **document)
    return document


def _follow_up(session: Session, document: dict[str, Any], apply: bool) -> dict[str, Any]:
    if not document["complaints"]:
        session.begin(foresee(session, apply))
    return document


@request()
async def batch(session: Session, tab: Tab | None) -> str:
    """Begin a batch of files to upload, and return its name."""
    return await asyncio.to_thread(session.uploads.batch)


@request()
async def open_batch(session: Session, tab: Tab | None, batch: str) -> dict[str, Any]:
    """Open the files of an uploaded batch together."""
    files = await asyncio.to_thread(session.uploads.keep, batch)
    return await begin(session, tab, [str(file) for file in files])


@request()
async def save(session: Session, tab: Tab | None, path: str, replace: bool = False) -> dict[str, Any]:
    """Write the document to a file of this machine, its paths relative to there. Raises: ConfigError, OutputError."""
    place = as_path(path)
    if not place.is_absolute():
        place = Path.cwd() / place
    if place.suffix not in (".yaml", ".yml"):
        place = place.with_name(f"{place.name}.yaml")
    if not replace and place.exists() and place != session.document.path:
        raise ConfigError(f"{place}: is there already; choose another name, or replace it")
    await session.worker.quick("save", text=session.document.text, path=session.document.path, out=place)
    return await begin(session, tab, [str(place)], make_it=False)


@request()
async def exchange(session: Session, tab: Tab | None) -> None:
    """Exchange left and right of the pair, and make it again."""
    text, path = session.document.now
    await edit(session, tab, await session.worker.quick("exchange", text=text, path=path))
    session.begin(make(session, tab))


async def offer(session: Session) -> None:
    """Tell pages of the draft of an earlier program, if there is one."""
    if (draft := await asyncio.to_thread(session.document.drafts.look)) is not None:
        session.tabs.tell("restored", path=str(draft.text.path), edited_s=draft.at_s)


@request()
async def restore(session: Session, tab: Tab | None) -> None:
    """Replace the document by the earlier program's draft, as an edit. Raises: ConfigError if there is none."""
    draft = session.document.drafts.earlier
    if draft is None:
        raise ConfigError("there is no unsaved draft")
    async with session.document.texts.lock:
        document = await take(session, draft.text)
    await forget(session, tab)
    if not document["complaints"]:
        session.begin(make(session, tab))


@request("forget_draft")
async def forget(session: Session, tab: Tab | None) -> None:
    """Remove the earlier program's draft."""
    await asyncio.to_thread(session.document.drafts.drop)
    session.tabs.tell("restored", path="", edited_s=0.0)
