"""Requests of the parts editor: open, propose a part, follow the picture's edges, feel heights, save."""

import asyncio
from typing import Any, Literal

from ..state.document import Text
from ..state.session import Session
from ..state.tabs import Tab
from ..user_data import user_folder
from .document import take
from .making import foresee
from .table import request


@request()
async def parts_open(session: Session, tab: Tab | None) -> dict[str, Any]:
    """Return what the editor begins with: the document's picture and parts, its file, and where a new one may lie."""
    arguments = {"opened": session.document.drafts.opened_text, "uploads": user_folder("")}
    return await session.worker.quick("parts_open", **session.document.arguments(), **arguments)


@request()
async def parts_save(
    session: Session,
    tab: Tab | None,
    upload: str,
    parts: list[dict[str, Any]],
    heights: dict[str, Any] | None = None,
    title: str | None = None,
    language: str | None = None,
    of: str = "",
    beside: bool = False,
) -> dict[str, Any]:
    """Save labels (batch `upload`: a gzip of uint16), and the document with the entries of parts, or change nothing."""
    async with session.document.texts.lock:
        labels_file = await asyncio.to_thread(session.uploads.single, upload)
        try:
            result = await session.worker.quick(
                "parts_save", **session.document.arguments(), sent=labels_file, parts=parts, heights=heights, of=of,
                words={"title": title, "language": language}, opened=session.document.drafts.opened_text,
                store=user_folder("opened"), drawn=user_folder("drawn"), beside=beside,
                earlier=session.document.texts.all,
            )  # fmt: skip
        finally:
            await asyncio.to_thread(session.uploads.drop, upload)
        text, new_texts = result.pop("text"), result.pop("moved")
        session.document.texts.rewrite(new_texts)
        session.document.text = new_texts.get(session.document.text, session.document.text)
        session.document.drafts.remember_opened(text)
        await take(session, Text(text, result["file"]))
        result["file"] = str(result["file"])
    session.begin(foresee(session, apply=True))
    return result


@request()
async def parts_propose(
    session: Session,
    tab: Tab | None,
    points: list[list[float]],
    width_px: float,
    kind: Literal["regions", "grabcut", "watershed"] = "grabcut",
    within: list[float] | None = None,
    level: float = 0.5,
) -> dict[str, Any] | None:
    """Propose the part under a stroke, in pixels of the picture; None if a newer stroke came before this began."""
    arguments = {"points": points, "width_px": width_px, "kind": kind, "within": within, "level": level}
    arguments |= session.document.arguments()
    return await session.strokes.run(lambda: session.worker.quick("parts_propose", **arguments))


@request()
async def parts_heights(
    session: Session,
    tab: Tab | None,
    heights_m: list[float | None],
    materials: list[str | None] | None = None,
    heights: dict[str, Any] | None = None,
) -> dict[str, Any] | None:
    """Feel and show the parts at other heights, by number; the document stays unchanged. None if newer ones came."""
    arguments = {"heights_m": heights_m, "materials": materials, "heights": heights}

    async def feel() -> dict[str, Any]:
        loop_input = await session.worker.quick(
            "parts_heights", **session.document.arguments(session.felt_sets()), **arguments
        )
        await session.feel_on(loop_input)
        return {}

    result = await session.heights.run(feel)
    if result is not None:
        session.begin(session.drawings.run(lambda: session.worker.quick("parts_shown")))
    return result
