"""The hand and the loop: hold, stop, feel again."""

import asyncio

from ..state.session import Desk, Tab
from .making import make


async def hold(desk: Desk, tab: Tab) -> None:
    """This tab's hand is felt from now on."""
    desk.hold(tab)


async def stop(desk: Desk, tab: Tab | None) -> None:
    """No force, at once, and none until `feel`, whatever else is made meanwhile."""
    ended = desk.feeling.cut()  # before anything is waited for
    desk.tell("loop", running=False, why="stopped", stopped=True)
    desk.begin(asyncio.to_thread(ended))


async def feel(desk: Desk, tab: Tab) -> None:
    """Feel the document, also after a stop. Raises: DeviceError if its device cannot be opened."""
    desk.feeling.allow()
    await make(desk, tab)


ASKS = {"hold": hold, "stop": stop, "feel": feel}
