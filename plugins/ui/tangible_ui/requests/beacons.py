"""A beacon: a gentle pull to a part of what is felt, until a button lets go of it, or a page does."""

import asyncio
from pathlib import Path
from typing import Any

from tangible_core.errors import DeviceError
from tangible_core.servo import Beacon, parcel
from tangible_core.session import called

from ..state.session import Desk, Tab


async def beacon(desk: Desk, tab: Tab | None, part: int | None) -> dict[str, Any]:
    """Pull the hand to the part of this number from now on; to none without a number. Pages hear of every change.

    Raises: DeviceError if nothing is felt, ConfigError if there is no such part.
    """
    if part is None:
        await asyncio.to_thread(desk.feeling.pull_to, None)
        return _tell(desk, None, "")
    if not desk.feeling.running:
        raise DeviceError("nothing is felt, so nothing can be pulled; make and feel a surface first")
    document = {"text": desk.text, "path": desk.path, "sets": desk.felt_sets()}
    made = await desk.maker.quick("beacon", **document, part=part)
    found: Beacon = await asyncio.to_thread(parcel.unpack, Path(made["parcel"]))
    await asyncio.to_thread(desk.feeling.pull_to, found)
    return _tell(desk, found.part, called(found.part, found.name))


def _tell(desk: Desk, part: int | None, name: str) -> dict[str, Any]:
    desk.tell("beacon", part=part, name=name, why="asked")
    return {"part": part, "name": name}


ASKS = {"beacon": beacon}
