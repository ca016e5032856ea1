"""Watches over the force loop: that the page's hand is kept, and that a loop which ends by itself is told of."""

import asyncio
from typing import TYPE_CHECKING

from tangible_core.errors import DeviceError

if TYPE_CHECKING:
    from .desk import Desk

KEEP_S = 0.02
"""How often the server says that it lives."""
FIRST_PAUSE_S, LONGEST_PAUSE_S = 1.0, 8.0
"""Before a device is looked for again; twice as long each time: to look for one starts a process."""


async def watch(desk: "Desk") -> None:
    """Until the server ends."""
    while True:
        desk.feeling.hand.keep()
        if (ended := desk.feeling.ended()) is not None:
            desk.tell("loop", running=False, why=ended.why, lost=ended.lost)
        await asyncio.sleep(KEEP_S)


async def wait_for_device(desk: "Desk") -> None:
    """Look for the device that is chosen again and again, until it is felt, or something else, or stop is pressed."""
    choice, pause_s, told = desk.choice, FIRST_PAUSE_S, ""
    while desk.choice is choice and not desk.feeling.stopped and not desk.feeling.running:
        try:
            await desk.make_and_feel()
        except DeviceError as error:
            if str(error) != told:
                told = str(error)
                desk.tell("loop", running=False, why=told, lost=True, waiting=True)
        await asyncio.sleep(pause_s)
        pause_s = min(2 * pause_s, LONGEST_PAUSE_S)
