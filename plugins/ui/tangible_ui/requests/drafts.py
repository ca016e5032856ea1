"""What was edited and not saved when the program ended: open it again, or forget it."""

import asyncio

from tangible_core.errors import ConfigError

from ..state.session import Desk, Tab
from .document import take
from .making import make


async def offer(desk: Desk) -> None:
    """Tell pages of what a program before this one left, if it left something."""
    if (draft := await asyncio.to_thread(desk.drafts.look)) is not None:
        desk.tell("restored", path=str(draft.text.path), edited_s=draft.at_s)


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


async def forget(desk: Desk, tab: Tab | None) -> None:
    """What was left is not offered again."""
    await asyncio.to_thread(desk.drafts.drop)
    desk.tell("restored", path="", edited_s=0.0)


ASKS = {"restore": restore, "forget_draft": forget}
