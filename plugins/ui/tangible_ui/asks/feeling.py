"""The hand and the loop: hold, stop, feel again."""

import asyncio

from ..desk import Desk, Tab
from .making import make


async def hold(desk: Desk, tab: Tab) -> None:
    """This tab's hand is felt from now on."""
    desk.hold(tab)


async def stop(desk: Desk, tab: Tab) -> None:
    """No force, at once."""
    await asyncio.to_thread(desk.feeling.stop)
    desk.tell("loop", running=False, why="stopped")


async def feel(desk: Desk, tab: Tab) -> None:
    """Feel again what was made last."""
    if desk.feeling.felt is not None:
        await make(desk, tab)
    desk.tell("loop", running=True, why="")


ASKS = {"hold": hold, "stop": stop, "feel": feel}
