"""The parts editor: begin, propose a part, follow the picture's edges, feel heights, and keep what was drawn."""

import asyncio
from typing import Any, Literal

from ..state.session import Desk, Tab
from ..state.texts import Text
from ..state.uploads import user_folder
from .document import take
from .making import foresee
from .table import request


@request()
async def parts_open(desk: Desk, tab: Tab | None) -> dict[str, Any]:
    """What an editor begins with: the document's picture and parts."""
    return await desk.maker.quick("parts_open", **_document(desk))


@request()
async def parts_save(
    desk: Desk,
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
    async with desk.texts.lock:
        sent = await asyncio.to_thread(desk.shelf.single, upload)
        try:
            found = await desk.maker.quick(
                "parts_save", **_document(desk), sent=sent, parts=parts, heights=heights, of=of,
                words={"title": title, "language": language}, opened=desk.drafts.opened_text,
                shelf=user_folder("opened"), earlier=desk.texts.all,
            )  # fmt: skip
        finally:
            await asyncio.to_thread(desk.shelf.drop, upload)
        text, moved = found.pop("text"), found.pop("moved")
        desk.texts.rewrite(moved)
        desk.text = moved.get(desk.text, desk.text)
        if found["saved"]:
            desk.drafts.opened(text)
        await take(desk, Text(text, desk.path))
    desk.begin(foresee(desk, apply=True))
    return found


@request()
async def parts_propose(
    desk: Desk,
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
    return await desk.strokes.do(lambda: desk.maker.quick("parts_propose", **_document(desk), **told))


@request()
async def parts_snap(desk: Desk, tab: Tab | None, points: list[list[float]], reach_px: float) -> dict[str, Any]:
    """A closed outline on the picture's edges that are no farther away than this. Raises: ConfigError."""
    return await desk.maker.quick("parts_snap", **_document(desk), points=points, reach_px=reach_px)


@request()
async def parts_heights(
    desk: Desk,
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
        made = await desk.maker.quick("parts_heights", **{**_document(desk), "sets": desk.felt_sets()}, **told)
        await desk.feel_on(made)
        return {}

    done = await desk.heights.do(felt)
    if done is not None:
        desk.begin(desk.drawn.do(lambda: desk.maker.quick("parts_shown")))
    return done


def _document(desk: Desk) -> dict[str, Any]:
    return {"text": desk.text, "path": desk.path, "sets": desk.sets}
