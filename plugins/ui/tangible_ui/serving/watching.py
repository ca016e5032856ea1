"""Watches over the force loop: that the page's hand is kept, and that a loop which ends by itself is told of."""

import asyncio
from typing import TYPE_CHECKING

if TYPE_CHECKING:
    from ..state.session import Desk

KEEP_S = 0.01
"""How often the server says that it lives, and hands the hand on to a law that is computed beside."""


async def watch(desk: "Desk") -> None:
    """Until the server ends."""
    while True:
        desk.feeling.hand.keep()
        desk.laws.follow(desk.feeling)
        if why := desk.feeling.beacon_over():
            desk.tell("beacon", part=None, name="", why=why)
        if (ended := desk.feeling.ended()) is not None:
            desk.tell("loop", running=False, why=ended.why, lost=ended.lost)
        await asyncio.sleep(KEEP_S)
