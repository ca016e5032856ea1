"""The parts editor: begin, propose a part, follow the picture's edges, feel heights, and keep what was drawn."""

import asyncio
from typing import Any, Literal

from ..state.session import Session, Tab
from ..state.texts import Text
from ..state.uploads import user_folder
from .document import take
from .making import foresee
from .table import request


@request()
async def parts_open(session: Session, tab: Tab | None) -> dict[str, Any]:
    """What an editor begins with: the document's picture and parts."""
    return await session.worker.quick("parts_open", **_document(session))


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
) -> dict[str, Any]:
    """Keep labels that a page has sent, what is said of each, and the document where it stands in a file.

    upload: the batch that they were sent in, as a gzip of uint16. of: digest of the parts that were edited; if others
    took their place meanwhile, it is refused. Raises: ConfigError, OutputError; then nothing is changed.
    """
    async with session.texts.lock:
        sent = await asyncio.to_thread(session.uploads.single, upload)
        try:
            found = await session.worker.quick(
                "parts_save", **_document(session), sent=sent, parts=parts, heights=heights, of=of,
                words={"title": title, "language": language}, opened=session.drafts.opened_text,
                store=user_folder("opened"), earlier=session.texts.all,
            )  # fmt: skip
        finally:
            await asyncio.to_thread(session.uploads.drop, upload)
        text, moved = found.pop("text"), found.pop("moved")
        session.texts.rewrite(moved)
        session.text = moved.get(session.text, session.text)
        if found["saved"]:
            session.drafts.remember_opened(text)
        await take(session, Text(text, session.path))
    session.begin(foresee(session, apply=True))
    return found


@request()
async def parts_propose(
    session: Session,
    tab: Tab | None,
    points: list[list[float]],
    width_px: float,
    kind: Literal["grabcut", "watershed"] = "grabcut",
    within: list[float] | None = None,
) -> dict[str, Any] | None:
    """The part on which a stroke lies, in pixels of the picture; nothing if another stroke came before this began.

    within: first column and row, and those after the last, beyond which nothing is proposed. Raises: ConfigError.
    """
    told = {"points": points, "width_px": width_px, "kind": kind, "within": within}
    return await session.strokes.run(lambda: session.worker.quick("parts_propose", **_document(session), **told))


@request()
async def parts_snap(session: Session, tab: Tab | None, points: list[list[float]], reach_px: float) -> dict[str, Any]:
    """A closed outline on the picture's edges that are no farther away than this. Raises: ConfigError."""
    return await session.worker.quick("parts_snap", **_document(session), points=points, reach_px=reach_px)


@request()
async def parts_heights(
    session: Session,
    tab: Tab | None,
    heights_m: list[float | None],
    materials: list[str | None] | None = None,
    heights: dict[str, Any] | None = None,
) -> dict[str, Any] | None:
    """Feel the parts at these heights, by number, and see them; the document stays as it is.

    heights_m: nothing for what the document's recipe finds. materials, heights: others than the document's.
    Returns: nothing if newer ones came before this began. Raises: TangibleError, and what was felt before is felt on.
    """
    told = {"heights_m": heights_m, "materials": materials, "heights": heights}

    async def felt() -> dict[str, Any]:
        made = await session.worker.quick(
            "parts_heights", **{**_document(session), "sets": session.felt_sets()}, **told
        )
        await session.feel_on(made)
        return {}

    done = await session.heights.run(felt)
    if done is not None:
        session.begin(session.drawn.run(lambda: session.worker.quick("parts_shown")))
    return done


def _document(session: Session) -> dict[str, Any]:
    return {"text": session.text, "path": session.path, "sets": session.sets}
