"""How the picture lies under the hand, and what limits the force there."""

import asyncio
from typing import Any

from ..state.session import Desk, Tab


async def reach(desk: Desk, tab: Tab) -> dict[str, Any]:
    """What the document's device reaches: its name, and its workspace in metres, or none."""
    return await desk.maker.quick("reach", text=desk.text, path=desk.path, sets=desk.sets)


async def limits(desk: Desk, tab: Tab) -> dict[str, Any] | None:
    """Ticks since the loop began, and those in which each limit acted; none before there is a loop."""
    servo = desk.feeling.servo
    if servo is None:
        return None
    report = await asyncio.to_thread(servo.report)
    return {"ticks": report.ticks, "overruns": report.overruns, "flagged": dict(report.flagged)}


ASKS = {"reach": reach, "limits": limits}
