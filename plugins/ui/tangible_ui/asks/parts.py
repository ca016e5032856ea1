"""The parts editor: begin, and keep what was drawn."""

import asyncio
from typing import Any

from ..desk.desk import Desk, Tab
from ..desk.shelf import user_folder
from ..desk.texts import Text
from .document import take
from .making import foresee


async def parts_open(desk: Desk, tab: Tab | None) -> dict[str, Any]:
    """What an editor begins with: the document's picture and parts."""
    return await desk.maker.quick("parts_open", text=desk.text, path=desk.path, sets=desk.sets)


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
                "parts_save", text=desk.text, path=desk.path, sets=desk.sets, sent=sent, parts=parts, heights=heights,
                words={"title": title, "language": language}, of=of, opened=desk.drafts.opened_text,
                shelf=user_folder("opened"),
            )  # fmt: skip
        finally:
            await asyncio.to_thread(desk.shelf.drop, upload)
        text = found.pop("text")
        if found["saved"]:
            desk.drafts.opened(text)
        await take(desk, Text(text, desk.path))
    desk.begin(foresee(desk, apply=True))
    return found


ASKS = {"parts_open": parts_open, "parts_save": parts_save}
